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
//! `motion` sums what the MPU6050's gyroscope and accelerometer saw since the last run; it clocks
//! every state, so that what they come to does not depend on how often control runs.

use super::{ControlLogic, standard_inputs};
use crate::airframe::{MIXER, Mixed};
use crate::config::cascade::RATE_D_CUTOFF;
use crate::config::{CHIP_MAG, GYRO};
use crate::control::{AttitudeLaw, RateInput, RateLaw, RateState, RateStretch, Setpoint, Wanted};
use crate::dataflow::graph;
use crate::estimate::{AttitudeFilter, Increment, Rotation};
use crate::math::{Quaternion, Vec3};
use crate::units::TorqueDemand;

graph! {
    /// Attitude and rate loops in cascade, on a complementary filter.
    pub struct Cascade;

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
    state filter: AttitudeFilter = filter.stepped(&motion, heading), clocked by motion;
    /// Attitude, body to Earth.
    node attitude: Quaternion = filter.attitude();
    /// What the attitude loop asks for.
    node wanted: Wanted = ATTITUDE_LAW.wanted(attitude, &setpoint);
    /// Integral terms of the rate loop.
    state integrals: RateState = integrated(
        &integrals, &motion, heading, &last filter, &last wanted, &wanted, &last command
    ), clocked by motion;
    /// What the rate loop asks for; nothing while blind, as the last demand would turn the drone over.
    node torque: TorqueDemand = if blind {
        TorqueDemand::default()
    } else {
        RATE_LAW.demand(&integrals, &RateInput::of(wanted.rates, &rotation))
    };
    /// The motor vector.
    output command: Mixed = MIXER.mix(torque, setpoint.thrust);
}

const ATTITUDE_LAW: AttitudeLaw = AttitudeLaw::CONFIGURED;
const RATE_LAW: RateLaw = RateLaw::CONFIGURED;

/// The integrals after this motion, in which the desired rates moved from one value to another.
///
/// They move with the angle turned, to first order; what is left grows from nothing and enters
/// with a third of its end, as of a parabola.
pub fn integrated(
    state: &RateState,
    motion: &Increment,
    heading: Option<f32>,
    before: &AttitudeFilter,
    wanted_before: &Wanted,
    wanted: &Wanted,
    command: &Mixed,
) -> RateState {
    let correction = before.correction(motion, heading);
    // Evenly over the time.
    let corrected = correction * (0.5 * motion.dt);
    let linear = wanted_before.integrated(motion.swept + corrected, motion.dt);
    let beside = wanted.rates.0 - wanted_before.after_turn(motion.angle + correction).0;
    let stretch = RateStretch {
        wanted: linear + beside * (motion.dt * (1.0 / 3.0)),
        turned: motion.angle,
        saturated: command.saturated,
    };
    RATE_LAW.after(state, &stretch)
}

impl ControlLogic for Cascade {
    standard_inputs!("cascade", RATE_D_CUTOFF);

    fn align(&mut self, force: Vec3) {
        self.set_filter(self.filter().aligned(force));
    }

    fn reset_integrals(&mut self) {
        self.set_integrals(RateState::default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::testing::{settled, turning, visited};
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
