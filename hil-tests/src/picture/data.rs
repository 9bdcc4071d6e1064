//! The graph as data: what `cargo hil graph --json` prints.

use reflex::dataflow::{Described, Description, Kind, Read, Source};
use schemars::JsonSchema;
use serde::Serialize;

use super::scene::type_words;

/// A whole graph.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct GraphData {
    /// Its type's name.
    pub name: &'static str,
    /// The first line of its documentation.
    pub doc: &'static str,
    /// Common period of the inputs that gate, in us; 0 where none gates.
    pub hyperperiod_us: u64,
    /// Inputs first, then each value behind all that it reads.
    pub values: Vec<ValueData>,
}

/// One value.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ValueData {
    /// Its name.
    pub name: &'static str,
    /// The first line of its documentation.
    pub doc: &'static str,
    /// Its type.
    #[serde(rename = "type")]
    pub of_type: String,
    /// `input`, `state`, `node` or `output`.
    pub kind: &'static str,
    /// What computes it; null for an input.
    pub function: Option<&'static str>,
    /// What the function is given.
    pub reads: Vec<ReadData>,
    /// The input that clocks a state.
    pub clock: Option<&'static str>,
    /// The smallest change that reaches its readers; null where any change counts.
    pub quantum: Option<f32>,
    /// Largest update rate, leaving aside the failsafe.
    pub most_updates_hz: f64,
    /// Whether an input's period enters the hyperperiod.
    pub gates: Option<bool>,
    /// Whether an input may ask for a run.
    pub triggers: Option<bool>,
}

/// A value that a function is given.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct ReadData {
    /// Its name.
    pub name: &'static str,
    /// As it was before the run: said so, or a state's own.
    pub last: bool,
}

impl GraphData {
    /// The data of a graph.
    #[must_use]
    pub fn of(graph: &Description) -> Self {
        Self {
            name: graph.name,
            doc: graph.doc,
            hyperperiod_us: graph.hyperperiod,
            values: graph.values.iter().map(ValueData::of).collect(),
        }
    }
}

impl ValueData {
    fn of(value: &Described) -> Self {
        let data = Self {
            name: value.name,
            doc: value.doc,
            of_type: type_words(value.of_type),
            kind: "input",
            function: None,
            reads: Vec::new(),
            clock: None,
            quantum: None,
            most_updates_hz: value.most_updates as f64 / 1000.0,
            gates: None,
            triggers: None,
        };
        match value.source {
            Source::Input { gates, triggers } => Self {
                gates: Some(gates),
                triggers: Some(triggers),
                ..data
            },
            Source::Computed {
                kind,
                function,
                reads,
                quantum,
            } => {
                let (kind, clock) = match kind {
                    Kind::State { clock } => ("state", Some(clock)),
                    Kind::Node => ("node", None),
                    Kind::Output => ("output", None),
                };
                let read = |read: &Read| ReadData {
                    name: read.name,
                    last: read.last || read.name == value.name,
                };
                Self {
                    kind,
                    function: Some(function),
                    reads: reads.iter().map(read).collect(),
                    clock,
                    quantum,
                    ..data
                }
            }
        }
    }
}
