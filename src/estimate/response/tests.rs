//! Bodies that answer their motors, lack some, or do what they like.

use super::*;
use crate::airframe::{LevelFirst, MotorShares};
use crate::sensors::GRAVITY;
use crate::time::at_micros;
use crate::units::{Thrust, TorqueDemand};
use reflex_config::load_chosen;
use std::path::Path;

/// When it breaks, in ms.
const BREAKS: u32 = 10_000;
/// Angular acceleration (rad/s2) of full authority.
const AUTHORITY: f32 = 200.0;
const HOVER: f32 = 0.5;

/// What is wrong with a flight.
#[derive(Clone, Copy)]
struct Broken {
    /// The share of its lift that a motor gives.
    motor: (usize, f32),
    /// What the gyroscope reads of the body's rates.
    seen: fn(Vec3) -> Vec3,
    /// Time between two runs, in ms.
    period: u32,
}

const WHOLE: Broken = Broken {
    motor: (0, 1.0),
    seen: |rates| rates,
    period: 10,
};

fn mixer(airframe: &str) -> Mixer {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("config");
    let chosen = |variable: &str| (variable == "REFLEX_AIRFRAME").then(|| airframe.to_owned());
    let airframe = load_chosen(&folder, chosen).expect(airframe).airframe;
    Mixer::new(&airframe.geometry())
}

/// Even noise between -1 and 1.
fn noise(step: u32, axis: u32) -> f32 {
    let mixed = (step * 3 + axis).wrapping_mul(0x9E37_79B9) ^ 0x5bd1_e995;
    (mixed.wrapping_mul(0x85EB_CA6B) >> 16) as f32 / 32_768.0 - 1.0
}

/// What is found first of a drone that turns back and forth in gusts, and when, in ms behind the
/// instant at which it breaks.
fn found(mixer: &Mixer, broken: Broken) -> Option<(i64, Unanswered)> {
    let mut response = Response::default();
    let (mut rates, mut angle, mut gust) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    let mut command = MotorShares::all(HOVER, mixer.motors());
    let mut given = command;
    for ms in 0..BREAKS + 2_000 {
        let breaks = ms >= BREAKS;
        let seen = if breaks { (broken.seen)(rates) } else { rates };
        angle += seen * 0.001;
        if ms % broken.period == 0 {
            let turn = if ms / 500 % 2 == 0 { 0.3 } else { -0.3 };
            let wanted = (Vec3::new(turn, -turn, 0.0) - angle) * 5.0;
            let torque = TorqueDemand((wanted - seen) * (16.0 / AUTHORITY));
            let thrust = Thrust::new(HOVER).expect("in range");
            command = mixer.mix(torque, thrust, &LevelFirst).shares;
        }
        for (given, command) in given.iter_mut().zip(command.iter()) {
            *given += (command - *given) * 0.03;
        }
        let mut lifted = given;
        if breaks {
            lifted[broken.motor.0] *= broken.motor.1;
        }
        let [x, y, z] = mixer.axes().map(|axis| {
            let turning: f32 = lifted
                .iter()
                .zip(axis)
                .map(|(lift, step)| lift * step)
                .sum();
            turning / axis.iter().map(|step| step * step).sum::<f32>()
        });
        gust += Vec3::new(noise(ms, 0), noise(ms, 1), noise(ms, 2)) * 0.2 - gust * 0.002;
        rates += (Vec3::new(x, y, 0.2 * z) * AUTHORITY + gust) * 0.001;
        let lift = lifted.iter().sum::<f32>() / (lifted.len() as f32 * HOVER);
        let force = Vec3::new(0.0, 0.0, -GRAVITY * lift + 0.3 * noise(ms, 3));
        let at = at_micros(u64::from(ms) * 1_000);
        if response.is_due(at) {
            let felt = [
                seen + Vec3::new(noise(ms, 4), noise(ms, 5), 0.0) * 0.005,
                force,
            ];
            let unanswered = response.look(at, felt, &mixer.asked(&command), mixer);
            if let Some(unanswered) = unanswered {
                return Some((i64::from(ms) - i64::from(BREAKS), unanswered));
            }
        }
    }
    None
}

#[test]
fn a_whole_drone_is_never_found_broken_in_gusts_and_turns() {
    for airframe in ["quad_x", "hexa_x", "y6"] {
        for period in [1, 10, 50] {
            let whole = Broken { period, ..WHOLE };
            assert_eq!(found(&mixer(airframe), whole), None, "{airframe} {period}");
        }
    }
}

#[test]
fn the_motor_that_is_lost_is_found_soon_however_rarely_control_runs() {
    for airframe in ["quad_x", "hexa_x", "y6"] {
        let mixer = mixer(airframe);
        for motor in 0..mixer.motors() {
            for period in [1, 10, 50] {
                let lost = Broken {
                    motor: (motor, 0.0),
                    period,
                    ..WHOLE
                };
                let found = found(&mixer, lost);
                let Some((0..1_000, Unanswered::Motor(told))) = found else {
                    panic!("{airframe} {motor} {period}: {found:?}");
                };
                // Two motors on one arm are hard to tell apart.
                let arm = |motor: usize| {
                    let [roll, pitch, _] = mixer.axes();
                    [roll[motor], pitch[motor]]
                };
                assert_eq!(arm(told.into()), arm(motor), "{airframe} {motor} {period}");
            }
        }
    }
}

#[test]
fn a_motor_that_lacks_a_third_of_its_lift_is_not_lost() {
    for airframe in ["quad_x", "hexa_x"] {
        let weak = Broken {
            motor: (0, 0.67),
            ..WHOLE
        };
        assert_eq!(found(&mixer(airframe), weak), None, "{airframe}");
    }
}

#[test]
fn rates_of_wrong_signs_or_axes_are_found_before_the_drone_lies_over() {
    let wrong: [fn(Vec3) -> Vec3; 4] = [
        |rates| rates * -1.0,
        |rates| Vec3::new(rates.y, rates.x, rates.z),
        |rates| Vec3::new(-rates.x, rates.y, rates.z),
        |rates| Vec3::new(rates.x, -rates.y, rates.z),
    ];
    for (case, seen) in wrong.into_iter().enumerate() {
        let found = found(&mixer("quad_x"), Broken { seen, ..WHOLE });
        assert!(
            found.is_some_and(|(ms, what)| (0..700).contains(&ms) && what == Unanswered::Rates),
            "{case}: {found:?}"
        );
    }
}

#[test]
fn a_body_that_does_what_it_likes_says_nothing_of_motors() {
    let mixer = mixer("quad_x");
    let mut response = Response::default();
    let mut rates = Vec3::ZERO;
    for look in 0..10_000u32 {
        let turn = |axis: f32| (look as f32 * (0.011 + 0.003 * axis)).sin();
        rates += Vec3::new(turn(0.0), turn(1.0), turn(2.0)) * 0.15;
        let command = MotorShares::all(HOVER, 4).map(|share| share + 0.3 * noise(look / 20, 7));
        let force = Vec3::new(0.0, 0.0, -GRAVITY * (0.8 + 0.4 * noise(look / 30, 8)));
        let at = at_micros(u64::from(look) * 8_000);
        let found = response.look(at, [rates, force], &mixer.asked(&command), &mixer);
        assert!(!matches!(found, Some(Unanswered::Motor(_))), "{look}");
    }
}
