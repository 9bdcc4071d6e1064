//! From tokens to a [`Graph`]: every error points at the word that is wrong.

use proc_macro2::{Ident, TokenStream};
use syn::ext::IdentExt;
use syn::parse::{Parse, ParseStream};
use syn::{Attribute, Error, Expr, Lit, Result, Token, Type, parse2};

use crate::expression::{Expression, with_last_as_one_word};
use crate::graph::{Computed, Gates, Graph, Input, Kind, Param, Rate, Source, Value};

const LINES: &str = "a line declares a `param`, an `input`, a `state`, a `node` or an `output`";
const CLAUSES: &str = "known are `at NUMBER Hz`, `every PERIOD`, `gates`, `gates if CONSTANT`, \
    `triggers`, `joins`, `clocked by INPUT`, `quantum SIZE`, `starting VALUE`";

impl Graph {
    /// A declaration from its tokens.
    ///
    /// # Errors
    /// The first word that is no part of the language.
    pub fn parse(tokens: TokenStream) -> Result<Self> {
        parse2(with_last_as_one_word(tokens))
    }
}

impl Parse for Graph {
    fn parse(stream: ParseStream) -> Result<Self> {
        let attributes = stream.call(Attribute::parse_outer)?;
        let visibility = stream.parse()?;
        stream.parse::<Token![struct]>()?;
        let name = stream.parse()?;
        stream.parse::<Token![;]>()?;
        let mut values = Vec::new();
        while !stream.is_empty() {
            values.push(stream.parse()?);
        }
        Ok(Self {
            attributes,
            visibility,
            name,
            values,
        })
    }
}

impl Parse for Value {
    fn parse(stream: ParseStream) -> Result<Self> {
        let docs = stream.call(Attribute::parse_outer)?;
        let keyword = Keyword::of(&stream.call(Ident::parse_any)?)?;
        let name: Ident = stream.parse()?;
        stream.parse::<Token![:]>()?;
        let of_type: Type = stream.parse()?;
        let has_expression = match keyword {
            Keyword::Input => false,
            Keyword::Param => stream.peek(Token![=]),
            Keyword::State | Keyword::Node | Keyword::Output => true,
        };
        let expression = if has_expression {
            stream.parse::<Token![=]>()?;
            Some(stream.parse()?)
        } else {
            None
        };
        let mut clauses = Clauses::default();
        while stream.peek(Token![,]) {
            stream.parse::<Token![,]>()?;
            clauses.parse(stream)?;
        }
        stream.parse::<Token![;]>()?;
        clauses.finish(keyword, docs, name, of_type, expression)
    }
}

/// The first word of a line: what it keyword.
#[derive(Clone, Copy, PartialEq)]
enum Keyword {
    Param,
    Input,
    State,
    Node,
    Output,
}

impl Keyword {
    fn of(word: &Ident) -> Result<Self> {
        match word.to_string().as_str() {
            "param" => Ok(Self::Param),
            "input" => Ok(Self::Input),
            "state" => Ok(Self::State),
            "node" => Ok(Self::Node),
            "output" => Ok(Self::Output),
            other => Err(Error::new(
                word.span(),
                format!("`{other}` declares nothing: {LINES}"),
            )),
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Param => "a parameter",
            Self::Input => "an input",
            Self::State => "a state",
            Self::Node => "a node",
            Self::Output => "an output",
        }
    }

    /// True where a clause has a meaning in its line.
    fn knows(self, clause: &str) -> bool {
        match clause {
            "at" | "every" | "gates" | "triggers" | "joins" => self == Self::Input,
            "clocked" => self == Self::State,
            "quantum" => matches!(self, Self::State | Self::Node | Self::Output),
            "starting" => matches!(self, Self::Input | Self::State),
            _ => false,
        }
    }
}

/// What follows the commas of a line, in any order.
#[derive(Default)]
struct Clauses {
    seen: Vec<Ident>,
    rate: Option<Rate>,
    gates: Option<Gates>,
    clock: Option<Ident>,
    quantum: Option<Expr>,
    starting: Option<Expr>,
}

impl Clauses {
    fn parse(&mut self, stream: ParseStream) -> Result<()> {
        let word = stream.call(Ident::parse_any)?;
        match word.to_string().as_str() {
            "at" => self.rate = Some(hertz(stream)?),
            "every" => self.rate = Some(Rate::Every(stream.parse()?)),
            "gates" => self.gates = Some(gates(stream)?),
            "triggers" | "joins" => {}
            "clocked" => {
                let by = stream.call(Ident::parse_any)?;
                if by != "by" {
                    return Err(Error::new(by.span(), "expected `clocked by INPUT`"));
                }
                self.clock = Some(stream.parse()?);
            }
            "quantum" => self.quantum = Some(stream.parse()?),
            "starting" => self.starting = Some(stream.parse()?),
            other => {
                let message = format!("`{other}` is not known here: {CLAUSES}");
                return Err(Error::new(word.span(), message));
            }
        }
        if self.has(&word.to_string()) {
            return Err(Error::new(word.span(), format!("`{word}` is said twice")));
        }
        self.seen.push(word);
        Ok(())
    }

    fn has(&self, clause: &str) -> bool {
        self.seen.iter().any(|seen| seen == clause)
    }

    fn finish(
        self,
        keyword: Keyword,
        docs: Vec<Attribute>,
        name: Ident,
        of_type: Type,
        expression: Option<Expression>,
    ) -> Result<Value> {
        for clause in &self.seen {
            if !keyword.knows(&clause.to_string()) {
                let message = format!("`{clause}` means nothing for {}", keyword.word());
                return Err(Error::new(clause.span(), message));
            }
        }
        let starting = self.starting.clone();
        let source = match (keyword, expression) {
            (Keyword::Param, derivation) => Source::Param(Param {
                derivation: derivation.map(Box::new),
            }),
            (_, None) => Source::Input(self.input(&name)?),
            (_, Some(expression)) => {
                Source::Computed(Box::new(self.computed(keyword, &name, expression)?))
            }
        };
        Ok(Value {
            docs,
            name,
            of_type,
            starting,
            source,
        })
    }

    fn input(self, name: &Ident) -> Result<Input> {
        let triggers = self.has("triggers");
        let asks = triggers || self.gates.is_some();
        if let Some(joins) = self.seen.iter().find(|seen| asks && *seen == "joins") {
            let message = format!("`{name}` cannot join and gate or trigger as well");
            return Err(Error::new(joins.span(), message));
        }
        if !asks && !self.has("joins") {
            let message = format!("input `{name}` must say one of `gates`, `triggers`, `joins`");
            return Err(Error::new(name.span(), message));
        }
        let rate = self.rate.ok_or_else(|| {
            let message =
                format!("input `{name}` has no rate: add `at NUMBER Hz` or `every PERIOD`");
            Error::new(name.span(), message)
        })?;
        Ok(Input {
            rate,
            gates: self.gates.unwrap_or(Gates::Never),
            triggers,
        })
    }

    fn computed(self, keyword: Keyword, name: &Ident, expression: Expression) -> Result<Computed> {
        let kind = match (keyword, self.clock) {
            (Keyword::State, Some(clock)) => Kind::State { clock },
            (Keyword::State, None) => {
                let message = format!("state `{name}` has no clock: add `clocked by INPUT`");
                return Err(Error::new(name.span(), message));
            }
            (Keyword::Output, _) => Kind::Output,
            _ => Kind::Node,
        };
        Ok(Computed {
            kind,
            expression,
            quantum: self.quantum,
        })
    }
}

/// `NUMBER Hz`, behind `at`.
fn hertz(stream: ParseStream) -> Result<Rate> {
    let literal: Lit = stream.parse()?;
    let number = match &literal {
        Lit::Int(number) => number.base10_parse::<f64>()?,
        Lit::Float(number) => number.base10_parse::<f64>()?,
        _ => 0.0,
    };
    let unit = stream.call(Ident::parse_any)?;
    if unit != "Hz" {
        return Err(Error::new(unit.span(), "a rate is given in `Hz`"));
    }
    if !(1e-3..=1e6).contains(&number) {
        let message = "a rate must be a number from 0.001 to 1000000 Hz";
        return Err(Error::new(literal.span(), message));
    }
    Ok(Rate::Hertz { number, literal })
}

/// What follows `gates`.
fn gates(stream: ParseStream) -> Result<Gates> {
    if stream.parse::<Option<Token![if]>>()?.is_none() {
        return Ok(Gates::Always);
    }
    Ok(Gates::If(stream.parse()?))
}
