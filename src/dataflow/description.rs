//! A graph as data: drawings and reports are made of it.

use super::Dirty;

/// A whole graph.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    /// Its type's name.
    pub name: &'static str,
    /// The first line of its documentation.
    pub doc: &'static str,
    /// Time (us) after which the inputs that gate have all come; zero where none gates.
    pub hyperperiod: u64,
    /// Inputs first, then each value behind all that it reads.
    pub values: &'static [Described],
}

/// One value.
#[derive(Clone, Copy, Debug)]
pub struct Described {
    /// Its name.
    pub name: &'static str,
    /// The first line of its documentation.
    pub doc: &'static str,
    /// What marks it as changed.
    pub mark: Dirty,
    /// Its type.
    pub of_type: &'static str,
    /// Most updates in 1000 s, so in mHz, leaving aside those of the failsafe.
    pub most_updates: u64,
    /// Where it comes from.
    pub source: Source,
}

/// Where a value comes from.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// From outside.
    Input {
        /// Its period enters the hyperperiod.
        gates: bool,
        /// Its change may ask for a run.
        triggers: bool,
    },
    /// From other values.
    Computed {
        /// Whether it remembers, and whether it leaves the graph.
        kind: Kind,
        /// What computes it.
        function: &'static str,
        /// The values given to the function.
        reads: &'static [Read],
        /// The change from which on others are told; none where any change counts.
        quantum: Option<f32>,
    },
}

/// The kind of a computed value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Advances when an input ticks.
    State {
        /// That input.
        clock: &'static str,
    },
    /// Computed from others, remembers nothing.
    Node,
    /// A node that the world outside reads.
    Output,
}

/// A value that a function is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Read {
    /// Its name.
    pub name: &'static str,
    /// As it was before the run.
    pub last: bool,
}
