//! Pictures of control logics: Graphviz DOT, SVG, and the same as data.
//!
//! | drawn | is |
//! |---|---|
//! | rounded box | an input: its rate, and whether it gates, triggers or joins |
//! | blue box | a state, with its clock |
//! | plain box | a node |
//! | bold box | an output |
//! | solid arrow | the value of this run |
//! | dashed arrow | the value before this run: `last`, and a state's own |
//! | dotted arrow | clocks |
//!
//! The same graph gives the same bytes.

mod data;
mod dot;
mod scene;
mod svg;
#[cfg(test)]
mod tests;

pub use data::{GraphData, ReadData, ValueData};
pub use dot::dot;
pub use svg::svg;
