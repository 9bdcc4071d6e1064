//! The options of a replay, checked.

use std::path::PathBuf;

use reflex::settings::Settings;

use crate::logics::{GainSet, LogicName, Start};
use recorded_flights::Reading;

/// The options of one replay, checked; made by the command line or by a test.
#[derive(Clone, Debug, PartialEq)]
pub struct ReplayOptions {
    /// The recorded flight; none for the one that comes with the crates.
    pub log: Option<PathBuf>,
    /// What the firmware is told; its seed also seeds noise and oscillators.
    pub settings: Settings,
    /// The gains of the control logic, which say its name.
    pub gains: GainSet,
    /// Most of the flight that is replayed, in s; none for all of it.
    pub duration_s: Option<f64>,
    /// How the log is read, and which part of it.
    pub reading: Reading,
    /// The sensors add the noise of their datasheets.
    pub noise: bool,
    /// Where the firmware's decoded log is written.
    pub defmt: Option<PathBuf>,
    /// Where the flight is written, for other tools.
    pub record: Option<PathBuf>,
    /// The script of what breaks.
    pub faults: Option<PathBuf>,
}

impl ReplayOptions {
    /// What the firmware is given at its start.
    #[must_use]
    pub fn start(&self) -> Start {
        Start::configured(self.settings, self.gains.values())
    }
}

impl Default for ReplayOptions {
    fn default() -> Self {
        Self {
            log: None,
            settings: reflex::config::SETTINGS,
            gains: LogicName::configured().into(),
            duration_s: None,
            reading: Reading::default(),
            noise: true,
            defmt: None,
            record: None,
            faults: None,
        }
    }
}
