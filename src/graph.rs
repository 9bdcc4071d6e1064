//! Control logics as dataflow graphs, a page each, and what all of them are asked.
//!
//! A new logic is a page here, its gains in `config/logics/` with their table in `config/src/`,
//! and two lines below.

pub mod arducopter;
pub mod cascade;
pub mod cleanflight;
mod logic;
pub mod observer;
pub mod openpilot;
#[cfg(test)]
mod testing;

pub use arducopter::ArduCopter;
pub use cascade::Cascade;
pub use cleanflight::Cleanflight;
pub use logic::ControlLogic;
pub use observer::Observer;
pub use openpilot::OpenPilot;

use logic::{place_inputs, standard_inputs};

use crate::config::HYPERPERIOD;

// What gates the graph gates the hyperperiod of the whole autopilot, in which others may too.
const _: () = assert!(
    Flown::HYPERPERIOD > 0 && HYPERPERIOD.ticks() % Flown::HYPERPERIOD == 0,
    "an input gates the control logic, but not the hyperperiod of config/reactive.toml"
);

/// The control logic that `config/selection.toml` names.
#[cfg(logic = "cascade")]
pub type Flown = Cascade;
/// The control logic that `config/selection.toml` names.
#[cfg(logic = "arducopter")]
pub type Flown = ArduCopter;
/// The control logic that `config/selection.toml` names.
#[cfg(logic = "cleanflight")]
pub type Flown = Cleanflight;
/// The control logic that `config/selection.toml` names.
#[cfg(logic = "observer")]
pub type Flown = Observer;
/// The control logic that `config/selection.toml` names.
#[cfg(logic = "openpilot")]
pub type Flown = OpenPilot;
