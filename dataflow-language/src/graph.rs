//! A graph as it was declared, before anything is known to be right.

use proc_macro2::Ident;
use syn::{Attribute, Expr, Type, Visibility};

use crate::expression::{Expression, Read};

/// The whole declaration.
pub struct Graph {
    /// Docs and other attributes of the struct.
    pub attributes: Vec<Attribute>,
    /// Of the struct.
    pub visibility: Visibility,
    /// The struct's name.
    pub name: Ident,
    /// Parameters, inputs and computed values in the order of the lines.
    pub values: Vec<Value>,
}

/// A line: one value, and where it comes from.
pub struct Value {
    /// Its documentation.
    pub docs: Vec<Attribute>,
    /// What others call it.
    pub name: Ident,
    /// Its type.
    pub of_type: Type,
    /// `starting VALUE`: what it is before anything came in.
    pub starting: Option<Expr>,
    /// Where it comes from.
    pub source: Source,
}

/// Where a value comes from.
pub enum Source {
    /// Set from outside, between runs, without marking anything.
    Param(Param),
    /// Set from outside, and marked as changed.
    Input(Input),
    /// Computed from other values.
    Computed(Box<Computed>),
}

/// `param NAME: TYPE;` or `param NAME: TYPE = EXPRESSION;`
pub struct Param {
    /// What it is made of whenever another parameter is set.
    pub derivation: Option<Box<Expression>>,
}

/// `input NAME: TYPE, at RATE, gates, triggers;`
pub struct Input {
    /// The largest rate at which it comes.
    pub rate: Rate,
    /// Whether its period enters the hyperperiod.
    pub gates: Gates,
    /// It may ask for a run.
    pub triggers: bool,
}

/// The largest rate at which an input comes.
pub enum Rate {
    /// `at NUMBER Hz`.
    Hertz {
        /// In Hz.
        number: f64,
        /// As it was written.
        literal: syn::Lit,
    },
    /// `every PERIOD`, a constant expression.
    Every(Box<Expr>),
}

/// Whether an input's period enters the hyperperiod.
pub enum Gates {
    /// It does not.
    Never,
    /// It does.
    Always,
    /// `gates if CONSTANT`.
    If(Box<Expr>),
}

/// `state`, `node` or `output NAME: TYPE = EXPRESSION;`
pub struct Computed {
    /// Whether it remembers, and whether it leaves the graph.
    pub kind: Kind,
    /// What computes it.
    pub expression: Expression,
    /// `quantum SIZE`: the change from which on others are told.
    pub quantum: Option<Expr>,
}

/// What kind of computed value.
pub enum Kind {
    /// Remembers: advances when this input ticks.
    State {
        /// That input.
        clock: Ident,
    },
    /// Remembers nothing.
    Node,
    /// A node that the world outside reads.
    Output,
}

impl Computed {
    /// The values that it reads.
    pub fn reads(&self) -> impl Iterator<Item = &Read> {
        self.expression.reads.iter()
    }
}

impl Value {
    /// How it is computed, where it is.
    pub fn computed(&self) -> Option<&Computed> {
        match &self.source {
            Source::Computed(computed) => Some(computed),
            Source::Param(_) | Source::Input(_) => None,
        }
    }

    /// How it comes in, where it is an input.
    pub fn input(&self) -> Option<&Input> {
        match &self.source {
            Source::Input(input) => Some(input),
            Source::Param(_) | Source::Computed(_) => None,
        }
    }

    /// True where it is set between runs and marks nothing.
    pub fn is_param(&self) -> bool {
        matches!(self.source, Source::Param(_))
    }

    /// What it is computed or made by, whichever kind it is.
    pub fn expression(&self) -> Option<&Expression> {
        match &self.source {
            Source::Param(param) => param.derivation.as_deref(),
            Source::Input(_) => None,
            Source::Computed(computed) => Some(&computed.expression),
        }
    }

    /// The input that clocks it, where it is a state.
    pub fn clock(&self) -> Option<&Ident> {
        match &self.computed()?.kind {
            Kind::State { clock } => Some(clock),
            Kind::Node | Kind::Output => None,
        }
    }

    /// A node or output: computed from others, remembers nothing.
    pub fn is_plain_node(&self) -> bool {
        self.computed().is_some() && self.clock().is_none()
    }

    /// True where the world outside reads it.
    pub fn is_output(&self) -> bool {
        self.computed()
            .is_some_and(|computed| matches!(computed.kind, Kind::Output))
    }
}
