//! What the autopilot is given at its start, whichever control logic flies.

use anyhow::Result;
use reflex::airframe::Mixer;
use reflex::app::{Autopilot, Recorder};
use reflex::config::GEOMETRY;
use reflex::settings::{Airframe, Settings};
use reflex_config::Logic;

use super::{AnyGains, AnyLogic, LogicName};
use crate::refusal::Refusal;
use crate::toolchain;

/// As [`reflex::settings::Start`], with the gains of any control logic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// When control runs, and how it learns when to.
    pub settings: Settings,
    /// Where the motors are.
    pub airframe: Airframe,
    /// The gains of the control logic, which say its name.
    pub gains: AnyGains,
}

impl Start {
    /// A control logic with these settings; airframe and gains are those of `config/`.
    #[must_use]
    pub fn configured(settings: Settings, logic: LogicName) -> Self {
        Self {
            settings,
            airframe: GEOMETRY,
            gains: logic.gains(),
        }
    }

    /// The control logic, not yet flown.
    #[must_use]
    pub fn logic(&self) -> AnyLogic {
        self.gains.logic(Mixer::new(&self.airframe))
    }

    /// An autopilot that was given this.
    pub fn autopilot<R: Recorder>(&self, recorder: R) -> Autopilot<R, AnyLogic> {
        Autopilot::with_logic(self.settings, recorder, self.logic())
    }
}

impl AnyGains {
    /// The gains of `config/`, with attitude and rate loops so many times as fast.
    ///
    /// # Errors
    /// A gain that leaves its range (a refusal); a file that is none any more.
    pub fn quickened(logic: LogicName, bandwidth: f64) -> Result<Self> {
        let mut file = Logic::load(&toolchain::root().join("config"), logic.declared())?;
        file.quicken(bandwidth)
            .map_err(|line| Refusal::new(format!("--bandwidth {line}")))?;
        let mut numbers = file.numbers.iter();
        let mut bytes = || numbers.next().map(|number| (*number as f32).to_le_bytes());
        let gains = logic.gains_of(&mut bytes);
        // A file that was read has a number for each that is declared.
        Ok(gains.unwrap_or(logic.gains()))
    }
}
