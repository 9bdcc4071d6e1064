//! Tests of the page: slices of each input, and runs at any spacing.

use super::*;
use crate::control::Yaw;
use crate::estimate::Motion;
use crate::graph::tests::{settled, turning, visited};
use crate::math::Vec3;
use crate::sensors::GRAVITY;
use crate::units::{Position, Thrust};
use proptest::prelude::*;

fn half() -> Thrust {
    Thrust::new(0.5).expect("in range")
}

#[test]
fn each_input_reaches_its_own_slice() {
    let mut graph: OpenPilot = settled();
    assert_eq!(visited(&mut graph), "");

    graph.set_rotation(turning(0.1).rotation);
    assert_eq!(visited(&mut graph), "rotation torque command");

    graph.set_setpoint(Setpoint::level(Thrust::new(0.6).expect("in range")));
    assert_eq!(visited(&mut graph), "setpoint target command");

    graph.set_heading(Some(0.1));
    assert_eq!(visited(&mut graph), "heading");

    graph.take(&turning(0.2), None);
    assert_eq!(
        visited(&mut graph),
        "motion rotation heading filter attitude integrals wanted torque command"
    );

    graph.set_blind(true);
    assert_eq!(visited(&mut graph), "blind torque command");
    graph.set_blind(false);
    graph.run();

    graph.fly_to(Some(Goal {
        position: Position(Vec3::new(5.0, 0.0, -2.0)),
        ..Goal::default()
    }));
    assert_eq!(visited(&mut graph), "goal");

    graph.see(Place {
        dt: 0.02,
        ..Place::default()
    });
    assert_eq!(
        visited(&mut graph),
        "place path target wanted torque command"
    );
}

#[test]
fn an_input_set_to_the_same_value_reaches_nothing() {
    let mut graph: OpenPilot = settled();
    graph.set_setpoint(*graph.setpoint());
    graph.set_rotation(*graph.rotation());
    graph.set_goal(*graph.goal());
    assert_eq!(visited(&mut graph), "");
}

#[test]
fn a_rotation_without_time_advances_no_state() {
    let mut graph: OpenPilot = settled();
    graph.take(&turning(0.4), Some(0.2));
    graph.run();
    let (filter, integrals) = (*graph.filter(), *graph.integrals());
    let newest = Motion {
        rotation: turning(0.9).rotation,
        ..Motion::default()
    };
    graph.take(&newest, Some(0.3));
    graph.run();
    assert_eq!((*graph.filter(), *graph.integrals()), (filter, integrals));
}

#[test]
fn blind_it_commands_thrust_only() {
    let mut graph: OpenPilot = settled();
    graph.take(&turning(2.0), None);
    graph.run();
    assert!(*graph.torque() != TorqueDemand::default());
    graph.go_blind(true);
    graph.run();
    assert_eq!(*graph.torque(), TorqueDemand::default());
}

/// A body that turns at a rate which changes evenly, level at first.
struct Turning {
    rate: Vec3,
    acceleration: Vec3,
}

impl Turning {
    /// Motion from one time to another (s), each axis by itself: for small angles.
    fn motion(&self, from: f32, dt: f32) -> Motion {
        let rate = self.rate + self.acceleration * from;
        let angle = rate * dt + self.acceleration * (0.5 * dt * dt);
        let swept = rate * (0.5 * dt * dt) + self.acceleration * (dt * dt * dt / 6.0);
        Motion {
            sums: Increment {
                angle,
                swept,
                velocity: Vec3::new(0.0, 0.0, -GRAVITY * dt),
                dt,
                ..Increment::default()
            },
            rotation: Rotation {
                rates: BodyRates(rate + self.acceleration * dt),
                acceleration: self.acceleration,
            },
        }
    }

    /// The graph after 100 ms in this many runs.
    fn flown(&self, runs: u16) -> OpenPilot {
        let mut graph: OpenPilot = settled();
        graph.fly(Setpoint {
            attitude: Some(Quaternion::IDENTITY.turned_by(Vec3::new(0.1, -0.2, 0.1))),
            yaw: Yaw::Heading,
            ..Setpoint::level(half())
        });
        graph.run();
        let dt = 0.1 / f32::from(runs);
        for run in 0..runs {
            graph.take(&self.motion(f32::from(run) * dt, dt), Some(0.1));
            graph.run();
        }
        graph
    }
}

/// Roll (rad) every 100 ms after a step of 0.4 rad, with runs this many ms apart.
///
/// A body of 200 rad/s2 at full authority, motors that lag by 25 ms, a disturbing torque.
fn rolled(spacing: u32) -> Vec<f32> {
    let mut graph: OpenPilot = settled();
    graph.fly(Setpoint {
        attitude: Some(Quaternion::IDENTITY.turned_by(Vec3::new(0.4, 0.0, 0.0))),
        ..Setpoint::level(half())
    });
    graph.run();
    let (mut angle, mut rate, mut torque) = (0.0, 0.0, 0.0);
    let mut motion = Motion::default();
    let mut rolls = Vec::new();
    for ms in 1..=4000u32 {
        torque += (graph.torque().0.x - torque) * 0.04;
        let acceleration = 200.0 * torque + 4.0;
        rate += acceleration * 0.001;
        angle += rate * 0.001;
        let sums = &mut motion.sums;
        sums.swept.x += (sums.angle.x + 0.000_5 * rate) * 0.001;
        sums.angle.x += rate * 0.001;
        sums.dt += 0.001;
        if ms % spacing == 0 {
            motion.rotation.rates = BodyRates(Vec3::new(rate, 0.0, 0.0));
            motion.rotation.acceleration = Vec3::new(acceleration, 0.0, 0.0);
            graph.take(&motion, None);
            graph.run();
            motion = Motion::default();
        }
        if ms % 100 == 0 {
            rolls.push(angle);
        }
    }
    rolls
}

#[test]
fn a_step_of_the_attitude_is_flown_alike_at_any_spacing() {
    let often = rolled(1);
    for spacing in [1, 5, 20] {
        let rolls = rolled(spacing);
        let last = rolls.last().expect("flown");
        assert!((last - 0.4).abs() < 0.01, "{spacing} ms: {last}");
        let highest = rolls.iter().fold(0.0f32, |high, &roll| high.max(roll));
        assert!(highest < 0.5, "{spacing} ms: {highest}");
        for (roll, other) in rolls.iter().zip(&often) {
            assert!((roll - other).abs() < 0.02, "{spacing} ms: {roll} {other}");
        }
    }
}

proptest! {
    #[test]
    fn two_runs_command_what_a_hundred_do(
        x in -3.0f32..3.0, y in -3.0f32..3.0, z in -1.0f32..1.0, gain in -10.0f32..10.0
    ) {
        let turning = Turning {
            rate: Vec3::new(x, y, z),
            acceleration: Vec3::new(gain, -gain, 0.0),
        };
        let (often, rarely) = (turning.flown(100), turning.flown(2));
        let apart = (often.torque().0 - rarely.torque().0).max_norm();
        prop_assert!(apart < 1e-3, "{}", apart);
    }

    #[test]
    fn whatever_comes_every_motor_has_a_command_in_range(
        steps in prop::collection::vec(
            (prop::array::uniform6(-40.0f32..40.0), -3.0f32..3.0, 0.0f32..0.2, any::<bool>()), 1..60
        )
    ) {
        let mut graph: OpenPilot = settled();
        for ([x, y, z, north, east, down], heading, dt, to_goal) in steps {
            let body = Turning { rate: Vec3::new(x, y, z), acceleration: Vec3::new(east, x, down) };
            graph.fly_to(to_goal.then_some(Goal {
                position: Position(Vec3::new(north, east, down) * 100.0),
                heading,
                ..Goal::default()
            }));
            graph.see(Place { dt, ..Place::default() });
            graph.take(&body.motion(0.0, dt), Some(heading));
            graph.run();
            for share in graph.command().shares.iter() {
                prop_assert!((0.0..=1.0).contains(share), "{}", share);
            }
        }
    }
}
