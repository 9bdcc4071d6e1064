//! Sensors that fail by axis, rate or impossible motion, and come back.

use super::*;
use crate::math::Quaternion;
use crate::reactive::FallbackReason;
use crate::safety::Check;
use crate::sensors::ImuReading;

/// Does something to a sample.
type Spoil = fn(u64, &mut ImuReading);

const BLIND: Phase = Phase::Fallback(FallbackReason::ImuLost);

impl<L: ControlLogic> Rig<L> {
    /// Lets time pass with samples that something was done to; how long until control is blind.
    fn spoilt(&mut self, milliseconds: u64, spoil: impl Fn(u64, &mut ImuReading)) -> Option<u64> {
        let mut blind = None;
        for ms in 0..milliseconds {
            self.now += 1000;
            let now = at_micros(self.now);
            let mut reading = alive(gusty(self.now).unwrap_or(0), self.now);
            spoil(self.now, &mut reading);
            if self.autopilot.on_imu(now, &reading) == Next::Hyperperiod
                && let Some(output) = self.autopilot.on_hyperperiod(now)
            {
                self.outputs.push((self.now, output.share()));
            }
            if self.phase() == BLIND {
                blind.get_or_insert(ms);
            }
        }
        blind
    }

    fn apart(&self) -> f32 {
        let shares = self.outputs.last().expect("runs").1;
        let most = shares.iter().copied().fold(0.0, f32::max);
        most - shares.iter().copied().fold(1.0, f32::min)
    }
}

fn flying(policy: Policy) -> Rig {
    let mut rig = Rig::armed(Settings { policy, ..SETTINGS });
    rig.milliseconds(2_000, gusty);
    rig
}

#[test]
fn a_gyroscope_that_is_frozen_in_one_axis_or_all_is_lost_within_a_failsafe_under_every_policy() {
    let freezes: [Spoil; 4] = [
        |_, reading| reading.rates.0.x = 0.3,
        |_, reading| reading.rates.0.y = 0.0,
        |_, reading| reading.rates.0.z = -0.1,
        |_, reading| reading.rates.0 = Vec3::new(0.1, 0.2, 0.3),
    ];
    for policy in [Policy::Reactive, Policy::Periodic] {
        for freeze in freezes {
            let mut rig = flying(policy);
            let blind = rig.spoilt(150, freeze).expect("noticed");
            assert!(blind <= 100, "{policy:?} {blind}");
            assert_eq!(rig.autopilot.faults(Fault::GyroFrozen), 1);
            assert!(rig.apart() < 1e-6, "no torque");
            rig.milliseconds(20, gusty);
            assert_ne!(rig.phase(), BLIND, "forgiven when it moves");
        }
    }
}

#[test]
fn an_accelerometer_that_fails_is_told_and_flown_without() {
    let failures: [(Fault, Spoil); 2] = [
        (Fault::AccelFrozen, |_, reading| {
            reading.force.0 = Vec3::new(3.0, 0.0, -9.0)
        }),
        (Fault::AccelJumping, |now, reading| {
            reading.force.0.x = breath(now, 9) * 75.0;
        }),
    ];
    for (fault, fail) in failures {
        let mut rig = flying(Policy::Reactive);
        let before = rig.autopilot.telemetry().attitude;
        let blind = rig.spoilt(3_000, |now, reading| {
            reading.rates.0.x = breath(now, 0) * 1e-3;
            fail(now, reading);
        });
        assert_eq!(blind, None);
        assert_eq!(rig.autopilot.faults(fault), 1, "{fault:?}");
        let after = rig.autopilot.telemetry().attitude;
        assert!(before.down_in_body().cross(after.down_in_body()).norm() < 0.2);
    }
}

#[test]
fn bursts_of_full_scale_samples_are_dropped_and_counted() {
    let mut rig = flying(Policy::Reactive);
    let tilt = |rig: &Rig| rig.autopilot.telemetry().attitude.down_in_body();
    let before = tilt(&rig);
    for length in [1, 5, 20, 40] {
        let blind = rig.spoilt(3_000, |now, reading| {
            if now / 1000 % 500 < length {
                reading.rates.0 = Vec3::new(34.9, -34.9, 34.9);
                reading.force.0 = Vec3::new(-157.0, 157.0, 157.0);
            }
        });
        assert_eq!(blind, None, "{length}");
    }
    let mut plain = flying(Policy::Reactive);
    plain.spoilt(12_000, |_, _| ());
    let off = tilt(&rig).cross(tilt(&plain)).norm().to_degrees();
    assert!(off < 5.0, "{off} degrees from {before:?}");
    assert!(rig.autopilot.faults(Fault::ImuSpike) >= 24);
}

#[test]
fn garbage_and_a_rail_that_no_motion_reaches_are_lost_within_a_failsafe() {
    let spoils: [Spoil; 2] = [
        |now, reading| reading.rates.0.y = breath(now, 7) * 17.0,
        |_, reading| reading.rates.0 = Vec3::new(34.9, 34.9, 34.9),
    ];
    for spoil in spoils {
        let mut rig = flying(Policy::Periodic);
        let blind = rig.spoilt(200, spoil).expect("noticed");
        assert!(blind <= 100, "{blind}");
    }
}

#[test]
fn five_samples_a_second_are_no_flow_and_silence_is_noticed_within_a_failsafe() {
    for policy in [Policy::Reactive, Policy::Periodic] {
        let mut rig = flying(policy);
        let from = rig.now;
        rig.milliseconds(101, |_| None);
        assert_eq!(rig.phase(), BLIND, "{policy:?}");
        rig.milliseconds(400, |now| {
            ((now - from).is_multiple_of(200_000)).then_some(3)
        });
        assert_eq!(rig.phase(), BLIND, "{policy:?}");
        rig.milliseconds(12, gusty);
        assert_ne!(rig.phase(), BLIND, "{policy:?}");
    }
    let mut rig = flying(Policy::Reactive);
    rig.milliseconds(500, |now| {
        (now.is_multiple_of(10_000)).then_some((now / 10_000 % 5) as i16)
    });
    assert_eq!(
        (rig.phase(), rig.autopilot.faults(Fault::ImuStarved)),
        (BLIND, 1)
    );
}

#[test]
fn behind_a_gap_the_attitude_is_where_even_turning_leads() {
    // Longer, and the motors are cut.
    for gap in [50, 200, 400] {
        let mut rig = flying(Policy::Reactive);
        let turning = |now: u64| Some(600 + breath(now, 0) as i16);
        rig.milliseconds(100, turning);
        let before = rig.autopilot.telemetry().attitude;
        rig.milliseconds(gap, |_| None);
        rig.milliseconds(10, turning);
        let turned = before.error_to(rig.autopilot.telemetry().attitude);
        let rate = (600.0f32 / 16.4).to_radians();
        let expected = Quaternion::IDENTITY.error_to(crate::estimate::in_small_turns(
            Quaternion::IDENTITY,
            Vec3::new(rate * gap as f32 * 1e-3, 0.0, 0.0),
        ));
        assert!(
            (turned.x - expected.x).abs() < 0.05,
            "{gap} {turned:?} {expected:?}"
        );
    }
}

#[test]
fn behind_a_gap_the_field_shows_how_far_the_body_tipped() {
    let mut rig = flying(Policy::Reactive);
    let earth = Vec3::new(0.2, 0.0, 0.4);
    let see = |rig: &mut Rig, body: Quaternion| {
        let sample = ChipSample {
            input: Input::ChipMag,
            axes: body.to_body(earth),
            cause: Cause::Heartbeat,
        };
        let _ = rig.autopilot.on_chip(at_micros(rig.now), &sample);
    };
    let before = rig.autopilot.telemetry().attitude;
    for _ in 0..5 {
        rig.milliseconds(20, resting);
        let here = rig.autopilot.telemetry().attitude;
        see(&mut rig, here);
    }
    let tipped = before.turned_by(Vec3::new(0.2, -0.4, 0.0));
    for _ in 0..4 {
        rig.milliseconds(100, |_| None);
        see(&mut rig, tipped);
    }
    rig.milliseconds(10, resting);
    see(&mut rig, tipped);
    rig.milliseconds(1, resting);
    let [seen, is] = [rig.autopilot.telemetry().attitude, tipped].map(Quaternion::down_in_body);
    let off = seen.cross(is).norm().to_degrees();
    assert!(off < 8.0, "{off} of 26 degrees");
}

#[test]
fn a_graph_that_goes_astray_begins_anew_and_nothing_freezes() {
    let mut rig = flying(Policy::Reactive);
    for round in 1..=3 {
        let nowhere = Quaternion::IDENTITY.turned_by(Vec3::new(f32::NAN, 0.0, 0.0));
        rig.autopilot.logic().align(nowhere);
        rig.milliseconds(200, gusty);
        assert_eq!(rig.autopilot.faults(Fault::Command), round);
        assert!(rig.autopilot.telemetry().attitude.is_finite());
    }
    let held = rig.outputs.last().expect("runs").1;
    rig.milliseconds(60, gusty);
    assert!(
        rig.outputs
            .iter()
            .rev()
            .take(60)
            .any(|(_, shares)| *shares != held)
    );
}

#[test]
fn a_logic_that_stays_astray_counts_its_runs_in_a_row() {
    let mut gains = crate::config::cascade::GAINS;
    gains.rate.p[0] = f32::NAN;
    let logic = Cascade::new(gains, crate::airframe::Mixer::default());
    let mut rig = Rig::with_logic(SETTINGS, logic);
    rig.milliseconds(700, resting);
    assert!(rig.autopilot.faults(Fault::Command) > 100);
}

#[test]
fn a_gyroscope_that_drifts_before_arming_is_learned_and_the_level_agrees_again() {
    let mut rig = Rig::new(SETTINGS);
    rig.milliseconds(700, resting);
    let drift = (15.0 * 16.4) as i16;
    rig.milliseconds(480, |now| Some(drift + breath(now, 0) as i16));
    assert!(rig.autopilot.health().level_disagrees);
    rig.fly_at(0.0);
    let arm = Message::Arm(ArmCommand::ARM);
    assert_eq!(rig.tell(&arm), Some(Answer::TemporarilyRejected));
    let told = rig.told_pilot();
    assert!(
        told.iter().any(|line| line.contains(Check::Level.text())),
        "{told:?}"
    );
    rig.milliseconds(1_200, |now| Some(drift + breath(now, 0) as i16));
    assert!(!rig.autopilot.health().level_disagrees);
    rig.fly_at(0.0);
    assert_eq!(rig.tell(&arm), Some(Answer::Accepted));
    let level = rig.autopilot.telemetry().attitude.down_in_body();
    assert!(level.z > 0.999);
}

#[test]
fn a_field_that_turns_leaves_the_heading_free() {
    for (angle, times) in [(1.0f32, 1.0), (1.0, 5.0)] {
        let mut rig = flying(Policy::Reactive);
        let field = |rig: &mut Rig, seconds: u64, angle: f32, times: f32| {
            for step in 0..seconds * 50 {
                rig.milliseconds(20, resting);
                let noise = breath(step * 1000, 8) * 0.002;
                let earth = Vec3::new(0.2 * angle.cos(), 0.2 * angle.sin(), 0.4 + noise) * times;
                let sample = ChipSample {
                    input: Input::ChipMag,
                    axes: rig.autopilot.telemetry().attitude.to_body(earth),
                    cause: Cause::Heartbeat,
                };
                let _ = rig.autopilot.on_chip(at_micros(rig.now), &sample);
            }
            rig.autopilot.telemetry().attitude.heading()
        };
        let before = field(&mut rig, 2, 0.0, 1.0);
        let after = field(&mut rig, 15, angle, times);
        assert!((after - before).abs() < 0.1, "{before} {after}");
        assert_eq!(rig.autopilot.faults(Fault::FieldBent), 1);
        assert!(rig.autopilot.health().heading_free);
    }
}
