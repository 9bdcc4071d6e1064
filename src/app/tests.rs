//! The autopilot through its door: warm-up, triggers, failsafe, determinism.

use super::*;
use crate::airframe::MotorShares;
use crate::battery::{BatteryReading, BatteryState};
use crate::config::{GEOMETRY, HYPERPERIOD, SETTINGS};
use crate::control::Setpoint;
use crate::graph::Cascade;
use crate::link::{Answer, ArmCommand, Message};
use crate::math::Vec3;
use crate::reactive::{Fit, Refit};
use crate::reset::{Ending, LastWords, Mode, Reset, ResetCause};
use crate::sensors::{Cause, GRAVITY, ImuReading, Input, Inputs};
use crate::settings::{Policy, WarmUp};
use crate::time::{at_micros, micros, span};
use crate::units::{BodyRates, SpecificForce, Thrust};

use rig::{Rig, force, obeyed, turning};

mod chips;
mod flight;
mod gaps;
mod goals;
mod rig;
mod supervision;

/// A gust every quarter second over a little noise, in counts.
fn gusty(now: u64) -> Option<i16> {
    let noise = ((now / 1000).wrapping_mul(2_654_435_761) >> 7) % 9;
    let gust = if now / 1000 % 250 < 60 { 400 } else { 0 };
    Some(noise as i16 - 4 + gust)
}

fn stopped(shares: &MotorShares) -> bool {
    shares.len() == GEOMETRY.count() && shares.iter().all(|share| *share == 0.0)
}

fn short_warm_up() -> Settings {
    Settings {
        warm_up: WarmUp::Fixed(micros(4_000_000)),
        ..SETTINGS
    }
}

#[test]
fn it_refuses_to_arm_before_the_gyroscope_is_calibrated() {
    let mut rig = Rig::new(SETTINGS);
    rig.milliseconds(100, |_| Some(0));
    assert_eq!(
        rig.tell(&Message::Arm(ArmCommand::ARM)),
        Some(Answer::TemporarilyRejected)
    );
    rig.milliseconds(1000, |_| Some(0));
    rig.fly_at(0.0);
    assert_eq!(
        rig.tell(&Message::Arm(ArmCommand::ARM)),
        Some(Answer::Accepted)
    );
}

#[test]
fn motors_stay_stopped_until_armed_and_stop_when_disarmed() {
    let mut rig = Rig::new(SETTINGS);
    rig.milliseconds(1000, |_| Some(0));
    assert!(rig.outputs.iter().all(|(_, shares)| stopped(shares)));
    let mut rig = Rig::armed(SETTINGS);
    rig.milliseconds(10, |_| Some(0));
    assert!(
        rig.outputs
            .last()
            .expect("runs")
            .1
            .iter()
            .all(|share| *share > 0.3)
    );
    rig.tell(&Message::Arm(ArmCommand::FORCED_DISARM));
    rig.milliseconds(10, |_| Some(0));
    assert!(stopped(&rig.outputs.last().expect("runs").1));
}

#[test]
fn warm_up_fits_a_model_and_reactive_control_spares_runs_whatever_leads() {
    for (lead, other) in [(Input::Owed, Input::Command), (Input::Command, Input::Owed)] {
        let mut rig = Rig::armed(Settings {
            triggers: Inputs::ALL.without(other),
            ..short_warm_up()
        });
        rig.milliseconds(4_600, gusty);
        assert_eq!(rig.phase(), Phase::Reactive);
        let fit = rig.autopilot.fit(lead);
        assert!(matches!(fit, Fit::Model(_)), "{lead:?} {fit:?}");
        let before = rig.outputs.len();
        rig.milliseconds(4_000, gusty);
        let runs = rig.outputs.len() - before;
        assert!(
            (40..3_000).contains(&runs),
            "{lead:?}: {runs} runs in 4000 hyperperiods"
        );
        assert!(rig.reasons().contains(&Reason::Trigger));
    }
}

#[test]
fn no_gap_between_runs_is_longer_than_the_failsafe_even_without_a_gyroscope() {
    let mut rig = Rig::armed(short_warm_up());
    rig.milliseconds(6_000, gusty);
    rig.milliseconds(3_000, |_| None);
    rig.milliseconds(3_000, gusty);
    let longest = rig
        .outputs
        .windows(2)
        .map(|pair| pair[1].0 - pair[0].0)
        .max()
        .expect("runs");
    let bound = SETTINGS.failsafe + HYPERPERIOD;
    assert!(longest <= bound.ticks(), "{longest} us");
    assert!(rig.autopilot.faults(Fault::ImuSilent) > 0);
}

#[test]
fn a_lost_gyroscope_falls_back_and_warms_up_again_when_it_returns() {
    let mut rig = Rig::armed(short_warm_up());
    rig.milliseconds(6_000, gusty);
    rig.milliseconds(500, |_| None);
    assert!(matches!(rig.phase(), Phase::Fallback(_)));
    rig.milliseconds(10, gusty);
    assert_eq!(rig.phase(), Phase::WarmUp);
}

#[test]
fn a_chip_interrupt_without_gating_samples_runs_at_one_and_a_half_periods() {
    let mut rig = Rig::armed(short_warm_up());
    rig.milliseconds(6_000, gusty);
    let now = at_micros(rig.now + 300);
    let next = rig
        .autopilot
        .on_chip(now, &force([0, 0, -8192], Cause::Threshold));
    let Next::HyperperiodAt(at) = next else {
        panic!("{next:?}");
    };
    assert_eq!(span(at_micros(rig.now), at), HYPERPERIOD * 3 / 2);
    assert!(rig.autopilot.on_hyperperiod(now).is_none());
    assert!(rig.autopilot.on_hyperperiod(at).is_some());
}

#[test]
fn in_reactive_control_the_chip_is_told_its_threshold() {
    // Where the gyroscope tells first, no chip is needed.
    let mut rig = Rig::armed(Settings {
        triggers: Inputs::NONE.with(Input::Turned).with(Input::ChipAccel),
        ..short_warm_up()
    });
    for step in 0..10_000 {
        rig.milliseconds(1, gusty);
        if step % 10 == 0 {
            let gust = gusty(rig.now).unwrap_or(0);
            let now = at_micros(rig.now);
            let sample = force([gust * 16, 0, -8192], Cause::DataReady);
            let _ = rig.autopilot.on_chip(now, &sample);
        }
        while let Some(order) = rig.autopilot.next_order() {
            rig.autopilot
                .on_order_done(at_micros(rig.now), order, Ok(obeyed(order)));
        }
    }
    let told = rig.autopilot.recorder().iter().any(|stamped| {
        matches!(
            stamped.call,
            Call::OrderDone(order, Ok(ChipSetting::PastThreshold { level, .. }))
                if order.input == Input::ChipAccel && level > 0.0
        )
    });
    assert!(told, "{:?}", rig.autopilot.fit(Input::ChipAccel));
}

#[test]
fn a_chip_that_fails_is_asked_again_now_and_then_and_does_not_hold_up_the_other() {
    let mut rig = Rig::armed(short_warm_up());
    let (mut failed, mut done) = (0, 0);
    for _ in 0..1_000 {
        rig.milliseconds(1, gusty);
        let now = at_micros(rig.now);
        while let Some(order) = rig.autopilot.next_order() {
            let accel = order.input == Input::ChipAccel;
            let result = if accel {
                Err(OrderError::Bus)
            } else {
                Ok(obeyed(order))
            };
            (failed, done) = if accel {
                (failed + 1, done)
            } else {
                (failed, done + 1)
            };
            rig.autopilot.on_order_done(now, order, result);
        }
    }
    assert!((9..=11).contains(&failed), "{failed} attempts in a second");
    assert!(done > 5, "{done} orders for the magnetometer");
}

#[test]
fn a_lost_gyroscope_is_noticed_though_the_other_chip_keeps_asking_for_runs() {
    let mut rig = Rig::armed(short_warm_up());
    rig.milliseconds(6_000, gusty);
    for step in 0..40u64 {
        rig.now += 10_000;
        let now = at_micros(rig.now);
        let sample = force([(step as i16 % 2) * 8000, 0, -8000], Cause::Threshold);
        let _ = rig.autopilot.on_chip(now, &sample);
        rig.autopilot.on_hyperperiod(now);
    }
    assert!(
        matches!(rig.phase(), Phase::Fallback(_)),
        "{:?}",
        rig.phase()
    );
    assert_eq!(rig.autopilot.faults(Fault::ImuSilent), 1);
}

#[test]
fn without_a_gyroscope_no_torque_is_held() {
    let mut rig = Rig::armed(short_warm_up());
    // A little noise: a sensor that repeats itself is taken for stuck.
    rig.milliseconds(6_000, |now| Some(300 + (now / 1000 % 3) as i16));
    let turning = rig.outputs.last().expect("runs").1;
    assert!(
        turning
            .iter()
            .any(|share| (share - turning[0]).abs() > 0.01)
    );
    rig.milliseconds(500, |_| None);
    let blind = rig.outputs.last().expect("runs").1;
    assert!(
        blind.iter().all(|share| (share - blind[0]).abs() < 1e-6),
        "{blind:?}"
    );
    assert!(blind[0] > 0.3);
}

#[test]
fn a_new_flight_does_not_begin_with_the_thrust_of_the_last() {
    let mut rig = Rig::armed(SETTINGS);
    rig.milliseconds(100, |_| Some(0));
    rig.tell(&Message::Arm(ArmCommand::FORCED_DISARM));
    rig.tell(&Message::Arm(ArmCommand::ARM));
    rig.milliseconds(10, |_| Some(0));
    let shares = rig.outputs.last().expect("runs").1;
    assert!(shares.iter().all(|share| *share < 0.1), "{shares:?}");
}

#[test]
fn a_disarm_stops_the_motors_without_waiting_for_a_sample() {
    let mut rig = Rig::armed(SETTINGS);
    rig.milliseconds(100, |_| Some(0));
    let now = at_micros(rig.now);
    let (next, answer) = rig
        .autopilot
        .on_message(now, &Message::Arm(ArmCommand::FORCED_DISARM));
    assert_eq!((next, answer), (Next::Hyperperiod, Some(Answer::Accepted)));
    let output = rig.autopilot.on_hyperperiod(now).expect("a run");
    assert!(stopped(&output.share()));
}

#[test]
fn a_drone_on_its_side_is_not_armed() {
    let mut rig = Rig::new(SETTINGS);
    let on_its_side = ImuReading {
        force: SpecificForce(Vec3::new(0.0, -GRAVITY, 0.0)),
        ..turning(0)
    };
    for _ in 0..1000 {
        rig.now += 1000;
        let now = at_micros(rig.now);
        let _ = rig.autopilot.on_imu(now, &on_its_side);
        let _ = rig.autopilot.on_hyperperiod(now);
    }
    assert_eq!(
        rig.tell(&Message::Arm(ArmCommand::ARM)),
        Some(Answer::TemporarilyRejected)
    );
}

#[test]
fn a_gyroscope_lost_on_the_ground_is_calibrated_anew_and_from_the_start() {
    let mut rig = Rig::new(SETTINGS);
    rig.milliseconds(1_000, |_| Some(0));
    rig.milliseconds(500, |_| None);
    rig.milliseconds(100, |_| Some(0));
    assert_eq!(
        rig.tell(&Message::Arm(ArmCommand::ARM)),
        Some(Answer::TemporarilyRejected)
    );
    rig.milliseconds(600, |_| Some(0));
    rig.fly_at(0.0);
    assert_eq!(
        rig.tell(&Message::Arm(ArmCommand::ARM)),
        Some(Answer::Accepted)
    );
}

#[test]
fn periodic_control_runs_at_its_period_and_learns_nothing() {
    let mut rig = Rig::armed(Settings {
        policy: Policy::Periodic,
        period: micros(10_000),
        ..SETTINGS
    });
    rig.milliseconds(20, gusty);
    let before = rig.outputs.len();
    rig.milliseconds(5_000, gusty);
    assert_eq!(rig.outputs.len() - before, 500);
    assert_eq!(rig.autopilot.fit(Input::Gyro), Fit::Unfit);
}

#[test]
fn a_silent_peer_leaves_the_drone_level() {
    let mut rig = Rig::armed(SETTINGS);
    rig.milliseconds(3_000, gusty);
    let mut lost = false;
    while let Some(event) = rig.autopilot.next_event() {
        lost |= event == Event::Silent(Silence::Setpoint);
    }
    // The queue is short and full of runs: the setpoint itself shows it too.
    let level = rig.autopilot.graph.setpoint().attitude;
    assert!(lost || level == Some(crate::math::Quaternion::IDENTITY));
}

#[test]
fn the_recorded_calls_give_the_same_commands_bit_for_bit() {
    let mut rig = Rig::armed(short_warm_up());
    rig.milliseconds(8_000, gusty);
    let mut again = Autopilot::with_logic(short_warm_up(), Vec::new(), Cascade::default());
    for stamped in rig.autopilot.recorder().iter() {
        stamped.call.replay(stamped.at, &mut again);
    }
    assert!(rig.autopilot.recorder() == again.recorder());
}

#[test]
fn every_recorded_call_survives_its_bytes() {
    let mut rig = Rig::armed(short_warm_up());
    rig.milliseconds(6_000, gusty);
    for stamped in rig.autopilot.recorder().iter() {
        let mut buffer = [0; LONGEST_RECORD];
        let bytes = stamped.encode(&mut buffer);
        assert_eq!(Stamped::decode(bytes), Ok((*stamped, bytes.len())));
        for end in 0..bytes.len() {
            assert_eq!(Stamped::decode(&bytes[..end]), Err(DecodeError::Incomplete));
        }
    }
}

#[test]
fn what_a_board_knows_of_itself_is_kept_and_survives_its_bytes() {
    let mut rig = Rig::armed(short_warm_up());
    let words = LastWords {
        ending: Ending::Panic,
        mode: Mode::Reactive,
        exception: 79,
        program_counter: 0x0800_0100,
        link_register: 0x0800_0201,
        place: 0x0802_0000,
    };
    for (last_words, brown_out_mv) in [(None, Some(2_830)), (Some(words), None)] {
        let reset = Reset {
            cause: ResetCause::Watchdog,
            last_words,
            brown_out_mv,
        };
        rig.autopilot.on_reset(at_micros(1), &reset);
        assert_eq!(rig.autopilot.reset(), Some(&reset));
    }
    let full = BatteryReading {
        volts: 12.0,
        amps: 8.0,
    };
    let good = rig.autopilot.on_battery(at_micros(2), &full);
    assert_eq!(good, Some(BatteryState::Good));
    let broken = BatteryReading {
        volts: f32::NAN,
        ..full
    };
    assert_eq!(rig.autopilot.on_battery(at_micros(3), &broken), None);
    assert_eq!(rig.autopilot.faults(Fault::NotFinite), 1);
    assert_eq!(rig.autopilot.battery().smoothed(), full);
    let calls = rig.autopilot.recorder().iter().rev();
    let finite = calls.skip(1).take(3);
    for stamped in finite {
        let mut buffer = [0; LONGEST_RECORD];
        let bytes = stamped.encode(&mut buffer);
        assert_eq!(Stamped::decode(bytes), Ok((*stamped, bytes.len())));
    }
}

#[test]
fn every_order_and_every_answer_survives_its_bytes() {
    let actions = [
        ChipAction::DataReady,
        ChipAction::Threshold(0.37),
        ChipAction::Rearm,
        ChipAction::Heartbeat,
        ChipAction::Read,
    ];
    let answers = [
        Ok(ChipSetting::EverySample),
        Ok(ChipSetting::PastThreshold {
            level: 0.32,
            from: f32::NEG_INFINITY,
            next: f32::INFINITY,
        }),
        Err(OrderError::Bus),
        Err(OrderError::Identity),
        Err(OrderError::ReadBack {
            register: 0x32,
            wrote: 9,
            read: 0,
        }),
    ];
    for (input, action) in Input::ALL.into_iter().zip(actions.into_iter().cycle()) {
        for answer in answers {
            let call = Call::OrderDone(ChipOrder { input, action }, answer);
            let at = at_micros(7);
            let stamped = Stamped { at, call };
            let mut buffer = [0; LONGEST_RECORD];
            let bytes = stamped.encode(&mut buffer);
            assert_eq!(Stamped::decode(bytes), Ok((stamped, bytes.len())));
        }
    }
}

#[test]
fn a_setting_serves_the_thresholds_that_are_rounded_down_to_it() {
    let every = ChipSetting::EverySample;
    let past = ChipSetting::PastThreshold {
        level: 0.2,
        from: 0.2,
        next: 0.4,
    };
    assert!(!every.serves(0.0) && !every.is_closed());
    assert!(past.serves(0.2) && past.serves(0.39) && !past.serves(0.4) && !past.serves(0.19));
    assert!(!past.serves(f32::NAN) && !past.is_closed());
}
