//! A graph as it was declared, before anything is known to be right.

use proc_macro2::Ident;
use syn::{Attribute, Expr, Path, Type, Visibility};

/// The whole declaration.
pub struct Graph {
    /// Docs and other attributes of the struct.
    pub attributes: Vec<Attribute>,
    /// `#[export_declaration]`: other macros may run the same graph another way.
    pub exported: bool,
    pub visibility: Visibility,
    pub name: Ident,
    /// Inputs and computed values in the order of the lines.
    pub values: Vec<Value>,
}

/// A line: one value, and where it comes from.
pub struct Value {
    /// Its documentation.
    pub docs: Vec<Attribute>,
    pub name: Ident,
    pub of_type: Type,
    /// `starting VALUE`: what it is before anything came in.
    pub starting: Option<Expr>,
    pub source: Source,
}

/// Where a value comes from.
pub enum Source {
    Input(Input),
    Computed(Box<Computed>),
}

/// `input NAME: TYPE, at RATE, gates, triggers;`
pub struct Input {
    pub rate: Rate,
    pub gates: Gates,
    pub triggers: bool,
}

/// The largest rate at which an input comes.
pub enum Rate {
    /// `at NUMBER Hz`.
    Hertz { number: f64, literal: syn::Lit },
    /// `every PERIOD`, a constant expression.
    Every(Box<Expr>),
}

/// Whether an input's period enters the hyperperiod.
pub enum Gates {
    Never,
    Always,
    /// `gates if CONSTANT`.
    If(Box<Expr>),
}

/// `state`, `node` or `output NAME: TYPE = FUNCTION(ARGUMENTS);`
pub struct Computed {
    pub kind: Kind,
    pub function: Path,
    pub arguments: Vec<Argument>,
    /// `quantum SIZE`: the change from which on others are told.
    pub quantum: Option<Expr>,
}

/// What kind of computed value.
pub enum Kind {
    /// Remembers: advances when this input ticks.
    State {
        clock: Ident,
    },
    Node,
    Output,
}

/// What a function is given.
pub struct Argument {
    pub name: Ident,
    /// `&NAME`: a reference, not a copy.
    pub by_reference: bool,
    /// `last NAME`: the value from before this run.
    pub last: bool,
}

impl Value {
    pub fn computed(&self) -> Option<&Computed> {
        match &self.source {
            Source::Input(_) => None,
            Source::Computed(computed) => Some(computed),
        }
    }

    pub fn input(&self) -> Option<&Input> {
        match &self.source {
            Source::Input(input) => Some(input),
            Source::Computed(_) => None,
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

    pub fn is_output(&self) -> bool {
        self.computed()
            .is_some_and(|computed| matches!(computed.kind, Kind::Output))
    }
}
