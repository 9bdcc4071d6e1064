//! The observer: the cascade, whose rate loop cancels what disturbs.
//!
//! ```text
//! motion ----+--> filter --> attitude --+
//! heading ---+                          +--> wanted --+
//! setpoint -----------------------------+             +--> torque --+
//! rotation ---+---------------------------------------+             +--> command
//! motion -----+--> observed --------------------------+             |
//! setpoint's thrust ------------------------------------------------+
//! ```
//! What the time that rare runs leave can buy: a model of the motors in the loop. `observed` holds
//! what it cannot explain.

use super::{ControlLogic, standard_inputs, tuned};
use crate::airframe::{LevelFirst, Mixed, Mixer};
use crate::config::{CHIP_MAG, GYRO};
use crate::control::{
    AttitudeLaw, ObserverLaw, ObserverState, ObserverStretch, RateInput, Setpoint, Wanted,
};
use crate::dataflow::graph;
use crate::estimate::{AttitudeFilter, Corrections, Increment, Rotation};
use crate::math::Quaternion;
use crate::settings::gains::observer::Gains;
use crate::units::TorqueDemand;

graph! {
    /// Attitude and rate loops in cascade, with a disturbance observer.
    pub struct Observer;

    /// Gains, as `config/logics/observer.toml` has them unless others are set.
    param gains: Gains;
    /// What the motors do for a torque.
    param mixer: Mixer;
    param corrections: Corrections = Corrections {
        gravity: gains.estimate.accel_correction,
        heading: gains.estimate.heading_correction,
    };
    param attitude_law: AttitudeLaw = AttitudeLaw::new(
        gains.attitude.p, gains.attitude.rate_limit_rad_s
    );
    param observer_law: ObserverLaw = ObserverLaw::new(&gains);

    /// Sums of the arrival stage since the last run.
    input motion: Increment, every GYRO.period, gates if GYRO.gates, triggers;
    /// Filtered rates and angular acceleration.
    input rotation: Rotation, every GYRO.period, gates if GYRO.gates, triggers;
    /// By how much (rad) the heading falls short of a measured one, where there is one.
    input heading: Option<f32>, every CHIP_MAG.period, triggers;
    /// What to fly.
    input setpoint: Setpoint, at 50 Hz, joins;
    /// No motion is seen: then thrust is all that is commanded.
    input blind: bool, at 10 Hz, joins;

    /// The attitude estimate.
    state filter: AttitudeFilter = filter.stepped(&motion, heading, &corrections), clocked by motion;
    /// Attitude, body to Earth.
    node attitude: Quaternion = filter.attitude();
    /// What the attitude loop asks for.
    node wanted: Wanted = attitude_law.wanted(attitude, &setpoint);
    /// What turns the body besides the motors.
    state observed: ObserverState = observer_law.after(&observed, &ObserverStretch {
        asked: last torque,
        rates: rotation.rates,
        dt: motion.dt,
        saturated: last command.saturated,
    }), clocked by motion;
    /// What the rate loop asks for; nothing while blind, as the last demand would turn the drone over.
    node torque: TorqueDemand = if blind {
        TorqueDemand::default()
    } else {
        observer_law.demand(&observed, &RateInput::of(wanted.rates, &rotation))
    };
    /// The motor vector.
    output command: Mixed = mixer.mix(torque, setpoint.thrust, &LevelFirst);
}

tuned!(Observer, observer);

impl ControlLogic for Observer {
    standard_inputs!("observer");

    fn reset_integrals(&mut self) {
        self.set_observed(self.observed().undisturbed());
    }

    fn stand(&mut self) {
        self.reset_integrals();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::tests::{settled, turning, visited};
    use crate::units::Thrust;

    #[test]
    fn each_input_reaches_its_own_slice() {
        let mut graph: Observer = settled();
        assert_eq!(visited(&mut graph), "");

        graph.set_rotation(turning(0.1).rotation);
        assert_eq!(visited(&mut graph), "rotation torque command");

        graph.set_setpoint(Setpoint::level(Thrust::new(0.6).expect("in range")));
        assert_eq!(visited(&mut graph), "setpoint command");

        graph.take(&turning(0.2), None);
        assert_eq!(
            visited(&mut graph),
            "motion rotation filter attitude wanted observed torque command"
        );
    }

    #[test]
    fn what_was_seen_to_disturb_is_forgotten_on_the_ground() {
        let mut graph: Observer = settled();
        graph.take(&turning(0.2), None);
        graph.run();
        assert_ne!(*graph.observed(), graph.observed().undisturbed());
        graph.reset_integrals();
        assert_eq!(*graph.observed(), graph.observed().undisturbed());
    }
}
