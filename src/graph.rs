//! Control logics as dataflow graphs, a page each, and what all of them are asked.
//!
//! The list of them is `settings/src/logics.rs`; it makes a module of each page here.

mod logic;
#[cfg(test)]
pub(crate) mod tests;

pub use logic::{ControlLogic, Tuned};

use logic::{place_inputs, standard_inputs, tuned};

use crate::config::HYPERPERIOD;
use crate::settings::Start;

/// A module and a type for each page, and the one that is flown.
macro_rules! pages {
    ($($(#[$doc:meta])* $module:ident: $name:literal, $Logic:ident;)*) => {$(
        pub mod $module;
        pub use $module::$Logic;

        /// The control logic that `config/selection.toml` names.
        #[cfg(logic = $name)]
        pub type Flown = $Logic;

        /// What a start is given where no block brings anything else: what `config/` says.
        #[cfg(logic = $name)]
        pub const CONFIGURED: Start<<Flown as Tuned>::Gains> = Start {
            settings: crate::config::SETTINGS,
            airframe: crate::config::GEOMETRY,
            gains: crate::config::$module::GAINS,
        };
    )*};
}

reflex_settings::control_logics!(pages);

// What gates the graph gates the hyperperiod of the whole autopilot, in which others may too.
const _: () = assert!(
    Flown::HYPERPERIOD > 0 && HYPERPERIOD.ticks() % Flown::HYPERPERIOD == 0,
    "an input gates the control logic, but not the hyperperiod of config/reactive.toml"
);
