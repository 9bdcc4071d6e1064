//! Arguments that choose a control logic and its gains, wherever it flies.

use clap::Args;

use crate::logics::{GainSet, LogicName};
use crate::refusal::Refusal;

/// What flies.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct LogicArguments {
    /// Control logic that flies: the firmware is built with it [default: that of config/selection.toml]
    #[arg(long, value_enum)]
    logic: Option<LogicName>,
    /// Its gains: a file of config/logics/LOGIC/, or any that says what differs from config/logics/LOGIC.toml [default: none differ]
    #[arg(long, value_name = "NAME|FILE.toml")]
    gains: Option<String>,
}

impl LogicArguments {
    /// The gains, with attitude and rate loops so many times as fast.
    ///
    /// # Errors
    /// As [`GainSet::load`].
    pub(super) fn gains(&self, bandwidth: f64) -> Result<GainSet, Refusal> {
        let logic = self.logic.unwrap_or_else(LogicName::configured);
        GainSet::load(logic, self.gains.as_deref(), bandwidth)
    }
}
