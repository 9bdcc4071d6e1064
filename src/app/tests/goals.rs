//! Goals and places: what is flown, what forces runs, and what silence leaves.

use super::*;
use crate::config::{SETPOINT_POSITION_QUANTUM, SETPOINT_TIMEOUT};
use crate::graph::{ArduCopter, Cascade, Cleanflight, OpenPilot};
use crate::link::{Destination, ExternalPose};
use crate::math::{Quaternion, Vec3};
use crate::units::{Position, Velocity};
use proptest::prelude::*;

fn pose(north: f32, heading: Option<f32>) -> Message {
    Message::Pose(ExternalPose {
        position: Position(Vec3::new(north, 0.0, -10.0)),
        velocity: Velocity::default(),
        attitude: heading.map(Quaternion::from_heading),
        reset_counter: 0,
    })
}

fn destination(north: f32) -> Destination {
    Destination {
        position: Position(Vec3::new(north, 0.0, -10.0)),
        velocity: Velocity::default(),
        heading: None,
    }
}

fn goal(north: f32) -> Message {
    Message::Goal(destination(north))
}

/// Milliseconds for which demands and places may fall silent.
fn timeout() -> u64 {
    SETPOINT_TIMEOUT.ticks() / 1000
}

impl<L: ControlLogic> Rig<L> {
    /// Lets time pass, in which messages come every 20 ms.
    fn told(&mut self, milliseconds: u64, messages: &[Message]) {
        for _ in 0..milliseconds / 20 {
            for message in messages {
                self.tell(message);
            }
            self.milliseconds(20, gusty);
        }
    }

    fn goal(&self) -> Option<crate::control::Goal> {
        self.autopilot.graph.flown_to()
    }

    /// How often these events were told since the last look, of those that found room.
    fn told_of(&mut self, event: Event) -> usize {
        core::iter::from_fn(|| self.autopilot.next_event())
            .filter(|told| *told == event)
            .count()
    }

    /// Lets time pass and reads the log; how often that told of an event.
    fn watched(&mut self, milliseconds: u64, messages: &[Message], event: Event) -> usize {
        let step = |_| {
            self.told(20, messages);
            self.told_of(event)
        };
        (0..milliseconds / 20).map(step).sum()
    }
}

/// Armed, and on its way to a goal of 5 m to the north.
fn under_way<L: ControlLogic>(logic: L) -> Rig<L> {
    let mut rig = Rig::with_logic(SETTINGS, logic).readied();
    rig.told(20, &[pose(0.0, None)]);
    rig.told(200, &[pose(0.0, None), goal(5.0)]);
    assert_eq!(rig.goal().map(|goal| goal.position.0.x), Some(5.0));
    rig
}

/// How much the shares of the front motors fall short of those behind.
fn leaning_forward<L>(rig: &Rig<L>) -> f32 {
    let shares = rig.outputs.last().expect("runs").1;
    let [_, pitch, _] = crate::config::GEOMETRY.allocation();
    let arms = shares.iter().zip(pitch);
    arms.map(|(share, pitch)| -share * pitch.signum()).sum()
}

fn a_goal_ahead_leans_forward<L: ControlLogic + Default>() {
    let without_goal = {
        let mut rig = Rig::with_logic(SETTINGS, L::default()).readied();
        rig.told(220, &[pose(0.0, None)]);
        leaning_forward(&rig)
    };
    let with_goal = leaning_forward(&under_way(L::default()));
    assert!(
        with_goal > without_goal + 0.05,
        "{with_goal} {without_goal}"
    );
}

#[test]
fn a_goal_ahead_leans_every_logic_with_position_loops_forward() {
    a_goal_ahead_leans_forward::<OpenPilot>();
    a_goal_ahead_leans_forward::<ArduCopter>();
    a_goal_ahead_leans_forward::<Cleanflight>();
}

/// Where the control logic sees itself after a pose so far north, of a source reset so often.
fn seen_after(rig: &mut Rig<OpenPilot>, north: f32, resets: u8) -> f32 {
    let Message::Pose(mut told) = pose(north, None) else {
        return f32::NAN;
    };
    told.reset_counter = resets;
    rig.milliseconds(20, gusty);
    rig.tell(&Message::Pose(told));
    rig.autopilot.graph.place().position.0.x
}

#[test]
fn a_source_that_was_reset_moves_neither_the_place_nor_the_goal() {
    let mut rig = under_way(OpenPilot::default());
    rig.told_of(Event::PlaceReset);
    assert_eq!(seen_after(&mut rig, 8.0, 1), 0.0);
    assert_eq!(rig.told_of(Event::PlaceReset), 1);
    assert_eq!(rig.goal().map(|goal| goal.position.0.x), Some(5.0));
    assert_eq!(seen_after(&mut rig, 8.1, 1), 8.1 - 8.0);
    // What comes from now on is meant in the frame that moved.
    rig.tell(&goal(14.0));
    assert_eq!(rig.goal().map(|goal| goal.position.0.x), Some(6.0));
    assert_eq!(rig.autopilot.faults(Fault::PlaceJump), 0);
}

#[test]
fn a_place_that_jumps_is_not_used_counted_and_told() {
    let mut rig = under_way(OpenPilot::default());
    assert_eq!(seen_after(&mut rig, 8.0, 0), 0.0);
    assert_eq!(seen_after(&mut rig, 0.1, 0), 0.1);
    assert_eq!(seen_after(&mut rig, 90.0, 0), 0.1);
    assert_eq!(rig.autopilot.faults(Fault::PlaceJump), 2);
    let lost = rig.watched(
        timeout() + 200,
        &[pose(8.0, None)],
        Event::Silent(Silence::Place),
    );
    assert_eq!(lost, 1, "as if no places came");
}

#[test]
fn places_carry_the_time_since_the_one_before_unless_that_is_long_ago() {
    let mut rig = Rig::with_logic(SETTINGS, OpenPilot::default());
    let mut dt_after = |milliseconds| {
        rig.milliseconds(milliseconds, gusty);
        rig.tell(&pose(0.0, None));
        rig.autopilot.graph.place().dt
    };
    assert_eq!(dt_after(700), 0.0, "the first");
    assert_eq!(dt_after(20), 0.02);
    assert_eq!(dt_after(500), 0.5);
    assert_eq!(dt_after(501), 0.0, "after a silence");
    assert_eq!(dt_after(100), 0.1);
}

#[test]
fn in_reactive_control_a_place_joins_and_what_is_owed_for_it_asks_for_the_run() {
    let owing = Settings {
        triggers: Inputs::ALL.without(Input::Command),
        ..short_warm_up()
    };
    let mut rig = Rig::with_logic(owing, OpenPilot::default()).readied();
    rig.told(6_000, &[pose(0.0, None), goal(0.0)]);
    assert_eq!(rig.phase(), Phase::Reactive);
    rig.milliseconds(3, resting);
    let before = rig.autopilot.recorder().len();
    rig.tell(&pose(-3.0, None));
    assert_eq!(rig.autopilot.recorder().len(), before + 1, "no run yet");
    rig.milliseconds(5, resting);
    let ran = rig.autopilot.recorder()[before..]
        .iter()
        .find_map(|stamped| match stamped.call {
            Call::Ran(ran) => Some(ran),
            _ => None,
        })
        .expect("a few samples bring a run");
    assert_eq!(ran.reason, Reason::Trigger);
    assert!(ran.asked.contains(Input::Owed), "{:?}", ran.asked);
}

#[test]
fn in_reactive_control_a_goal_past_its_quantum_forces_a_run() {
    let mut rig = Rig::with_logic(
        Settings {
            triggers: Inputs::NONE.with(Input::Gyro),
            ..short_warm_up()
        },
        OpenPilot::default(),
    )
    .readied();
    rig.told(6_000, &[pose(0.0, None), goal(0.0)]);
    let mut forces = |north| {
        rig.milliseconds(1, gusty);
        let runs = rig.reasons().len();
        rig.tell(&goal(north));
        rig.milliseconds(1, gusty);
        rig.reasons()[runs..].contains(&Reason::Setpoint)
    };
    assert!(!forces(0.0));
    assert!(!forces(0.9 * SETPOINT_POSITION_QUANTUM));
    assert!(forces(2.0 * SETPOINT_POSITION_QUANTUM));
}

#[test]
fn the_cascade_takes_no_goal_and_flies_as_without() {
    let flown = |messages: &[Message]| {
        let mut rig = Rig::with_logic(SETTINGS, Cascade::default()).readied();
        rig.told(2 * timeout(), messages);
        (rig.autopilot.faults(Fault::Goal), rig.outputs)
    };
    let (refused, outputs) = flown(&[pose(0.0, None), goal(5.0)]);
    assert_eq!(refused, u32::try_from(timeout() / 10).expect("few"));
    assert_eq!(
        flown(&[]),
        (0, outputs),
        "its setpoint is lost all the same"
    );
}

#[test]
fn a_goal_without_a_fresh_place_is_refused_and_the_setpoint_keeps_its_timeout() {
    let mut rig = Rig::with_logic(SETTINGS, OpenPilot::default()).readied();
    rig.tell(&goal(5.0));
    assert_eq!((rig.goal(), rig.autopilot.faults(Fault::Goal)), (None, 1));
    rig.told(20, &[pose(0.0, None)]);
    assert_eq!(
        rig.watched(timeout() + 200, &[], Event::Silent(Silence::Setpoint)),
        1
    );
    rig.tell(&goal(5.0));
    assert_eq!(rig.goal(), None, "the place is too old by now");
}

#[test]
fn where_places_stop_a_goal_ends_level_at_the_mean_thrust_flown() {
    let mut rig = under_way(OpenPilot::default());
    let higher = Message::Goal(Destination {
        position: Position(Vec3::new(5.0, 0.0, -11.0)),
        ..destination(5.0)
    });
    rig.told(20, &[pose(0.0, None), higher]);
    rig.told(timeout() - 100, &[higher]);
    assert!(rig.goal().is_some());
    assert_eq!(
        rig.watched(300, &[higher], Event::Silent(Silence::Place)),
        1
    );
    assert_eq!(rig.goal(), None);
    let flown = *rig.autopilot.graph.flown();
    assert_eq!(flown, Setpoint::level(flown.thrust));
    assert!(flown.thrust.share() > 0.2, "{flown:?}");
    rig.told(100, &[higher]);
    assert_eq!(rig.goal(), None, "until places come again");
    rig.told(40, &[pose(0.0, None), higher]);
    assert!(rig.goal().is_some());
}

#[test]
fn a_silent_peer_leaves_the_last_goal_held_as_long_as_places_come() {
    let mut rig = under_way(OpenPilot::default());
    let moving = Destination {
        velocity: Velocity(Vec3::new(2.0, 0.0, 0.0)),
        ..destination(5.0)
    };
    rig.told(20, &[pose(0.0, None), Message::Goal(moving)]);
    let flown = rig.goal().expect("flown");
    assert_eq!(flown.velocity, moving.velocity);
    let places = [pose(0.0, None)];
    assert_eq!(
        rig.watched(3 * timeout(), &places, Event::Silent(Silence::Goal)),
        1
    );
    let held = crate::control::Goal {
        velocity: Velocity::default(),
        ..flown
    };
    assert_eq!(rig.goal(), Some(held), "it no longer moves");
    assert_eq!(
        rig.watched(2 * timeout(), &[], Event::Silent(Silence::Place)),
        1
    );
    assert_eq!(rig.goal(), None);
}

#[test]
fn the_newest_demand_counts() {
    let mut rig = under_way(OpenPilot::default());
    let level = Setpoint::level(Thrust::new(0.4).expect("in range"));
    rig.told(20, &[pose(0.0, None), Message::Setpoint(level)]);
    assert_eq!(rig.goal(), None);
    assert_eq!(rig.autopilot.graph.collective(), level.thrust);
    rig.told(20, &[pose(0.0, None), goal(7.0)]);
    assert_eq!(rig.goal().map(|goal| goal.position.0.x), Some(7.0));
    // Goals keep it alive in the setpoint's stead.
    let alive = [pose(0.0, None), goal(7.0)];
    assert_eq!(
        rig.watched(2 * timeout(), &alive, Event::Silent(Silence::Setpoint)),
        0
    );
}

#[test]
fn without_a_heading_the_one_at_the_beginning_is_kept() {
    let mut rig = Rig::with_logic(SETTINGS, OpenPilot::default()).readied();
    rig.told(3_000, &[pose(0.0, Some(0.6))]);
    let heading = rig.autopilot.graph.estimate().heading();
    assert!(heading > 0.01, "the estimate follows slowly: {heading}");
    rig.tell(&goal(5.0));
    assert_eq!(rig.goal().map(|goal| goal.heading), Some(heading));
    rig.told(3_000, &[pose(0.0, Some(-0.6)), goal(6.0)]);
    assert_eq!(rig.goal().map(|goal| goal.heading), Some(heading));
    let turned = Destination {
        heading: Some(-0.6),
        ..destination(6.0)
    };
    rig.tell(&Message::Goal(turned));
    assert_eq!(rig.goal().map(|goal| goal.heading), Some(-0.6));
}

#[test]
fn disarming_ends_the_goal() {
    let mut rig = under_way(OpenPilot::default());
    rig.tell(&Message::Arm(ArmCommand::FORCED_DISARM));
    assert_eq!(rig.goal(), None);
    assert_eq!(*rig.autopilot.graph.flown(), Setpoint::default());
}

#[test]
fn on_the_ground_a_goal_that_nobody_repeats_is_forgotten() {
    let mut rig = under_way(OpenPilot::default());
    rig.tell(&Message::Arm(ArmCommand::FORCED_DISARM));
    rig.told(40, &[pose(0.0, None), goal(5.0)]);
    assert!(rig.goal().is_some());
    let places = [pose(0.0, None)];
    assert_eq!(
        rig.watched(timeout() + 200, &places, Event::Silent(Silence::Goal)),
        1
    );
    assert_eq!(rig.goal(), None);
    assert_eq!(*rig.autopilot.graph.flown(), Setpoint::default());
}

#[test]
fn goals_and_poses_that_are_no_numbers_are_counted_and_reach_nothing() {
    let mut rig = under_way(OpenPilot::default());
    let (before, place) = (rig.goal(), *rig.autopilot.graph.place());
    let nowhere = Velocity(Vec3::new(0.0, f32::INFINITY, 0.0));
    rig.tell(&goal(f32::NAN));
    rig.tell(&Message::Goal(Destination {
        velocity: nowhere,
        ..destination(0.0)
    }));
    rig.tell(&Message::Goal(Destination {
        heading: Some(f32::NAN),
        ..destination(0.0)
    }));
    rig.tell(&pose(f32::NEG_INFINITY, None));
    assert_eq!(rig.autopilot.faults(Fault::NotFinite), 4);
    assert_eq!((rig.goal(), *rig.autopilot.graph.place()), (before, place));
}

#[test]
fn a_recorded_flight_to_a_goal_gives_the_same_commands_bit_for_bit() {
    let mut rig = Rig::with_logic(short_warm_up(), OpenPilot::default()).readied();
    for step in 0..250u8 {
        let north = 0.02 * f32::from(step);
        rig.told(20, &[pose(north, Some(0.1)), goal(north + 1.0)]);
    }
    assert_eq!(rig.phase(), Phase::Reactive);
    rig.told(3_000, &[pose(5.0, None)]);
    rig.told(3_000, &[]);
    let mut again = Autopilot::with_logic(short_warm_up(), Vec::new(), OpenPilot::default());
    for stamped in rig.autopilot.recorder().iter() {
        let mut buffer = [0; LONGEST_RECORD];
        let (read, _) = Stamped::decode(stamped.encode(&mut buffer)).expect("a record");
        read.call.replay(read.at, &mut again);
    }
    assert!(rig.autopilot.recorder() == again.recorder());
}

proptest! {
    #[test]
    fn every_goal_survives_its_bytes_bit_for_bit(
        bits in prop::array::uniform7(any::<u32>()), given: bool, at: u64,
    ) {
        let [x, y, z, vx, vy, vz, heading] = bits.map(f32::from_bits);
        let destination = Destination {
            position: Position(Vec3::new(x, y, z)),
            velocity: Velocity(Vec3::new(vx, vy, vz)),
            heading: given.then_some(heading),
        };
        let sent = Stamped { at: at_micros(at), call: Call::Message(Message::Goal(destination)) };
        let mut buffer = [0; LONGEST_RECORD];
        let bytes = sent.encode(&mut buffer).to_vec();
        prop_assert_eq!(bytes.len(), 1 + 8 + 1 + 24 + 5);
        let (read, length) = Stamped::decode(&bytes).expect("a record");
        prop_assert_eq!(length, bytes.len());
        // Not a number equals nothing: its bytes do.
        let mut again = [0; LONGEST_RECORD];
        prop_assert_eq!(read.encode(&mut again), &bytes[..]);
        for end in 0..bytes.len() {
            prop_assert_eq!(Stamped::decode(&bytes[..end]), Err(DecodeError::Incomplete));
        }
    }
}
