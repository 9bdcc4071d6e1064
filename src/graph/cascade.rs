//! The cascade: attitude loop, rate loop, mixer. Reflex's own, and the default.
//!
//! ```text
//! motion ----+--> filter --> attitude --+
//! heading ---+                          +--> wanted --+
//! setpoint -----------------------------+             +--> torque --+
//! rotation -------------------------------------------+             +--> command
//! motion (clock) --> integrals -----------------------+             |
//! setpoint's thrust ------------------------------------------------+
//! ```
//! `motion` sums what the gyroscope and accelerometer measured since the last run; it clocks
//! every state, so that their values do not depend on how often control runs.

use super::{ControlLogic, standard_inputs, tuned};
use crate::airframe::{LevelFirst, Mixed, Mixer};
use crate::config::{CHIP_MAG, GYRO};
use crate::control::{AttitudeLaw, RateInput, RateLaw, RateState, RateStretch, Setpoint, Wanted};
use crate::dataflow::graph;
use crate::estimate::{AttitudeFilter, Corrections, Increment, Rotation};
use crate::math::{Quaternion, Vec3};
use crate::settings::gains::cascade::Gains;
use crate::units::TorqueDemand;

graph! {
    /// Attitude and rate loops in cascade, on a complementary filter.
    pub struct Cascade;

    /// Gains, as `config/logics/cascade.toml` has them unless others are set.
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
    param rate_law: RateLaw = RateLaw::new(
        [gains.rate.p, gains.rate.i, gains.rate.d], gains.rate.integral_limit
    );

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
    /// Integral terms of the rate loop.
    state integrals: RateState = rate_law.after(&integrals, &stretch(
        &motion, last filter.correction(&motion, heading, &corrections),
        &last wanted, &wanted, last command.saturated
    )), clocked by motion;
    /// What the rate loop asks for; nothing while blind, as the last demand would turn the drone over.
    node torque: TorqueDemand = if blind {
        TorqueDemand::default()
    } else {
        rate_law.demand(&integrals, &RateInput::of(wanted.rates, &rotation))
    };
    /// The motor vector.
    output command: Mixed = mixer.mix(torque, setpoint.thrust, &LevelFirst);
}

/// A motion as the rate loop's integrals see it, in which the desired rates moved from one value
/// to another.
///
/// They move with the angle turned, to first order; what is left grows from nothing and enters
/// with a third of its end, as of a parabola. `correction` is the turn (rad) that put the estimate
/// right, evenly over the time.
fn stretch(
    motion: &Increment,
    correction: Vec3,
    wanted_before: &Wanted,
    wanted: &Wanted,
    saturated: bool,
) -> RateStretch {
    let corrected = correction * (0.5 * motion.dt);
    let linear = wanted_before.integrated(motion.swept + corrected, motion.dt);
    let beside = wanted.rates.0 - wanted_before.after_turn(motion.angle + correction).0;
    RateStretch {
        wanted: linear + beside * (motion.dt * (1.0 / 3.0)),
        turned: motion.angle,
        saturated,
    }
}

tuned!(Cascade, cascade);

impl ControlLogic for Cascade {
    standard_inputs!("cascade");

    fn reset_integrals(&mut self) {
        self.set_integrals(RateState::default());
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
        let mut graph: Cascade = settled();
        assert_eq!(visited(&mut graph), "");

        graph.set_rotation(turning(0.1).rotation);
        assert_eq!(visited(&mut graph), "rotation torque command");

        graph.set_setpoint(Setpoint::level(Thrust::new(0.6).expect("in range")));
        assert_eq!(visited(&mut graph), "setpoint command");

        graph.take(&turning(0.2), None);
        assert_eq!(
            visited(&mut graph),
            "motion rotation filter attitude wanted integrals torque command"
        );
    }

    #[test]
    fn an_input_set_to_the_same_value_reaches_nothing() {
        let mut graph: Cascade = settled();
        graph.set_setpoint(*graph.setpoint());
        graph.set_rotation(*graph.rotation());
        assert_eq!(visited(&mut graph), "");
    }
}
