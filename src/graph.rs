//! Control logics as dataflow graphs, a page each, and what all of them are asked.

pub mod cascade;
mod logic;
pub mod openpilot;
#[cfg(test)]
mod testing;

pub use cascade::Cascade;
pub use logic::ControlLogic;
pub use openpilot::OpenPilot;

/// The control logic that `config/selection.toml` names.
pub type Flown = Cascade;

use crate::dataflow::Description as Graph;
use logic::standard_inputs;
