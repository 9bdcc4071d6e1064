//! Any control logic, chosen while the program runs: the firmware has one built in.

mod gain_set;
mod start;
mod tapped;
#[cfg(test)]
mod tests;

use clap::ValueEnum;
use reflex::airframe::{Mixed, Mixer};
use reflex::config;
use reflex::control::{Goal, Setpoint};
use reflex::dataflow::{Description, Dirty};
use reflex::estimate::{Motion, Place};
use reflex::graph::{self, ControlLogic, Tuned};
use reflex::math::Quaternion;
use reflex::settings::gains::{self, Gains, LogicGains};
use reflex::settings::{self, BlockError};
use reflex::units::Thrust;

pub use gain_set::GainSet;
pub use start::Start;
pub use tapped::steps_of;

/// What the one list of control logics makes here: their names, and a value of any of them.
macro_rules! any_logic {
    ($($(#[$doc:meta])* $module:ident: $name:literal, $Logic:ident;)*) => {
        /// The name of a control logic, as in `config/logics/`.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
        pub enum LogicName {
            $($(#[$doc])* #[value(name = $name)] $Logic,)*
        }

        /// A control logic of some name.
        #[derive(Clone, Debug)]
        pub enum AnyLogic {
            $($(#[$doc])* $Logic(graph::$Logic),)*
        }

        /// The gains of a control logic, which say its name.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum AnyGains {
            $($(#[$doc])* $Logic(gains::$module::Gains),)*
        }

        impl AnyGains {
            /// The name of their control logic.
            #[must_use]
            pub fn name(&self) -> LogicName {
                match self {
                    $(Self::$Logic(_) => LogicName::$Logic,)*
                }
            }

            /// Their logic on an airframe's mixer, not yet flown.
            fn logic(self, mixer: Mixer) -> AnyLogic {
                match self {
                    $(Self::$Logic(gains) => AnyLogic::$Logic(graph::$Logic::with(gains, mixer)),)*
                }
            }
        }

        impl Start {
            /// The settings block that gives firmware of this logic the same.
            #[must_use]
            pub fn to_bytes(&self) -> Vec<u8> {
                let &Self { settings, airframe, gains } = self;
                match gains {
                    $(AnyGains::$Logic(gains) => {
                        settings::Start { settings, airframe, gains }.to_bytes().to_vec()
                    })*
                }
            }
        }

        impl LogicName {
            /// As in `config/selection.toml`.
            #[must_use]
            pub fn word(self) -> &'static str {
                match self {
                    $(Self::$Logic => $name,)*
                }
            }

            /// Its gains, as `config/` has them.
            #[must_use]
            pub fn gains(self) -> AnyGains {
                match self {
                    $(Self::$Logic => AnyGains::$Logic(config::$module::GAINS),)*
                }
            }

            /// Gains of these numbers, in the order of its file; `None` where some are missing.
            fn gains_of(self, numbers: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<AnyGains> {
                match self {
                    $(Self::$Logic => gains::$module::Gains::read(numbers).map(AnyGains::$Logic),)*
                }
            }

            /// What a settings block gives firmware of this logic.
            ///
            /// # Errors
            /// Why the firmware would refuse it.
            pub fn start_of(self, block: &[u8]) -> Result<Start, BlockError> {
                match self {
                    $(Self::$Logic => {
                        let settings::Start { settings, airframe, gains } =
                            settings::Start::<gains::$module::Gains>::from_bytes(block, &config::LIMITS)?;
                        Ok(Start { settings, airframe, gains: AnyGains::$Logic(gains) })
                    })*
                }
            }

            /// What its file may say.
            fn declared(self) -> &'static LogicGains {
                match self {
                    $(Self::$Logic => &gains::$module::DECLARED,)*
                }
            }

            /// Bytes that the graph takes, and those of its values one by one.
            #[must_use]
            pub fn bytes(self) -> (usize, usize) {
                match self {
                    $(Self::$Logic => (size_of::<graph::$Logic>(), graph::$Logic::STORED_BYTES),)*
                }
            }
        }

        /// The same call of whichever logic it is.
        macro_rules! whichever {
            ($any:ident, $logic:ident => $call:expr) => {
                match $any {
                    $(AnyLogic::$Logic($logic) => $call,)*
                }
            };
        }
    };
}

reflex_settings::control_logics!(any_logic);

impl LogicName {
    /// The one that is built into the firmware unless another is asked for.
    #[must_use]
    pub fn configured() -> Self {
        Self::from_str(config::LOGIC, false).unwrap_or(Self::Cascade)
    }

    /// A logic of this name as `config/` has it, not yet flown.
    #[must_use]
    pub fn logic(self) -> AnyLogic {
        self.gains().logic(Mixer::default())
    }

    /// Its place in the one list.
    #[must_use]
    pub fn place(self) -> usize {
        self as usize
    }
}

impl ControlLogic for AnyLogic {
    fn name(&self) -> &'static str {
        whichever!(self, logic => logic.name())
    }

    fn description(&self) -> Description {
        whichever!(self, logic => logic.description())
    }

    fn derivative_cutoff(&self) -> f32 {
        whichever!(self, logic => logic.derivative_cutoff())
    }

    fn align(&mut self, attitude: Quaternion) {
        whichever!(self, logic => logic.align(attitude));
    }

    fn restart(&mut self, attitude: Quaternion) {
        whichever!(self, logic => logic.restart(attitude));
    }

    fn stand(&mut self) {
        whichever!(self, logic => logic.stand());
    }

    fn reset_integrals(&mut self) {
        whichever!(self, logic => logic.reset_integrals());
    }

    fn take(&mut self, motion: &Motion, heading: Option<f32>) {
        whichever!(self, logic => logic.take(motion, heading));
    }

    fn fly(&mut self, setpoint: Setpoint) {
        whichever!(self, logic => logic.fly(setpoint));
    }

    fn flies_to_goals(&self) -> bool {
        whichever!(self, logic => logic.flies_to_goals())
    }

    fn fly_to(&mut self, goal: Option<Goal>) {
        whichever!(self, logic => logic.fly_to(goal));
    }

    fn see(&mut self, place: Place) {
        whichever!(self, logic => logic.see(place));
    }

    fn go_blind(&mut self, blind: bool) {
        whichever!(self, logic => logic.go_blind(blind));
    }

    fn run(&mut self) -> Dirty {
        whichever!(self, logic => logic.run())
    }

    fn foresee(&self) -> Mixed {
        whichever!(self, logic => logic.foresee())
    }

    fn flown(&self) -> &Setpoint {
        whichever!(self, logic => logic.flown())
    }

    fn flown_to(&self) -> Option<Goal> {
        whichever!(self, logic => logic.flown_to())
    }

    fn collective(&self) -> Thrust {
        whichever!(self, logic => logic.collective())
    }

    fn estimate(&self) -> Quaternion {
        whichever!(self, logic => logic.estimate())
    }

    fn mixed(&self) -> &Mixed {
        whichever!(self, logic => logic.mixed())
    }

    fn mixer(&self) -> &Mixer {
        whichever!(self, logic => logic.mixer())
    }

    fn lose_motor(&mut self, motor: u8) {
        whichever!(self, logic => logic.lose_motor(motor));
    }
}
