//! From arming to the end of a flight: no thrust unasked, no flight without end.

use super::*;
use crate::battery::BatteryReading;
use crate::config::{
    ARMING_THRUST, BATTERY_CRITICAL_V, BATTERY_LOW_V, BLIND_TIME, DESCENT_TIME, LANDED_TIME,
    LONGEST_ON_GROUND, MOTOR_TEST_SHARE, MOTOR_TEST_TIME, SETPOINT_TIMEOUT, UPSET_TIME,
    WAITING_TIME,
};
use crate::control::MotorTest;
use crate::graph::OpenPilot;
use crate::link::{Calibrate, Destination, ExternalPose, StoreCommand};
use crate::reset::{Reset, ResetCause};
use crate::safety::{Check, FlightState};
use crate::store::{Found, NotSaved};
use crate::units::{Position, Velocity};

const ARM: Message = Message::Arm(ArmCommand::ARM);
const DISARM: Message = Message::Arm(ArmCommand::DISARM);

fn milliseconds(span: crate::time::Duration) -> u64 {
    span.ticks() / 1000
}

impl<L: ControlLogic> Rig<L> {
    fn state(&self) -> FlightState {
        self.autopilot.telemetry().state
    }

    fn shares(&self) -> MotorShares {
        self.outputs.last().expect("runs").1
    }

    /// On the ground, calibrated.
    fn standing(mut self) -> Self {
        self.milliseconds(1_000, still);
        self.told_pilot();
        self
    }
}

fn still(now: u64) -> Option<i16> {
    Some((now / 1000 % 3) as i16)
}

/// What a body at rest shows that lies on its side.
fn on_its_side(now: u64) -> ImuReading {
    felt(now, Vec3::ZERO, Vec3::new(0.0, -GRAVITY, 0.0))
}

#[test]
fn a_thrust_that_was_sent_before_arming_never_reaches_a_motor() {
    for age in [10, 500, 60_000] {
        let mut rig = Rig::new(SETTINGS).standing();
        rig.fly_at(0.7);
        rig.milliseconds(age, still);
        assert_eq!(
            rig.tell(&ARM),
            Some(Answer::TemporarilyRejected),
            "{age} ms"
        );
        rig.milliseconds(500, still);
        assert!(rig.outputs.iter().all(|(_, shares)| stopped(shares)));
        let why = if age < 1_000 {
            Check::Thrust
        } else {
            Check::Setpoint
        };
        let told = rig.told_pilot();
        let line = format!("not armed: {}", why.text());
        assert!(told.contains(&line), "{told:?}");
    }
}

#[test]
fn armed_at_no_thrust_the_drone_flies_what_comes_then() {
    let mut rig = Rig::new(SETTINGS).standing();
    rig.fly_at(ARMING_THRUST);
    assert_eq!(rig.tell(&ARM), Some(Answer::Accepted));
    rig.milliseconds(20, still);
    assert!(
        rig.shares().iter().all(|share| *share < 0.15),
        "{:?}",
        rig.shares()
    );
    assert_eq!(rig.state(), FlightState::Armed);
    rig.fly_at(0.5);
    rig.milliseconds(20, still);
    assert_eq!(rig.state(), FlightState::Flying);
    let told = rig.told_pilot();
    assert_eq!(told, ["armed: armed by the pilot", "flying: took off"]);
}

#[test]
fn each_check_refuses_to_arm_by_its_name() {
    type Spoil = fn(&mut Rig);
    let cases: [(Check, Spoil); 9] = [
        (Check::Setpoint, |_| {}),
        (Check::Thrust, |rig| rig.fly_at(0.3)),
        (Check::Still, |rig| {
            rig.fly_at(0.0);
            rig.milliseconds(300, |_| Some(200));
        }),
        (Check::Gravity, |rig| {
            rig.fly_at(0.0);
            let pressed = Vec3::new(0.0, 0.0, -1.2 * GRAVITY);
            rig.readings(300, |now| felt(now, Vec3::ZERO, pressed));
        }),
        (Check::Imu, |rig| {
            rig.fly_at(0.0);
            rig.milliseconds(300, |_| None);
        }),
        (Check::Calibration, |rig| {
            rig.fly_at(0.0);
            rig.milliseconds(300, |_| None);
            rig.milliseconds(100, still);
        }),
        (Check::MotorTest, |rig| {
            rig.fly_at(0.0);
            rig.tell(&Message::TestMotor(MotorTest {
                motor: 0,
                share: 0.1,
                length: micros(500_000),
            }));
        }),
        (Check::Configuration, |rig| {
            rig.fly_at(0.0);
            let now = at_micros(rig.now);
            rig.autopilot.on_fault(now, Fault::ImuConfiguration);
        }),
        (Check::Load, |rig| {
            rig.fly_at(0.0);
            rig.autopilot.on_fault(at_micros(rig.now), Fault::LateRun);
        }),
    ];
    for (check, spoil) in cases {
        let mut rig = Rig::new(SETTINGS).standing();
        spoil(&mut rig);
        assert_eq!(
            rig.tell(&ARM),
            Some(Answer::TemporarilyRejected),
            "{check:?}"
        );
        let told = rig.told_pilot();
        let line = format!("not armed: {}", check.text());
        assert!(told.contains(&line), "{check:?}: {told:?}");
        // What was wrong is over: it arms.
        rig.milliseconds(3_000, still);
        rig.fly_at(0.0);
        assert_eq!(
            rig.tell(&ARM),
            Some(Answer::Accepted),
            "{check:?} {:?}",
            rig.told_pilot()
        );
    }
}

/// A battery of three cells is measured.
fn measured(rig: &mut Rig, cell_v: f32) {
    let reading = BatteryReading {
        volts: 3.0 * cell_v,
        amps: 1.0,
    };
    rig.autopilot.on_battery(at_micros(rig.now), &reading);
}

#[test]
fn motors_that_were_not_answered_are_armed_no_more_until_the_next_start() {
    let mut rig = Rig::new(SETTINGS).standing();
    rig.autopilot.on_fault(at_micros(rig.now), Fault::Contrary);
    for _ in 0..2 {
        rig.milliseconds(3_000, still);
        rig.fly_at(0.0);
        rig.told_pilot();
        assert_eq!(rig.tell(&ARM), Some(Answer::TemporarilyRejected));
        let refusal = format!("not armed: {}", Check::Motors.text());
        assert_eq!(rig.told_pilot(), [refusal]);
        rig.tell(&DISARM);
    }
}

#[test]
fn a_battery_that_is_nearly_empty_ends_the_flight_and_a_low_one_begins_none() {
    let mut rig = Rig::new(SETTINGS).standing();
    measured(&mut rig, BATTERY_LOW_V - 0.1);
    rig.fly_at(0.0);
    assert_eq!(rig.tell(&ARM), Some(Answer::TemporarilyRejected));
    let refusal = format!("not armed: {}", Check::Battery.text());
    assert_eq!(rig.told_pilot(), ["battery: low, land", &refusal]);
    let mut rig = Rig::armed(SETTINGS);
    rig.flown(2_000, gusty);
    measured(&mut rig, BATTERY_CRITICAL_V - 0.1);
    for _ in 0..3 {
        rig.fly_at(0.7);
        rig.milliseconds(200, gusty);
        assert_eq!(rig.state(), FlightState::Descending);
        let thrust = rig.autopilot.graph.flown().thrust.share();
        assert!(thrust < 0.5, "the pilot's 0.7 is not flown: {thrust}");
    }
    let told = rig.told_pilot();
    let why = "descending: battery nearly empty";
    assert!(told.iter().any(|line| line == why), "{told:?}");
}

#[test]
fn a_reset_that_nobody_asked_for_is_acknowledged_by_a_disarm() {
    let mut rig = Rig::new(SETTINGS);
    let watchdog = Reset {
        cause: ResetCause::Watchdog,
        last_words: None,
        brown_out_mv: None,
    };
    rig.autopilot.on_reset(at_micros(0), &watchdog);
    let mut rig = rig.standing();
    rig.fly_at(0.0);
    assert_eq!(rig.tell(&ARM), Some(Answer::TemporarilyRejected));
    assert!(rig.told_pilot()[0].contains("reset by itself"));
    assert_eq!(rig.tell(&DISARM), Some(Answer::Accepted));
    assert_eq!(rig.tell(&ARM), Some(Answer::Accepted));
}

#[test]
fn a_tilted_drone_is_not_armed() {
    let mut rig = Rig::new(SETTINGS);
    rig.readings(1_500, on_its_side);
    rig.fly_at(0.0);
    assert_eq!(rig.tell(&ARM), Some(Answer::TemporarilyRejected));
    let tilted = format!("not armed: {}", Check::Tilt.text());
    assert!(rig.told_pilot().contains(&tilted));
}

#[test]
fn two_minutes_without_a_message_end_level_then_descending_then_on_the_ground() {
    let mut rig = Rig::armed(SETTINGS);
    rig.flown(5_000, still);
    rig.fly_at(0.8);
    let silent = milliseconds(SETPOINT_TIMEOUT);
    let wait = milliseconds(WAITING_TIME);
    rig.milliseconds(silent + 150, still);
    assert_eq!(rig.state(), FlightState::Waiting);
    let flown = rig.autopilot.graph.flown().thrust.share();
    assert!(
        (0.5..0.65).contains(&flown),
        "level at the mean flown, not at 0.8: {flown}"
    );
    rig.milliseconds(wait, still);
    assert_eq!(rig.state(), FlightState::Descending);
    rig.milliseconds(200, still);
    let sinking = rig.autopilot.graph.flown().thrust.share();
    assert!(sinking < 0.9 * flown, "{sinking}");
    rig.milliseconds(milliseconds(DESCENT_TIME), still);
    assert_eq!(rig.state(), FlightState::Disarmed);
    assert!(stopped(&rig.shares()));
    let told = rig.told_pilot();
    for line in [
        "silent: no setpoints",
        "waiting for the pilot: pilot silent",
        "descending: time is up",
        "disarmed: landed",
    ] {
        assert!(told.iter().any(|told| told == line), "{line}: {told:?}");
    }
    rig.milliseconds(90_000, still);
    assert!(stopped(&rig.shares()));
}

#[test]
fn a_pilot_who_comes_back_flies_on() {
    for silence in [SETPOINT_TIMEOUT, SETPOINT_TIMEOUT + WAITING_TIME] {
        let mut rig = Rig::armed(SETTINGS);
        rig.flown(1_000, gusty);
        rig.milliseconds(milliseconds(silence) + 300, gusty);
        assert!(!matches!(
            rig.state(),
            FlightState::Flying | FlightState::Disarmed
        ));
        rig.fly_at(0.6);
        assert_eq!(rig.state(), FlightState::Flying);
        assert!((rig.autopilot.graph.flown().thrust.share() - 0.6).abs() < 1e-6);
    }
}

#[test]
fn without_a_gyroscope_in_the_air_the_motors_are_cut_after_a_short_time() {
    for policy in [Policy::Reactive, Policy::Periodic] {
        let settings = Settings {
            policy,
            ..short_warm_up()
        };
        let mut rig = Rig::armed(settings);
        rig.flown(6_000, gusty);
        rig.fly_at(0.71);
        rig.milliseconds(20, gusty);
        rig.milliseconds(2 * milliseconds(SETTINGS.failsafe) + 110, |_| None);
        assert_eq!(rig.state(), FlightState::Blind, "{policy:?}");
        rig.fly_at(0.71);
        rig.milliseconds(milliseconds(BLIND_TIME) + 100, |_| None);
        assert!(!rig.state().is_armed(), "{policy:?}");
        assert!(stopped(&rig.shares()));
        rig.flown(60_000, |_| None);
        assert!(stopped(&rig.shares()));
    }
}

#[test]
fn a_gyroscope_that_comes_back_in_time_flies_on() {
    let mut rig = Rig::armed(short_warm_up());
    rig.flown(6_000, gusty);
    rig.milliseconds(2 * milliseconds(SETTINGS.failsafe) + 200, |_| None);
    assert_eq!(rig.state(), FlightState::Blind);
    rig.milliseconds(10, gusty);
    assert_eq!(rig.state(), FlightState::Flying);
}

#[test]
fn a_pilot_who_fell_silent_meanwhile_is_missed_when_the_gyroscope_is_back() {
    let mut rig = Rig::armed(short_warm_up());
    rig.flown(6_000, gusty);
    rig.milliseconds(milliseconds(SETPOINT_TIMEOUT) - 100, gusty);
    rig.milliseconds(450, |_| None);
    rig.milliseconds(200, gusty);
    assert_eq!(rig.state(), FlightState::Waiting);
}

#[test]
fn a_motor_test_turns_one_motor_of_a_disarmed_drone_for_its_time() {
    let test = |motor, share, ms: u64| {
        Message::TestMotor(MotorTest {
            motor,
            share,
            length: micros(ms * 1_000),
        })
    };
    let mut rig = Rig::new(SETTINGS).standing();
    assert_eq!(rig.tell(&test(1, 0.1, 500)), Some(Answer::Accepted));
    rig.milliseconds(20, still);
    assert_eq!(rig.shares().to_vec(), [0.0, 0.1, 0.0, 0.0]);
    // The next takes its place; more than is configured is not given.
    assert_eq!(rig.tell(&test(2, 0.9, 60_000)), Some(Answer::Accepted));
    rig.milliseconds(20, still);
    assert_eq!(rig.shares().to_vec(), [0.0, 0.0, MOTOR_TEST_SHARE, 0.0]);
    rig.fly_at(0.0);
    assert_eq!(rig.tell(&ARM), Some(Answer::TemporarilyRejected));
    rig.milliseconds(milliseconds(MOTOR_TEST_TIME), still);
    assert!(stopped(&rig.shares()));
    assert_eq!(rig.state(), FlightState::Disarmed);
    assert_eq!(rig.tell(&test(4, 0.1, 500)), Some(Answer::Denied));
    rig.fly_at(0.0);
    assert_eq!(rig.tell(&ARM), Some(Answer::Accepted));
    assert_eq!(
        rig.tell(&test(1, 0.1, 500)),
        Some(Answer::TemporarilyRejected)
    );
}

#[test]
fn in_the_air_a_disarm_needs_force() {
    let mut rig = Rig::armed(SETTINGS);
    rig.flown(1_000, gusty);
    assert_eq!(rig.tell(&DISARM), Some(Answer::TemporarilyRejected));
    rig.milliseconds(10, gusty);
    assert!(rig.shares().iter().all(|share| *share > 0.3));
    let told = rig.told_pilot();
    assert!(told.iter().any(|line| line.contains("21196")), "{told:?}");
    let forced = Message::Arm(ArmCommand::FORCED_DISARM);
    assert_eq!(rig.tell(&forced), Some(Answer::Accepted));
    rig.milliseconds(10, gusty);
    assert!(stopped(&rig.shares()));
}

#[test]
fn after_a_landing_a_disarm_needs_no_force_and_motors_that_nobody_uses_stop() {
    let mut rig = Rig::armed(SETTINGS);
    rig.flown(2_000, still);
    let stand = |rig: &mut Rig, ms: u64| {
        for _ in 0..ms / 500 {
            rig.fly_at(0.05);
            rig.milliseconds(500, still);
        }
    };
    stand(&mut rig, milliseconds(LANDED_TIME) + 500);
    assert_eq!(rig.state(), FlightState::Armed);
    let mut disarmed = Rig::armed(SETTINGS);
    disarmed.flown(2_000, still);
    stand(&mut disarmed, milliseconds(LANDED_TIME) + 500);
    assert_eq!(disarmed.tell(&DISARM), Some(Answer::Accepted));
    stand(&mut rig, milliseconds(LONGEST_ON_GROUND) + 500);
    assert_eq!(rig.state(), FlightState::Disarmed);
}

#[test]
fn on_the_ground_a_silent_pilot_stops_the_motors() {
    let mut rig = Rig::new(SETTINGS).standing();
    rig.fly_at(0.0);
    assert_eq!(rig.tell(&ARM), Some(Answer::Accepted));
    rig.milliseconds(milliseconds(SETPOINT_TIMEOUT) + 150, still);
    assert_eq!(rig.state(), FlightState::Disarmed);
    assert!(stopped(&rig.shares()));
}

#[test]
fn a_drone_that_lies_over_is_disarmed() {
    let mut rig = Rig::armed(SETTINGS);
    rig.flown(1_000, gusty);
    // Turned over by half a turn in half a second.
    let turning = Vec3::new(core::f32::consts::TAU, 0.0, 0.0);
    rig.readings(500, |now| felt(now, turning, Vec3::new(0.0, 0.0, -GRAVITY)));
    rig.readings(milliseconds(UPSET_TIME) + 200, |now| {
        felt(now, Vec3::ZERO, Vec3::new(0.0, 0.0, GRAVITY))
    });
    assert_eq!(rig.state(), FlightState::Disarmed);
    let told = rig.told_pilot();
    assert!(
        told.contains(&"disarmed: lies over, or astray".to_owned()),
        "{told:?}"
    );
}

#[test]
fn a_silent_pilot_of_goals_leaves_a_goal_that_is_held_then_sinks() {
    let mut rig = Rig::with_logic(SETTINGS, OpenPilot::default()).readied();
    let place = Message::Pose(ExternalPose {
        position: Position(Vec3::new(0.0, 0.0, -10.0)),
        velocity: Velocity::default(),
        attitude: None,
        reset_counter: 0,
    });
    let goal = Message::Goal(Destination {
        position: Position(Vec3::new(0.0, 0.0, -10.0)),
        velocity: Velocity::default(),
        heading: None,
    });
    rig.tell(&place);
    rig.tell(&goal);
    let seen = |rig: &mut Rig<OpenPilot>, ms: u64| {
        for _ in 0..ms / 50 {
            rig.tell(&place);
            rig.milliseconds(50, gusty);
        }
        rig.autopilot.graph.flown_to().map(|goal| goal.position.0.z)
    };
    assert_eq!(
        seen(&mut rig, milliseconds(SETPOINT_TIMEOUT) + 500),
        Some(-10.0)
    );
    assert_eq!(rig.state(), FlightState::Waiting);
    seen(&mut rig, milliseconds(WAITING_TIME));
    assert_eq!(rig.state(), FlightState::Descending);
    let begun = rig.autopilot.graph.flown_to().expect("a goal").position.0.z;
    let sunk = seen(&mut rig, 3_000).expect("a goal") - begun;
    assert!((sunk - 3.0).abs() < 0.2, "{sunk} m in 3 s");
    // Places stop: the descent goes on without.
    rig.milliseconds(milliseconds(SETPOINT_TIMEOUT) + 200, gusty);
    assert_eq!(rig.autopilot.graph.flown_to(), None);
    assert_eq!(rig.state(), FlightState::Descending);
    rig.milliseconds(milliseconds(DESCENT_TIME), gusty);
    assert_eq!(rig.state(), FlightState::Disarmed);
}

// The store, and what is measured at rest.

fn level() -> Message {
    Message::Calibrate(Calibrate::Level)
}

/// What a drone at rest feels whose accelerometer is off by so much.
fn off_by(beyond: Vec3) -> impl Fn(u64) -> ImuReading {
    move |now| felt(now, Vec3::ZERO, Vec3::new(0.0, 0.0, -GRAVITY) + beyond)
}

#[test]
fn a_level_drone_is_trimmed_and_the_trim_is_to_be_stored() {
    let beyond = Vec3::new(0.5, -0.3, 0.2);
    let mut rig = Rig::new(SETTINGS);
    rig.readings(1_200, off_by(beyond));
    rig.told_pilot();
    let leans = rig.autopilot.telemetry().attitude.down_in_body();
    assert!(leans.x.abs() > 0.03, "{leans:?}");
    assert_eq!(rig.tell(&level()), Some(Answer::Accepted));
    assert_eq!(rig.told_pilot(), ["calibrated: in force"]);
    let trim = Vec3::from_array(rig.autopilot.accel_trim());
    assert!((trim - beyond).max_norm() < 0.02, "{trim:?}");
    let wish = Wish {
        trim: true,
        ..Wish::default()
    };
    assert_eq!(rig.autopilot.to_store(), Some(wish));
    rig.readings(1_200, off_by(beyond));
    let down = rig.autopilot.telemetry().attitude.down_in_body();
    assert!(down.x.abs() < 2e-3 && down.y.abs() < 2e-3, "{down:?}");
    assert_eq!(rig.tell(&level()), Some(Answer::Accepted));
    let again = Vec3::from_array(rig.autopilot.accel_trim());
    assert!((trim - again).max_norm() < 0.02, "{trim:?} {again:?}");
}

#[test]
fn a_trim_that_was_stored_is_applied_from_the_start() {
    let settings = Settings {
        accel_trim: [0.5, -0.3, 0.2],
        ..SETTINGS
    };
    let mut rig = Rig::new(settings);
    rig.readings(1_200, off_by(Vec3::from_array(settings.accel_trim)));
    let down = rig.autopilot.telemetry().attitude.down_in_body();
    assert!(down.x.abs() < 2e-3 && down.y.abs() < 2e-3, "{down:?}");
}

#[test]
fn no_trim_is_taken_of_a_drone_that_is_armed_handled_or_slanted() {
    let slanted = Vec3::new(1.3, 0.0, 0.0);
    let why = |spoil: fn(&mut Rig), beyond: Vec3| {
        let mut rig = Rig::new(SETTINGS);
        rig.readings(1_200, off_by(beyond));
        spoil(&mut rig);
        rig.told_pilot();
        assert_eq!(rig.tell(&level()), Some(Answer::TemporarilyRejected));
        assert_eq!(rig.autopilot.accel_trim(), [0.0; 3]);
        assert_eq!(rig.autopilot.to_store(), None);
        rig.told_pilot()
    };
    let armed: fn(&mut Rig) = |rig| {
        rig.fly_at(0.0);
        assert_eq!(rig.tell(&ARM), Some(Answer::Accepted));
    };
    let handled: fn(&mut Rig) = |rig| rig.milliseconds(300, |now| Some((now / 3_000) as i16 * 9));
    let lifted: fn(&mut Rig) = |rig| {
        rig.readings(300, |now| felt(now, Vec3::ZERO, Vec3::new(2.0, 0.0, -9.6)));
    };
    let long_ago: fn(&mut Rig) =
        |rig| rig.milliseconds(1_500, |now| Some((now / 1_000 % 2) as i16 * 900));
    assert_eq!(why(armed, Vec3::ZERO), ["not calibrated: motors may turn"]);
    for spoil in [handled, lifted, long_ago] {
        assert_eq!(
            why(spoil, Vec3::ZERO),
            ["not calibrated: keep still and ask again"]
        );
    }
    let told = why(|_| {}, slanted);
    assert_eq!(told, ["not calibrated: further than 0.1 g from level"]);
}

#[test]
fn a_gyroscope_is_calibrated_where_the_drone_stands_still() {
    let gyroscope = Message::Calibrate(Calibrate::Gyroscope);
    let mut rig = Rig::new(SETTINGS).standing();
    assert_eq!(rig.tell(&gyroscope), Some(Answer::Accepted));
    assert_eq!(rig.autopilot.to_store(), None);
    rig.milliseconds(1_500, |now| Some((now / 1_000 % 2) as i16 * 900));
    assert_eq!(rig.tell(&gyroscope), Some(Answer::TemporarilyRejected));
}

#[test]
fn a_store_that_lost_something_is_told_and_acknowledged_before_arming() {
    for (found, line) in [
        (Found::Damaged, "settings: store damaged, defaults used"),
        (
            Found::OtherVersion,
            "settings: of another version, defaults used",
        ),
        (Found::PartlyKnown, "settings: some unknown, others used"),
    ] {
        let mut rig = Rig::new(SETTINGS).standing();
        rig.autopilot
            .on_store(at_micros(rig.now), StoreEvent::Found(found));
        assert_eq!(rig.told_pilot(), [line]);
        rig.fly_at(0.0);
        assert_eq!(rig.tell(&ARM), Some(Answer::TemporarilyRejected));
        let refusal = format!("not armed: {}", Check::Store.text());
        assert_eq!(rig.told_pilot(), [refusal]);
        assert_eq!(rig.tell(&DISARM), Some(Answer::Accepted));
        assert_eq!(rig.tell(&ARM), Some(Answer::Accepted), "{found:?}");
    }
    for found in [Found::Empty, Found::Sound, Found::OneCopy] {
        let mut rig = Rig::new(SETTINGS).standing();
        rig.autopilot
            .on_store(at_micros(rig.now), StoreEvent::Found(found));
        assert_eq!(rig.told_pilot().len(), usize::from(found == Found::OneCopy));
        assert_eq!(rig.autopilot.to_store().is_some(), found == Found::OneCopy);
        rig.fly_at(0.0);
        assert_eq!(rig.tell(&ARM), Some(Answer::Accepted), "{found:?}");
    }
}

#[test]
fn nothing_is_written_while_armed_nor_armed_while_something_is_written() {
    let mut rig = Rig::new(SETTINGS).standing();
    let store = |rig: &mut Rig, event| rig.autopilot.on_store(at_micros(rig.now), event);
    rig.fly_at(0.0);
    assert_eq!(rig.tell(&ARM), Some(Answer::Accepted));
    let save = Message::Store(StoreCommand::Save);
    assert_eq!(rig.tell(&save), Some(Answer::TemporarilyRejected));
    store(&mut rig, StoreEvent::KeyDue);
    assert_eq!(rig.autopilot.to_store(), None);
    rig.tell(&DISARM);
    assert!(rig.autopilot.to_store().is_some_and(|wish| wish.key));
    assert_eq!(rig.tell(&save), Some(Answer::Accepted));
    store(&mut rig, StoreEvent::Begun);
    rig.told_pilot();
    rig.fly_at(0.0);
    assert_eq!(rig.tell(&ARM), Some(Answer::TemporarilyRejected));
    assert_eq!(
        rig.told_pilot(),
        [format!("not armed: {}", Check::Storing.text())]
    );
    store(&mut rig, StoreEvent::NotSaved(NotSaved::Flash));
    assert_eq!(rig.told_pilot(), ["settings: not stored: flash failed"]);
    assert_eq!(rig.tell(&ARM), Some(Answer::Accepted));
    for stamped in rig.autopilot.recorder().iter() {
        let mut buffer = [0; LONGEST_RECORD];
        let bytes = stamped.encode(&mut buffer);
        assert_eq!(Stamped::decode(bytes), Ok((*stamped, bytes.len())));
    }
}

// Chips that are mounted another way than is said.

/// After a second of both chips' samples at rest: what refuses to arm.
fn refusals(imu: Vec3, chip: Vec3) -> Vec<String> {
    let mut rig = Rig::new(SETTINGS);
    for beat in 0..12 {
        rig.readings(100, |now| felt(now, Vec3::ZERO, imu));
        let sample = ChipSample {
            input: Input::ChipAccel,
            axes: chip + Vec3::new(0.01, -0.01, 0.02) * (beat % 5) as f32,
            cause: Cause::DataReady,
        };
        let _ = rig.autopilot.on_chip(at_micros(rig.now), &sample);
    }
    rig.fly_at(0.0);
    rig.told_pilot();
    rig.tell(&ARM);
    rig.told_pilot()
}

#[test]
fn a_chip_that_lies_another_way_is_named() {
    let (up, side) = (Vec3::new(0.0, 0.0, -GRAVITY), Vec3::new(0.0, -GRAVITY, 0.0));
    let tilted = Vec3::new(-0.3, 0.0, -0.953_94) * GRAVITY;
    let yawed = Vec3::new(0.0, -0.3, -0.953_94) * GRAVITY;
    let line = |check: Check| format!("not armed: {}", check.text());
    let (imu, chip) = (line(Check::ImuMounting), line(Check::ChipMounting));
    assert_eq!(refusals(up, up), ["armed: armed by the pilot"]);
    assert_eq!(refusals(tilted, tilted), ["armed: armed by the pilot"]);
    for wrong in [-up, side] {
        let told = refusals(up, wrong);
        assert!(told.contains(&chip) && !told.contains(&imu), "{told:?}");
        let told = refusals(wrong, up);
        assert!(told.contains(&imu), "{told:?}");
    }
    assert_eq!(refusals(tilted, yawed), [chip]);
}

#[test]
fn the_field_is_logged_while_the_drone_is_turned_by_hand_and_never_in_flight() {
    let logged = |armed: bool, rate: i16| {
        let mut rig = Rig::new(SETTINGS).standing();
        if armed {
            rig = rig.readied();
        }
        rig.milliseconds(200, |now| Some(rate + (now / 1000 % 3) as i16));
        while rig.autopilot.next_event().is_some() {}
        let sample = ChipSample {
            input: Input::ChipMag,
            axes: Vec3::new(0.2, 0.0, 0.4),
            cause: Cause::DataReady,
        };
        let _ = rig.autopilot.on_chip(at_micros(rig.now), &sample);
        let events = core::iter::from_fn(|| rig.autopilot.next_event());
        events
            .filter(|event| *event == Event::Field([0.2, 0.0, 0.4]))
            .count()
    };
    let turning = 400;
    assert_eq!(logged(false, turning), 1);
    assert_eq!(logged(false, 0), 0);
    assert_eq!(logged(true, turning), 0);
}
