//! ArduCopter's loops, from the published structure of ArduPilot 4.5.
//!
//! ```text
//! motion --+--> filter --> attitude --+--> asked ------+
//! heading -+                          |     |          +--> torque --+
//! place --> course --> target --------+     +--> rates-+             |
//! goal, setpoint --^                  |     rotation --+             +--> command
//!             climb --> lift ---------+--> thrust, hover ------------+
//! ```
//! `motion` sums what the gyroscope and accelerometer measured since the last run: it is
//! the accelerometer that shows this logic the vertical and how the drone climbs.
//!
//! | here | there |
//! |---|---|
//! | filter | `AP_AHRS_DCM`: drift correction by P and I, on gravity and compass |
//! | asked | `AC_AttitudeControl`: thrust vector before heading, square-root controllers |
//! | rates, torque | `AC_AttitudeControl_Multi`, `AC_PID` |
//! | course, climb, target | `AC_PosControl`, `AC_P_2D`, `AC_PID_2D`: to lean angles and climb |
//! | lift, thrust, hover | `AC_PosControl` (vertical), `AP_MotorsMulticopter`, angle boost |
//! | command | `AP_MotorsMatrix`: thrust raised for the attitude, headroom of yaw |
//!
//! # Its gains
//! Centidegrees and centimetres became rad and m. An output of one moves an X quadrotor's motor
//! by half of its range there and by all of it here, so that rate gains, `IMAX` and `MOT_YAW_HEADROOM` are
//! halved (`ATC_RAT_RLL_P` 0.135 is 0.0675). The angle loop halves `ATC_ACCEL_*_MAX` and limits
//! it; what is left of 1100 and 270 deg/s2 is 550 and 120. `PSC_ACCZ_P` is thrust in thousandths
//! per cm/s2: 0.5 is 0.05 per m/s2.
//!
//! # Left out
//! - input shaping (as with `ATC_RATE_FF_ENAB` 0) and with it the filter of targets, see
//!   `control/arducopter/rate.rs`;
//! - the thrust curve `MOT_THST_EXPO` and the battery: commands are shares, not thrust;
//! - gains that change with throttle or on the ground, slew limits (`SMAX`, off by default),
//!   EKF3, GPS in the drift correction, wind;
//! - what other than saturation and hover's tilt guards learning: landing detection.

use super::{ControlLogic, place_inputs, standard_inputs, tuned};
use crate::airframe::{Mixed, Mixer};
use crate::config::{CHIP_MAG, GYRO};
use crate::control::arducopter::{
    AroundHover, Asked, Climb, Course, Lift, RateLoop, RateMemory, angle_loop, boosted, climbing,
    lifted, moved, steered,
};
use crate::control::{Goal, Setpoint};
use crate::dataflow::graph;
use crate::estimate::arducopter::DriftFilter;
use crate::estimate::{Increment, Place, Rotation};
use crate::math::Quaternion;
use crate::settings::gains::arducopter::Gains;
use crate::units::{Thrust, TorqueDemand};

graph! {
    /// ArduCopter's angle, rate, position and altitude loops.
    pub struct ArduCopter;

    /// Gains, as `config/logics/arducopter.toml` has them unless others are set.
    param gains: Gains;
    /// What the motors do for a torque.
    param mixer: Mixer;
    param rate_loop: RateLoop = RateLoop::new(&gains.rate);

    /// Sums of the arrival stage since the last run.
    input motion: Increment, every GYRO.period, gates if GYRO.gates, triggers;
    /// Filtered rates and angular acceleration.
    input rotation: Rotation, every GYRO.period, gates if GYRO.gates, triggers;
    /// By how much (rad) the heading falls short of a measured one, where there is one.
    input heading: Option<f32>, every CHIP_MAG.period, triggers;
    /// What to fly where there is no goal.
    input setpoint: Setpoint, at 50 Hz, joins;
    /// Where to fly; then the setpoint counts for nothing.
    input goal: Option<Goal>, at 50 Hz, joins;
    /// Where the drone is, which clocks the position loops.
    input place: Place, at 50 Hz, joins;
    /// No motion is seen: then thrust is all that is commanded.
    input blind: bool, at 10 Hz, joins;

    /// The estimate: attitude and the gyroscope's drift.
    state filter: DriftFilter = filter.after(&motion, heading, &gains.estimate), clocked by motion;
    /// Attitude, body to Earth.
    node attitude: Quaternion = filter.attitude();

    /// Errors and integrals of the velocity.
    state course: Course = moved(&course, &place, goal, &gains), clocked by place;
    /// The attitude to fly: the lean towards the goal, or the setpoint.
    node target: Setpoint = steered(goal, &course, &setpoint, &gains);
    /// Vertical acceleration towards the goal.
    node climb: Option<Climb> = climbing(goal, &course, &gains);

    /// What the angle loop asks for.
    node asked: Asked = angle_loop(attitude, &target, &gains.angle);
    /// Integrals and the filtered yaw error of the rate loop.
    state rates: RateMemory = rate_loop.after(
        &rates, &motion, filter.correction(), &last asked, &asked, &last command
    ), clocked by motion;
    /// What the rate loop asks for.
    node torque: TorqueDemand = rate_loop.demand(&rates, &asked, &rotation, blind);

    /// Thrust of the altitude loop, and of hover as learned.
    state lift: Lift = lifted(
        &lift, &motion, attitude, last climb, &setpoint, &last command, &gains
    ), clocked by motion, starting Lift::hovering(gains.thrust.hover);
    /// Thrust, boosted by what the lean takes from it.
    node thrust: Thrust = boosted(climb, &lift, &setpoint, attitude);
    /// Thrust that hover needs.
    node hover: f32 = lift.hover();
    /// The motor vector.
    output command: Mixed = mixer.mix(torque, thrust, &AroundHover::new(hover, &gains.thrust));
}

tuned!(ArduCopter, arducopter);

impl ControlLogic for ArduCopter {
    standard_inputs!("arducopter");
    place_inputs!(logic => *logic.thrust());

    fn reset_integrals(&mut self) {
        self.set_rates(RateMemory::default());
        self.set_lift(self.lift().grounded());
    }

    fn stand(&mut self) {
        self.set_rates(RateMemory::default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::Yaw;
    use crate::graph::tests::{Body, HOVER, settled, turning, visited};
    use crate::math::Vec3;
    use crate::units::{Position, Velocity};

    fn north_of_the_goal() -> Place {
        Place {
            position: Position(Vec3::new(2.0, 0.0, 0.0)),
            velocity: Velocity::default(),
            dt: 0.02,
        }
    }

    #[test]
    fn each_input_reaches_its_own_slice() {
        let mut graph: ArduCopter = settled();
        assert_eq!(visited(&mut graph), "");

        graph.set_rotation(turning(0.1).rotation);
        assert_eq!(visited(&mut graph), "rotation torque command");

        graph.set_setpoint(Setpoint::level(Thrust::new(0.6).expect("in range")));
        assert_eq!(visited(&mut graph), "setpoint target thrust command");

        graph.take(&turning(0.2), None);
        assert_eq!(
            visited(&mut graph),
            "motion rotation filter attitude asked rates torque lift command"
        );

        graph.set_blind(true);
        assert_eq!(visited(&mut graph), "blind torque command");
    }

    #[test]
    fn a_goal_waits_for_a_place_which_then_leans_the_drone() {
        let mut graph: ArduCopter = settled();
        graph.set_goal(Some(Goal::default()));
        assert_eq!(visited(&mut graph), "goal");

        graph.set_place(north_of_the_goal());
        assert_eq!(
            visited(&mut graph),
            "place course target climb asked torque thrust command"
        );
        assert!(
            graph.asked().wanted.rates.0.y > 0.0,
            "nose up, to fly south"
        );

        graph.set_goal(None);
        graph.set_setpoint(Setpoint::level(Thrust::new(0.3).expect("in range")));
        graph.propagate();
        assert_eq!(*graph.target(), *graph.setpoint());
        assert_eq!(*graph.climb(), None);
    }

    /// A drone that starts tilted, and a logic that knows.
    fn tilted(angle: f32) -> (Body, ArduCopter) {
        let body = Body::new(Quaternion::IDENTITY.turned_by(Vec3::new(angle, 0.5 * angle, 0.0)));
        let mut logic = ArduCopter::default();
        logic.align(body.attitude);
        logic.set_setpoint(Setpoint::level(Thrust::new(HOVER).expect("in range")));
        (body, logic)
    }

    #[test]
    fn a_tilted_drone_comes_level_however_seldom_control_runs() {
        for samples in [1, 10, 30] {
            let (mut body, mut logic) = tilted(0.3);
            for _ in 0..3000 / samples {
                body.hold(samples, &logic);
                body.run(&mut logic);
            }
            let down = body.attitude.down_in_body();
            assert!(
                down.x.abs() < 0.02 && down.y.abs() < 0.02,
                "{samples} {down:?}"
            );
            assert!(body.rates.max_norm() < 0.05, "{samples} {:?}", body.rates);
        }
    }

    #[test]
    fn a_heading_is_turned_to_and_held() {
        let (mut body, mut logic) = tilted(0.0);
        logic.set_setpoint(Setpoint {
            attitude: Some(Quaternion::from_heading(1.5)),
            yaw: Yaw::Heading,
            ..*logic.setpoint()
        });
        for _ in 0..1000 {
            body.hold(5, &logic);
            body.run(&mut logic);
        }
        assert!((body.attitude.heading() - 1.5).abs() < 0.05);
    }

    #[test]
    fn a_goal_is_flown_to_and_hovered_at() {
        for samples in [1, 10, 20] {
            let (mut body, mut logic) = tilted(0.0);
            let goal = Goal {
                position: Position(Vec3::new(4.0, -3.0, -2.0)),
                heading: 0.5,
                ..Goal::default()
            };
            logic.fly_to(Some(goal));
            for sample in 0..30_000 / samples {
                body.hold(samples, &logic);
                if sample * samples % 20 == 0 {
                    logic.see(body.place());
                }
                body.run(&mut logic);
            }
            let miss = body.position - goal.position.0;
            assert!(miss.max_norm() < 0.1, "{samples} {miss:?}");
            assert!(
                body.velocity.max_norm() < 0.1,
                "{samples} {:?}",
                body.velocity
            );
            assert!((body.attitude.heading() - goal.heading).abs() < 0.05);
            assert!(
                (logic.hover() - HOVER).abs() < 0.03,
                "{samples} {}",
                logic.hover()
            );
        }
    }

    #[test]
    fn an_input_set_to_the_same_value_reaches_nothing() {
        let mut graph: ArduCopter = settled();
        graph.set_setpoint(*graph.setpoint());
        graph.set_rotation(*graph.rotation());
        graph.set_goal(*graph.goal());
        assert_eq!(visited(&mut graph), "");
    }
}
