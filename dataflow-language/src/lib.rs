//! The language in which a dataflow graph is declared.
//!
//! ```text
//! tokens -> parse -> Graph -> check, order -> Plan -> a macro's own code
//! ```
//! What a graph is, and how it is declared, stands in `reflex::dataflow`. The macro of the firmware
//! turns a [`Plan`] into one kind of code; those of the benchmark turn the same plan into others.

pub mod code;
mod expression;
mod graph;
mod parse;
mod plan;

pub use expression::{Expression, Read};
pub use graph::{Computed, Gates, Graph, Input, Kind, Param, Rate, Source, Value};
pub use plan::Plan;
