//! Cleanflight 1.x: Mahony's filter, level mode, floating-point PID, air mode.
//!
//! ```text
//! motion, heading --> filter --> attitude --+--> climb --> hold (clocked by place, goal)
//!                                           |               |
//! setpoint, goal ---------------------------+--> aim <------+
//!                                           |     |
//!                                           +--> wanted --+--> integrals (clocked by motion)
//!                                                 |       |       |
//! rotation, blind --------------------------------+-------+--> torque --> command
//! ```
//! `motion` clocks filter, climb and integrals. Thrust goes from the aim to the command, and to
//! the gains of the torque (throttle PID attenuation).
//!
//! After Cleanflight 1.13, `src/main/flight/`: `imu.c` (`imuMahonyAHRSupdate`), `pid_luxfloat.c`
//! ("PID controller 2", the default of its last 1.x), `mixer.c` (air mode), `altitudehold.c`,
//! `navigation.c` (GPS hold). Only the structure and the gains are its own; how gains and fixed
//! rates were converted stands in [`crate::control::cleanflight`].
//!
//! Its accelerometer is the inertial sensor's, in the same burst as the rates, so it comes in
//! `motion`. An accelerometer that compares gives the heading's field its vertical only. A goal is
//! flown from the first place behind it on, until it goes; the sticks of the original are the
//! setpoint.

use super::{ControlLogic, place_inputs, standard_inputs, tuned};
use crate::airframe::{Evenly, Mixed, Mixer};
use crate::config::{CHIP_MAG, GYRO};
use crate::control::cleanflight::{
    Aim, Climb, Hold, RateIntegrals, Sight, Stretch, aimed, climbing, demand, held, integrated,
    level,
};
use crate::control::{Goal, Setpoint, Wanted};
use crate::dataflow::graph;
use crate::estimate::{Evidence, Increment, MahonyFilter, Place, Rotation};
use crate::math::Quaternion;
use crate::settings::gains::cleanflight::Gains;
use crate::units::TorqueDemand;

graph! {
    /// Cleanflight's Mahony filter, level mode, floating-point PID and air mode.
    pub struct Cleanflight;

    /// Gains, as `config/logics/cleanflight.toml` has them unless others are set.
    param gains: Gains;
    /// What the motors do for a torque.
    param mixer: Mixer;

    /// Sums of the arrival stage since the last run.
    input motion: Increment, every GYRO.period, gates if GYRO.gates, triggers;
    /// Filtered rates and angular acceleration.
    input rotation: Rotation, every GYRO.period, gates if GYRO.gates, triggers;
    /// By how much (rad) the heading falls short of a measured one, where there is one.
    input heading: Option<f32>, every CHIP_MAG.period, triggers;
    /// What to fly, where there is no goal.
    input setpoint: Setpoint, at 50 Hz, joins;
    /// The place to hold, where there is one.
    input goal: Option<Goal>, at 50 Hz, joins;
    /// Where the drone is.
    input place: Place, at 50 Hz, joins;
    /// No motion is seen: then thrust is all that is commanded.
    input blind: bool, at 10 Hz, joins;

    /// The attitude estimate, and the gyroscope's bias.
    state filter: MahonyFilter = filter.after(&motion, Evidence {
        heading_error: heading,
        standing: last aim.thrust.share() <= 0.0,
    }, &gains.estimate), clocked by motion;
    /// Attitude, body to Earth.
    node attitude: Quaternion = filter.attitude();
    /// Vertical acceleration.
    state climb: Climb = climbing(&climb, &motion, attitude, &gains.altitude), clocked by motion;
    /// Altitude and GPS hold.
    state hold: Hold = held(&hold, &Sight {
        goal,
        place,
        thrust: setpoint.thrust,
    }, &climb, &gains), clocked by place;
    /// Lean, heading, rates and thrust: the setpoint's or the hold's.
    node aim: Aim = aimed(&setpoint, goal, &hold, attitude, &gains);
    /// Desired rates.
    node wanted: Wanted = level(attitude, &aim, &gains.level);
    /// Integral terms of the rate PID.
    state integrals: RateIntegrals = integrated(&integrals, &Stretch {
        motion: &motion,
        before: &last wanted,
        after: &wanted,
        correction: filter.correction(),
        aim: &last aim,
        down: filter.down_before(),
    }, &last command, &gains), clocked by motion;
    /// What the rate PID asks for.
    node torque: TorqueDemand = demand(&integrals, &wanted, &rotation, &aim, blind, &gains);
    /// The motor vector.
    output command: Mixed = mixer.mix(torque, aim.thrust, &Evenly);
}

tuned!(Cleanflight, cleanflight);

impl ControlLogic for Cleanflight {
    standard_inputs!("cleanflight");
    place_inputs!(logic => logic.aim().thrust);

    fn reset_integrals(&mut self) {
        self.set_integrals(RateIntegrals::default());
    }

    fn stand(&mut self) {
        self.reset_integrals();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::cleanflight::GAINS;
    use crate::estimate::Arrival;
    use crate::graph::tests::{settled, turning, visited};
    use crate::math::Vec3;
    use crate::sensors::{GRAVITY, ImuSample};
    use crate::time::at_micros;
    use crate::units::{BodyRates, Position, SpecificForce, Thrust};
    use proptest::prelude::*;

    /// A metre south of the origin, and a metre below it.
    fn off_the_goal() -> Place {
        Place {
            position: Position(Vec3::new(-1.0, 0.0, 1.0)),
            dt: 0.02,
            ..Place::default()
        }
    }

    #[test]
    fn each_input_reaches_its_own_slice() {
        let mut graph: Cleanflight = settled();
        assert_eq!(visited(&mut graph), "");

        graph.set_rotation(turning(0.1).rotation);
        assert_eq!(visited(&mut graph), "rotation torque command");

        graph.set_setpoint(Setpoint::level(Thrust::new(0.6).expect("in range")));
        assert_eq!(visited(&mut graph), "setpoint aim command");

        graph.set_blind(true);
        assert_eq!(visited(&mut graph), "blind torque command");
        graph.set_blind(false);
        assert_eq!(visited(&mut graph), "blind torque command");

        graph.set_goal(Some(Goal::default()));
        assert_eq!(visited(&mut graph), "goal");

        graph.set_place(off_the_goal());
        assert_eq!(visited(&mut graph), "place hold aim wanted command");

        graph.take(&turning(0.2), None);
        assert_eq!(
            visited(&mut graph),
            "motion rotation filter attitude wanted integrals torque command"
        );

        // Flying south of a goal at another heading, and upwards: every state and node.
        graph.set_place(off_the_goal());
        graph.run();
        let mut motion = turning(0.3);
        motion.sums.velocity = motion.sums.velocity * 1.1;
        graph.take(&motion, Some(0.5));
        assert_eq!(
            visited(&mut graph),
            "motion rotation heading filter attitude climb aim wanted integrals torque command"
        );
    }

    #[test]
    fn a_heading_reaches_the_filter_with_the_next_motion() {
        let mut graph: Cleanflight = settled();
        graph.take(&turning(0.0), Some(0.5));
        let changed = visited(&mut graph);
        assert!(
            changed.starts_with("motion heading filter attitude"),
            "{changed}"
        );
        assert!(graph.attitude().heading() > 0.0);
    }

    #[test]
    fn an_input_set_to_the_same_value_reaches_nothing() {
        let mut graph: Cleanflight = settled();
        graph.set_setpoint(*graph.setpoint());
        graph.set_rotation(*graph.rotation());
        assert_eq!(visited(&mut graph), "");
    }

    #[test]
    fn without_a_goal_the_setpoint_is_flown_again_at_once() {
        let mut graph: Cleanflight = settled();
        let before = *graph.command();
        graph.set_goal(Some(Goal::default()));
        graph.set_place(off_the_goal());
        graph.run();
        assert_ne!(*graph.command(), before);
        graph.set_goal(None);
        graph.run();
        assert_eq!(*graph.command(), before);
    }

    /// A rigid body that the graph flies, under a constant load.
    struct Body {
        graph: Cleanflight,
        arrival: Arrival,
        attitude: Quaternion,
        rates: Vec3,
        torque: Vec3,
        at: u64,
    }

    impl Body {
        fn at_rest() -> Self {
            Self {
                graph: settled(),
                arrival: Arrival::default(),
                attitude: Quaternion::IDENTITY,
                rates: Vec3::ZERO,
                torque: Vec3::ZERO,
                at: 0,
            }
        }

        /// Flies for `milliseconds` with a run at every `every`th sample.
        fn fly(&mut self, milliseconds: u64, every: u64) {
            const DT: f32 = 0.001;
            for _ in 0..milliseconds {
                self.at += 1;
                let sample = ImuSample {
                    at: at_micros(self.at * 1000),
                    rates: BodyRates(self.rates),
                    force: SpecificForce(self.attitude.to_body(Vec3::new(0.0, 0.0, -GRAVITY))),
                };
                assert!(self.arrival.take(&sample, GAINS.rate.d_cutoff_hz));
                if self.at.is_multiple_of(every) {
                    self.graph.take(&self.arrival.take_motion(), None);
                    self.graph.run();
                }
                let load = Vec3::new(0.1, 0.0, 0.0);
                let asked = self.graph.torque().0 - load;
                self.torque += (asked - self.torque) * (DT / 0.03);
                self.rates += self.torque.scale(Vec3::new(150.0, 150.0, 30.0)) * DT;
                self.attitude = self.attitude.turned_by(self.rates * DT);
            }
        }
    }

    #[test]
    fn a_body_with_a_load_comes_to_the_attitude_asked_for_however_often_control_runs() {
        for every in [1, 10, 20] {
            let mut body = Body::at_rest();
            body.fly(20, 1);
            let target = Quaternion::IDENTITY.turned_by(Vec3::new(0.3, -0.2, 0.0));
            body.graph.fly(Setpoint {
                attitude: Some(target),
                ..*body.graph.setpoint()
            });
            body.fly(4_000, every);
            let missed = body.attitude.error_to(target);
            assert!(
                missed.x.abs().max(missed.y.abs()) < 0.03,
                "{every} {missed:?}"
            );
            assert!(body.rates.max_norm() < 0.05, "{every} {:?}", body.rates);
        }
    }

    proptest! {
        #[test]
        fn rare_runs_come_to_the_integrals_of_frequent_ones(
            roll in -0.2f32..0.2, pitch in -0.2f32..0.2, yaw in -0.2f32..0.2, beat in 2.0f32..15.0
        ) {
            let (mut often, mut rarely): (Cleanflight, Cleanflight) = (settled(), settled());
            let (mut each, mut some) = (Arrival::default(), Arrival::default());
            for step in 1..=1_000u64 {
                let swing = libm::sinf(beat * step as f32 * 0.001);
                let sample = ImuSample {
                    at: at_micros(step * 1000),
                    rates: BodyRates(Vec3::new(roll, pitch, yaw) * swing),
                    force: SpecificForce(Vec3::new(0.0, 0.0, -GRAVITY)),
                };
                prop_assert!(each.take(&sample, GAINS.rate.d_cutoff_hz));
                prop_assert!(some.take(&sample, GAINS.rate.d_cutoff_hz));
                often.take(&each.take_motion(), None);
                often.run();
                // Where that begins between runs, states take the motion so far.
                prop_assert!(!often.command().saturated);
                if step.is_multiple_of(50) {
                    rarely.take(&some.take_motion(), None);
                    rarely.run();
                }
            }
            prop_assert!(rarely.attitude().error_to(*often.attitude()).max_norm() < 1e-3);
            let (often, rarely) = (often.torque().0, rarely.torque().0);
            prop_assert!((often - rarely).max_norm() < 1e-3, "{often:?} {rarely:?}");
        }
    }
}
