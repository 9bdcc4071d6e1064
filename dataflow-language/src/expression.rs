//! An expression of a graph: the values it reads, and where they are found.

use proc_macro2::{Group, Ident, TokenStream, TokenTree};
use quote::{ToTokens, format_ident, quote};
use syn::parse::{Parse, ParseStream};
use syn::visit::{self, Visit};
use syn::visit_mut::{self, VisitMut};
use syn::{Error, Expr, ExprCall, FieldValue, Macro, PatIdent, Result};

/// What a value is computed by.
pub struct Expression {
    expr: Expr,
    /// The values that it reads, each once, in the order in which they appear.
    pub reads: Vec<Read>,
    /// Names that its own patterns bind, which no value may have.
    pub bound: Vec<Ident>,
}

/// A value that an expression reads.
#[derive(Clone, PartialEq)]
pub struct Read {
    /// The value's name.
    pub name: Ident,
    /// `last NAME`: as it was before this run.
    pub last: bool,
}

impl Expression {
    /// The expression as code; `place` says where each value is found.
    pub fn with(&self, place: impl Fn(&Read) -> TokenStream) -> TokenStream {
        let mut expr = self.expr.clone();
        Placed {
            reads: &self.reads,
            place,
        }
        .visit_expr_mut(&mut expr);
        expr.into_token_stream()
    }

    /// The function or method that is called last, else the whole expression.
    pub fn function(&self) -> TokenStream {
        match &self.expr {
            Expr::Call(call) => call.func.to_token_stream(),
            Expr::MethodCall(call) => call.method.to_token_stream(),
            _ => self.with(|read| {
                let name = &read.name;
                if read.last {
                    quote!(last #name)
                } else {
                    quote!(#name)
                }
            }),
        }
    }
}

impl Parse for Expression {
    fn parse(stream: ParseStream) -> Result<Self> {
        let expr: Expr = stream.parse()?;
        let mut found = Found::default();
        found.visit_expr(&expr);
        match found.refused {
            Some(error) => Err(error),
            None => Ok(Self {
                reads: found.reads(),
                bound: found.bound,
                expr,
            }),
        }
    }
}

/// How `last NAME` is written while Rust's own parser reads the expression around it.
const LAST: &str = "__last_";

/// A declaration with each `last NAME` as one word, which Rust's parser takes for a name.
pub fn with_last_as_one_word(tokens: TokenStream) -> TokenStream {
    let mut written = TokenStream::new();
    let mut tokens = tokens.into_iter().peekable();
    while let Some(token) = tokens.next() {
        let token = match (&token, tokens.peek()) {
            (TokenTree::Ident(word), Some(TokenTree::Ident(name))) if word == "last" => {
                let one = format_ident!("{}{}", LAST, name, span = name.span());
                tokens.next();
                TokenTree::Ident(one)
            }
            (TokenTree::Group(group), _) => {
                let inside = with_last_as_one_word(group.stream());
                let mut again = Group::new(group.delimiter(), inside);
                again.set_span(group.span());
                TokenTree::Group(again)
            }
            _ => token,
        };
        written.extend([token]);
    }
    written
}

/// The value that a word reads, where it can be the name of one.
///
/// Names of constants and types begin with a capital letter, those of values do not.
fn read(expr: &Expr) -> Option<Read> {
    let Expr::Path(path) = expr else {
        return None;
    };
    let word = path.path.get_ident()?.to_string();
    let (name, last) = match word.strip_prefix(LAST) {
        Some(name) => (name, true),
        None => (word.as_str(), false),
    };
    let begins_small = name.starts_with(|letter: char| !letter.is_uppercase());
    let span = path.path.get_ident()?.span();
    begins_small.then(|| Read {
        name: format_ident!("{}", name, span = span),
        last,
    })
}

/// What is found on a walk through an expression.
#[derive(Default)]
struct Found {
    words: Vec<Read>,
    bound: Vec<Ident>,
    refused: Option<Error>,
}

impl Found {
    /// The words that are no names of the expression's own, each once.
    fn reads(&self) -> Vec<Read> {
        let mut reads: Vec<Read> = Vec::new();
        for word in &self.words {
            let own = !word.last && self.bound.contains(&word.name);
            if !own && !reads.contains(word) {
                reads.push(word.clone());
            }
        }
        reads
    }
}

impl<'ast> Visit<'ast> for Found {
    fn visit_expr(&mut self, expr: &'ast Expr) {
        match read(expr) {
            Some(word) => self.words.push(word),
            None => visit::visit_expr(self, expr),
        }
    }

    /// A function's name is none of a value.
    fn visit_expr_call(&mut self, call: &'ast ExprCall) {
        if !matches!(*call.func, Expr::Path(_)) {
            self.visit_expr(&call.func);
        }
        call.args.iter().for_each(|it| self.visit_expr(it));
    }

    fn visit_pat_ident(&mut self, pattern: &'ast PatIdent) {
        self.bound.push(pattern.ident.clone());
        visit::visit_pat_ident(self, pattern);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        let message = "a macro hides which values it reads: call a function";
        self.refused
            .get_or_insert(Error::new_spanned(call, message));
    }
}

/// Puts another place where a value is read.
struct Placed<'a, F> {
    reads: &'a [Read],
    place: F,
}

impl<F: Fn(&Read) -> TokenStream> VisitMut for Placed<'_, F> {
    fn visit_expr_mut(&mut self, expr: &mut Expr) {
        match read(expr).filter(|word| self.reads.contains(word)) {
            Some(word) => *expr = Expr::Verbatim((self.place)(&word)),
            None => visit_mut::visit_expr_mut(self, expr),
        }
    }

    fn visit_expr_call_mut(&mut self, call: &mut ExprCall) {
        if !matches!(*call.func, Expr::Path(_)) {
            self.visit_expr_mut(&mut call.func);
        }
        call.args.iter_mut().for_each(|it| self.visit_expr_mut(it));
    }

    /// `Struct { name }` reads a value too, and says the field's name no more where it is moved.
    fn visit_field_value_mut(&mut self, field: &mut FieldValue) {
        if read(&field.expr).is_some() {
            field.colon_token.get_or_insert_default();
        }
        visit_mut::visit_field_value_mut(self, field);
    }
}
