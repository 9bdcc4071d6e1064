//! The MPU6050 goes wrong in flight, and the other accelerometer calls control.
//!
//! One that falls silent by a supply dip is set up again within milliseconds: tested elsewhere.

use std::f64::consts::TAU;
use std::fmt::Write;

use reflex::app::{Call, Stamped};

use super::*;
use crate::firmware::Firmware;
use crate::record::Observation;
use crate::replay::emulated::Session;
use chip_models::Mpu6050;
use recorded_flights::{Flight, Rotate, Rotation};

/// Registers of the MPU6050.
const SAMPLE_RATE_DIVIDER: u8 = 0x19;
const CONFIG: u8 = 0x1a;
const STANDBY: u8 = 0x6c;

/// From one jolt to the next, and how long it lasts, in us.
const BEAT_US: u64 = 150_000;
const JOLT_US: u64 = 50_000;
/// The sensor goes wrong just before this jolt.
const WRONG_AT: u64 = 31;
const SECONDS: f64 = 4.75;

/// Jolts that push and turn by more or less, between which the drone stands still in the air.
fn jolts() -> Flight {
    let mut log = String::from("t_us,gx,gy,gz,ax,ay,az,mx,my,mz\n");
    for at_us in (0..(SECONDS * 1e6) as u64).step_by(2000) {
        let (jolt, within) = (at_us / BEAT_US, at_us % BEAT_US);
        // A permutation of the sizes, so that no size follows from the one before.
        let size = if within < JOLT_US {
            (jolt * 5 % 12) as f64 / 11.0
        } else {
            0.0
        };
        let side = if jolt % 2 == 0 { size } else { -size };
        // There and back: the angle, which setpoints follow, stays.
        let turn = 3.0 * side * (TAU * within as f64 / JOLT_US as f64).sin();
        let push = 6.0 * side;
        writeln!(log, "{at_us},{turn},0,0,{push},0,-9.8,0.2,0,0.4")
            .expect("a string takes everything");
    }
    let rotate = Rotate::Named(Rotation::NONE);
    Flight::of_bytes("jolts.csv".into(), log.as_bytes(), rotate)
        .unwrap_or_else(|fault| panic!("{fault:?}"))
}

/// The calls behind a sensor's going wrong, to the end of the jolt that follows.
fn calls_behind(goes_wrong: fn(&mut Mpu6050, u64)) -> Vec<Stamped> {
    let firmware = Firmware::build(crate::logics::LogicName::configured(), &mut Silent).unwrap();
    let options = seconds(SECONDS, reflex::config::SETTINGS);
    let mut session = Session::new(&jolts(), &options, &firmware, Vec::new()).unwrap();
    let mut observation = Observation::new(None);
    let wrong_ns = session.flight_start_ns() + (WRONG_AT * BEAT_US - 20_000) * 1000;
    let step = |session: &mut Session, observation: &mut Observation| {
        session.step(observation, &mut Silent).unwrap();
    };
    while session.now_ns() < wrong_ns {
        step(&mut session, &mut observation);
    }
    let now_ns = session.now_ns();
    goes_wrong(&mut session.chips.imu.lock().unwrap(), now_ns);
    let before = observation.calls.len();
    while session.now_ns() < now_ns + 50_000_000 {
        step(&mut session, &mut observation);
    }
    session.finish(&mut observation).unwrap();
    observation.check().unwrap();
    observation.calls.split_off(before)
}

fn check_that_the_chip_calls_control(goes_wrong: fn(&mut Mpu6050, u64)) {
    let calls = calls_behind(goes_wrong);
    let alone = calls.iter().filter(|stamped| {
        matches!(stamped.call, Call::Ran(ran) if ran.asked.sole() == Some(Input::ChipAccel))
    });
    let alone = alone.count();
    assert!(alone > 0, "no run by the chip alone");
}

#[test]
fn with_an_mpu6050_at_a_tenth_of_its_rate_the_other_chip_calls_control() {
    check_that_the_chip_calls_control(|imu, now_ns| imu.corrupt(now_ns, SAMPLE_RATE_DIVIDER, 9));
}

#[test]
fn with_an_mpu6050_that_repeats_its_sample_the_other_chip_calls_control() {
    check_that_the_chip_calls_control(|imu, now_ns| imu.corrupt(now_ns, STANDBY, 0x3f));
}

/// Its low-pass at 5 Hz is 19 ms late, beside 5 ms as configured.
#[test]
fn with_an_mpu6050_that_is_late_the_other_chip_calls_control() {
    check_that_the_chip_calls_control(|imu, now_ns| imu.corrupt(now_ns, CONFIG, 6));
}
