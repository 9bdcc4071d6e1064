//! What the autopilot is given at its start, whichever control logic flies.

use reflex::airframe::Mixer;
use reflex::app::{Autopilot, Recorder};
use reflex::config::GEOMETRY;
use reflex::settings::{Airframe, Settings};

use super::{AnyGains, AnyLogic};

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
    /// Settings and gains on the airframe of `config/`.
    #[must_use]
    pub fn configured(settings: Settings, gains: AnyGains) -> Self {
        Self {
            settings,
            airframe: GEOMETRY,
            gains,
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
