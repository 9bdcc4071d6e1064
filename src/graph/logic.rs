//! What the autopilot asks of a control logic, whichever it is.

use crate::airframe::{Mixed, Mixer};
use crate::control::{Goal, Setpoint};
use crate::dataflow::{Description, Dirty};
use crate::estimate::{Motion, Place};
use crate::math::Quaternion;
use crate::settings::gains;
use crate::units::Thrust;

/// A control logic: a graph with the inputs that the autopilot brings.
///
/// The same inputs in the same order give the same commands, bit for bit.
pub trait ControlLogic {
    /// As in `config/selection.toml`.
    fn name(&self) -> &'static str;

    /// The graph as data.
    fn description(&self) -> Description;

    /// Corner (Hz) of the filter behind the angular acceleration that it wants to see.
    fn derivative_cutoff(&self) -> f32;

    /// Sets the attitude estimate, where something knows better; what was learned stays.
    fn align(&mut self, attitude: Quaternion);

    /// Begins anew with an attitude, as after states that are not finite; flies what it flew.
    fn restart(&mut self, attitude: Quaternion);

    /// Forgets integrals: for the ground, where they only wind up.
    fn reset_integrals(&mut self);

    /// The same for a drone that is armed and stands: what lifts it goes on.
    fn stand(&mut self);

    /// Motion since the last propagation, and the error of the heading (rad) where measured.
    ///
    /// Motion that covers no time advances nothing; the newest rotation counts all the same.
    fn take(&mut self, motion: &Motion, heading: Option<f32>);

    /// A new setpoint.
    fn fly(&mut self, setpoint: Setpoint);

    /// Whether it has position and altitude loops, which take goals and places.
    fn flies_to_goals(&self) -> bool {
        false
    }

    /// A place to fly to, which goes before the setpoint; `None` lets the setpoint count again.
    fn fly_to(&mut self, _goal: Option<Goal>) {}

    /// Where the drone is; states count every place, so each needs its run.
    fn see(&mut self, _place: Place) {}

    /// Whether motion is no longer seen: then thrust is all that is commanded.
    fn go_blind(&mut self, blind: bool);

    /// Runs the slice that the changed inputs reach; says which values changed.
    fn run(&mut self) -> Dirty;

    /// What [`Self::run`] would bring the command to now; advances nothing.
    fn foresee(&self) -> Mixed;

    /// The setpoint in force.
    fn flown(&self) -> &Setpoint;

    /// The goal in force.
    fn flown_to(&self) -> Option<Goal> {
        None
    }

    /// The collective thrust that the last run asked of the mixer.
    fn collective(&self) -> Thrust {
        self.flown().thrust
    }

    /// The attitude estimate of the last run.
    fn estimate(&self) -> Quaternion;

    /// The motor vector of the last run.
    fn mixed(&self) -> &Mixed;

    /// The mixer that it commands.
    fn mixer(&self) -> &Mixer;

    /// A motor, from 0, gives no lift: the others fly on.
    fn lose_motor(&mut self, motor: u8);
}

/// A control logic that is made of its gains and a mixer, by default those that were built in.
pub trait Tuned: ControlLogic + Default {
    /// Its gains.
    type Gains: gains::Gains;

    /// The logic with these gains on an airframe's mixer, before it has flown.
    fn with(gains: Self::Gains, mixer: Mixer) -> Self;
}

/// The part of [`ControlLogic`] that only hands on to inputs and values of the usual names.
macro_rules! standard_inputs {
    ($name:literal) => {
        fn name(&self) -> &'static str {
            $name
        }

        fn restart(&mut self, attitude: $crate::math::Quaternion) {
            let (setpoint, goal) = (*self.flown(), self.flown_to());
            *self = Self::new(*self.gains(), *self.mixer());
            self.align(attitude);
            self.fly_to(goal);
            self.fly(setpoint);
        }

        fn description(&self) -> $crate::dataflow::Description {
            Self::DESCRIPTION
        }

        fn derivative_cutoff(&self) -> f32 {
            self.gains().rate.d_cutoff_hz
        }

        fn take(&mut self, motion: &$crate::estimate::Motion, heading: Option<f32>) {
            if motion.sums.dt > 0.0 {
                self.set_motion(motion.sums);
                self.set_heading(heading);
            }
            self.set_rotation(motion.rotation);
        }

        fn align(&mut self, attitude: $crate::math::Quaternion) {
            self.set_filter(self.filter().turned_to(attitude));
        }

        fn fly(&mut self, setpoint: $crate::control::Setpoint) {
            self.set_setpoint(setpoint);
        }

        fn go_blind(&mut self, blind: bool) {
            self.set_blind(blind);
        }

        fn run(&mut self) -> $crate::dataflow::Dirty {
            self.propagate()
        }

        fn foresee(&self) -> $crate::airframe::Mixed {
            self.foresee_command()
        }

        fn flown(&self) -> &$crate::control::Setpoint {
            self.setpoint()
        }

        fn estimate(&self) -> $crate::math::Quaternion {
            *self.attitude()
        }

        fn mixed(&self) -> &$crate::airframe::Mixed {
            self.command()
        }

        fn mixer(&self) -> &$crate::airframe::Mixer {
            self.mixer()
        }

        fn lose_motor(&mut self, motor: u8) {
            self.set_mixer(self.mixer().without(motor));
        }
    };
}

/// The same for logics that fly to places; says which thrust they asked for.
macro_rules! place_inputs {
    ($logic:ident => $thrust:expr) => {
        fn flies_to_goals(&self) -> bool {
            true
        }

        fn fly_to(&mut self, goal: Option<$crate::control::Goal>) {
            self.set_goal(goal);
        }

        fn see(&mut self, place: $crate::estimate::Place) {
            self.set_place(place);
        }

        fn flown_to(&self) -> Option<$crate::control::Goal> {
            *self.goal()
        }

        fn collective(&self) -> $crate::units::Thrust {
            let $logic = self;
            $thrust
        }
    };
}

/// A logic's gains: their type, and those that were built in.
macro_rules! tuned {
    ($logic:ident, $module:ident) => {
        impl $crate::graph::Tuned for $logic {
            type Gains = $crate::settings::gains::$module::Gains;

            fn with(gains: Self::Gains, mixer: $crate::airframe::Mixer) -> Self {
                Self::new(gains, mixer)
            }
        }

        impl Default for $logic {
            fn default() -> Self {
                Self::new(
                    $crate::config::$module::GAINS,
                    $crate::airframe::Mixer::default(),
                )
            }
        }
    };
}

pub(super) use {place_inputs, standard_inputs, tuned};
