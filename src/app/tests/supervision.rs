//! What goes wrong, what the autopilot falls back to, and its way back.

use super::*;
use crate::config::LONGEST_WARM_UP;
use crate::math::{Quaternion, Vec3};
use crate::reactive::FallbackReason;
use crate::units::BodyRates;

/// A rig in reactive control.
fn reactive(settings: Settings) -> Rig {
    let mut rig = Rig::armed(settings);
    rig.milliseconds(6_000, gusty);
    assert_eq!(rig.phase(), Phase::Reactive);
    rig
}

fn noise(now: u64) -> Option<i16> {
    Some((((now / 1000).wrapping_mul(2_654_435_761) >> 7) % 9) as i16 - 4)
}

#[test]
fn aerobatics_are_flown_time_triggered_and_reactive_control_returns_after_them() {
    let mut rig = reactive(short_warm_up());
    let mut flip = Setpoint::level(Thrust::new(0.5).expect("in range"));
    flip.rates = BodyRates(Vec3::new(-32.0, 0.0, 0.0));
    rig.tell(&Message::Setpoint(flip));
    assert_eq!(rig.phase(), Phase::Fallback(FallbackReason::Aerobatics));
    let before = rig.outputs.len();
    rig.milliseconds(100, gusty);
    assert_eq!(rig.outputs.len() - before, 100, "runs at every sample");
    rig.milliseconds(12_000, gusty);
    assert_eq!(rig.phase(), Phase::Reactive);
}

#[test]
fn a_slow_change_of_attitude_is_no_aerobatics() {
    let mut rig = reactive(short_warm_up());
    for step in 0..50 {
        let roll = Vec3::new(0.02 * step as f32, 0.0, 0.0);
        let setpoint = Setpoint {
            attitude: Some(Quaternion::IDENTITY.turned_by(roll)),
            ..Setpoint::level(Thrust::new(0.5).expect("in range"))
        };
        rig.tell(&Message::Setpoint(setpoint));
        rig.milliseconds(20, gusty);
    }
    assert_eq!(rig.phase(), Phase::Reactive);
}

#[test]
fn runs_that_begin_late_time_and_again_end_reactive_control() {
    let mut rig = reactive(short_warm_up());
    let mut late = 0;
    while late <= crate::config::LATE_RUNS {
        rig.now += 1000;
        let now = at_micros(rig.now);
        let rate = gusty(rig.now).unwrap_or(0);
        if rig.autopilot.on_imu(now, &alive(rate, rig.now)) == Next::Hyperperiod {
            let too_late = now + HYPERPERIOD;
            rig.autopilot.on_hyperperiod(too_late);
            late += 1;
        }
    }
    assert_eq!(rig.phase(), Phase::Fallback(FallbackReason::Overrun));
    assert!(rig.autopilot.faults(Fault::LateRun) > crate::config::LATE_RUNS);
}

#[test]
fn models_that_the_flight_refutes_are_learned_again_from_scratch() {
    let mut rig = reactive(Settings {
        triggers: Inputs::NONE.with(Input::Gyro),
        p_run: 0.6,
        ..short_warm_up()
    });
    // A model that calls for a run at every breath, swapped in as a refit would be.
    let wrong = crate::reactive::Logistic { b1: 3.0, b2: 1.0 };
    let refit = crate::reactive::Refit {
        input: Input::Gyro,
        fit: Fit::Model(wrong),
    };
    rig.autopilot.on_refit(at_micros(rig.now), refit);
    rig.milliseconds(400, noise);
    assert_eq!(rig.phase(), Phase::Fallback(FallbackReason::FalsePositives));
    assert_eq!(rig.autopilot.fit(Input::Gyro), Fit::Unfit);
    assert!(rig.autopilot.outcomes(Outcome::FalsePositive) >= crate::config::JUDGED_RUNS);
    rig.flown(30_000, gusty);
    assert_eq!(rig.phase(), Phase::Reactive);
}

#[test]
fn beside_a_budget_sensors_that_ask_wrongly_are_silenced_and_reactive_control_goes_on() {
    let mut rig = reactive(short_warm_up());
    let wrong = crate::reactive::Logistic { b1: 3.0, b2: 1.0 };
    let refit = crate::reactive::Refit {
        input: Input::Gyro,
        fit: Fit::Model(wrong),
    };
    rig.autopilot.on_refit(at_micros(rig.now), refit);
    let wrongly = rig.autopilot.outcomes(Outcome::FalsePositive);
    rig.milliseconds(250, noise);
    let wrongly = rig.autopilot.outcomes(Outcome::FalsePositive) - wrongly;
    assert!(wrongly > crate::config::JUDGED_RUNS / 4, "{wrongly}");
    assert_eq!(rig.autopilot.fit(Input::Gyro), Fit::Unfit);
    assert_eq!(rig.phase(), Phase::Reactive);
}

#[test]
fn values_that_are_no_numbers_are_counted_and_reach_nothing() {
    let mut rig = reactive(short_warm_up());
    let mut setpoint = Setpoint::level(Thrust::new(0.5).expect("in range"));
    setpoint.rates = BodyRates(Vec3::new(f32::NAN, 0.0, 0.0));
    rig.tell(&Message::Setpoint(setpoint));
    let broken = crate::reactive::Logistic {
        b1: f32::NAN,
        b2: f32::INFINITY,
    };
    let refit = crate::reactive::Refit {
        input: Input::Turned,
        fit: Fit::Model(broken),
    };
    rig.autopilot.on_refit(at_micros(rig.now), refit);
    assert_eq!(rig.autopilot.faults(Fault::NotFinite), 2);
    rig.milliseconds(1_000, gusty);
    let finite = |shares: &MotorShares| shares.iter().all(|share| share.is_finite());
    assert!(rig.outputs.iter().all(|(_, shares)| finite(shares)));
    assert!(
        Input::ALL
            .into_iter()
            .all(|input| !rig.autopilot.threshold(input).is_nan())
    );
}

/// A sway that turns the body before the rate has changed by much.
fn swaying(now: u64) -> Option<i16> {
    let phase = (now % 2_000_000) as f32 * core::f32::consts::PI * 1e-6;
    Some((400.0 * phase.sin()) as i16 + noise(now).unwrap_or(0))
}

/// Lets time pass with a chip that samples at 100 Hz and carries out its orders.
fn with_chip(rig: &mut Rig, milliseconds: u64, mut counts: impl FnMut(u64) -> [i16; 3]) {
    for step in 0..milliseconds {
        if step % 500 == 0 {
            rig.fly_at(0.5);
        }
        rig.milliseconds(1, swaying);
        let now = at_micros(rig.now);
        if step % 10 == 0 {
            let sample = force(counts(rig.now), Cause::DataReady);
            let _ = rig.autopilot.on_chip(now, &sample);
        }
        while let Some(order) = rig.autopilot.next_order() {
            rig.autopilot.on_order_done(now, order, Ok(obeyed(order)));
        }
    }
}

/// Only the chip and the angle trigger, so that the chip's model is needed.
fn chip_needed() -> Settings {
    Settings {
        triggers: Inputs::NONE.with(Input::Turned).with(Input::ChipAccel),
        ..short_warm_up()
    }
}

fn moving(now: u64) -> [i16; 3] {
    let sway = swaying(now).unwrap_or(0);
    [sway * 16, (now / 10_000 % 7) as i16, -8192]
}

#[test]
fn a_chip_that_lost_its_threshold_is_programmed_within_two_failsafe_periods() {
    let mut rig = Rig::armed(chip_needed());
    with_chip(&mut rig, 12_000, moving);
    let mut reset_at = None;
    let mut armed_again_at = None;
    for _ in 0..2_000 {
        rig.milliseconds(1, swaying);
        let now = at_micros(rig.now);
        while let Some(order) = rig.autopilot.next_order() {
            let lost = OrderError::ReadBack {
                register: 0x32,
                wrote: 9,
                read: 0,
            };
            let accel = order.input == Input::ChipAccel;
            let checks = accel && order.action == ChipAction::Heartbeat;
            let result = if checks && reset_at.is_none() {
                // The chip was reset right after the last check.
                reset_at = Some(rig.now - SETTINGS.failsafe.ticks());
                Err(lost)
            } else {
                Ok(obeyed(order))
            };
            let compares = matches!(order.action, ChipAction::Threshold(_));
            if accel && compares && reset_at.is_some() {
                armed_again_at.get_or_insert(rig.now);
            }
            rig.autopilot.on_order_done(now, order, result);
        }
    }
    let (reset, armed) = (
        reset_at.expect("a check"),
        armed_again_at.expect("armed again"),
    );
    assert!(
        armed - reset <= 2 * SETTINGS.failsafe.ticks(),
        "{} us",
        armed - reset
    );
}

#[test]
fn a_chip_that_repeats_itself_ends_reactive_control_where_its_model_counts() {
    let mut rig = Rig::armed(chip_needed());
    with_chip(&mut rig, 12_000, moving);
    assert_eq!(rig.phase(), Phase::Reactive);
    assert!(matches!(rig.autopilot.fit(Input::ChipAccel), Fit::Model(_)));
    with_chip(&mut rig, 600, |_| [5, 5, -8192]);
    assert_eq!(rig.autopilot.faults(Fault::ChipStuck(Input::ChipAccel)), 1);
    assert_eq!(rig.phase(), Phase::Fallback(FallbackReason::SensorLost));
    with_chip(&mut rig, 20_000, |_| [5, 5, -8192]);
    assert_eq!(rig.phase(), Phase::Reactive, "it is flown without");
}

/// Inputs that the log of a warm-up says turned to lags, and after how many seconds.
fn turned_to_lags(seconds: u64, rate: fn(u64) -> Option<i16>) -> Vec<(u64, Inputs)> {
    let mut rig = Rig::armed(Settings {
        warm_up: WarmUp::Fixed(LONGEST_WARM_UP),
        ..SETTINGS
    });
    let mut turned = Vec::new();
    for step in 0..seconds * 10 {
        rig.fly_at(0.5);
        rig.milliseconds(100, rate);
        while let Some(event) = rig.autopilot.next_event() {
            if let Event::Lags(inputs) = event {
                turned.push((step / 10, inputs));
            }
        }
    }
    turned
}

#[test]
fn a_warm_up_in_which_nothing_changes_turns_to_lags_at_half_its_longest() {
    let half = LONGEST_WARM_UP.ticks() / 2_000_000;
    let leads = Inputs::NONE.with(Input::Owed);
    assert_eq!(turned_to_lags(half + 5, noise), [(half, leads)]);
}

#[test]
fn a_warm_up_that_learns_turns_to_no_lags() {
    assert_eq!(turned_to_lags(25, gusty), []);
}

/// How far the motors are apart, after a body was held 3 degrees off for a minute at this thrust.
fn apart_after_a_minute_held_off<L: ControlLogic + Default>(thrust: f32) -> f32 {
    let mut rig = Rig::with_logic(SETTINGS, L::default()).readied();
    let tilted = Setpoint {
        attitude: Some(Quaternion::IDENTITY.turned_by(Vec3::new(0.052, 0.0, 0.0))),
        ..Setpoint::level(Thrust::new(thrust).expect("in range"))
    };
    let mut apart = [0.0; 2];
    for second in 0..60 {
        for _ in 0..10 {
            rig.tell(&Message::Setpoint(tilted));
            rig.milliseconds(100, noise);
        }
        let shares = rig.outputs.last().expect("runs").1;
        let largest = shares.iter().copied().fold(0.0, f32::max);
        apart[usize::from(second > 0)] = shares
            .iter()
            .fold(0.0, |most: f32, share| most.max(largest - share));
    }
    apart[1] - apart[0]
}

#[test]
fn a_body_that_is_held_off_on_the_ground_winds_up_no_integral_in_any_logic() {
    for thrust in [0.0, 0.1] {
        let grown = [
            apart_after_a_minute_held_off::<Cascade>(thrust),
            apart_after_a_minute_held_off::<crate::graph::OpenPilot>(thrust),
            apart_after_a_minute_held_off::<crate::graph::ArduCopter>(thrust),
            apart_after_a_minute_held_off::<crate::graph::Cleanflight>(thrust),
            apart_after_a_minute_held_off::<crate::graph::Observer>(thrust),
        ];
        assert!(
            grown.iter().all(|grown| *grown < 0.02),
            "{thrust} {grown:?}"
        );
    }
}
