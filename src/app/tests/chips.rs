//! Orders to the chips: who is re-armed, who is read, and how often.

use super::*;

/// Orders of the chips within a time, each carried out at once.
fn orders(rig: &mut Rig, milliseconds: u64) -> Vec<ChipOrder> {
    let mut given = Vec::new();
    for _ in 0..milliseconds {
        rig.milliseconds(1, gusty);
        let now = at_micros(rig.now);
        while let Some(order) = rig.autopilot.next_order() {
            given.push(order);
            let field = Vec3::new(0.2, 0.0, 0.4 + rig.now as f32 * 1e-9);
            let cause = match order.action {
                ChipAction::Rearm | ChipAction::Read => Cause::Rearm,
                _ => Cause::Heartbeat,
            };
            let sample = ChipSample {
                input: order.input,
                axes: field,
                cause,
            };
            let _ = rig.autopilot.on_chip(now, &sample);
            let setting = obeyed(order);
            rig.autopilot.on_order_done(now, order, Ok(setting));
        }
    }
    given
}

fn count(orders: &[ChipOrder], input: Input, of: fn(ChipAction) -> bool) -> usize {
    let is = |order: &&ChipOrder| order.input == input && of(order.action);
    orders.iter().filter(is).count()
}

/// A rig whose accelerometer chip has a model with this threshold, and whose chips obey.
fn with_threshold(change: f32) -> Rig {
    let mut rig = Rig::armed(short_warm_up());
    orders(&mut rig, 5_000);
    assert_eq!(rig.phase(), Phase::Reactive);
    let b1 = SETTINGS.p_run.ln() - (1.0 - SETTINGS.p_run).ln() - 10.0 * change;
    let fit = Fit::Model(crate::reactive::Logistic { b1, b2: 10.0 });
    let refit = Refit {
        input: Input::ChipAccel,
        fit,
    };
    rig.autopilot.on_refit(at_micros(rig.now), refit);
    orders(&mut rig, 150);
    rig
}

#[test]
fn orders_end_though_their_stamps_go_back() {
    let mut rig = with_threshold(0.5);
    rig.milliseconds(300, gusty);
    let before = at_micros(rig.now - 3_000_000);
    let mut given = 0;
    while let Some(order) = rig.autopilot.next_order() {
        rig.autopilot
            .on_order_done(before, order, Ok(obeyed(order)));
        given += 1;
        assert!(given < 10, "{order:?} again");
    }
    assert!(given > 0, "heartbeats were due");
}

#[test]
fn a_closed_chip_is_not_rearmed_and_read_only_before_its_heartbeat() {
    let mut rig = Rig::armed(short_warm_up());
    orders(&mut rig, 5_000);
    let given = orders(&mut rig, 2_000);
    let rearm = |action| action == ChipAction::Rearm;
    assert_eq!(count(&given, Input::ChipAccel, rearm), 0);
    let read = |action| action == ChipAction::Read;
    let reads = count(&given, Input::ChipAccel, read);
    assert!((10..=20).contains(&reads), "{reads} in two seconds");
}

#[test]
fn an_open_chip_is_rearmed_at_runs_and_no_more_often_than_it_samples() {
    let mut rig = with_threshold(1.0);
    let runs = rig.outputs.len();
    let given = orders(&mut rig, 200);
    let runs = rig.outputs.len() - runs;
    let rearms = count(&given, Input::ChipAccel, |action| {
        action == ChipAction::Rearm
    });
    assert!(
        (1..=20.min(runs)).contains(&rearms),
        "{rearms} at {runs} runs"
    );
}

#[test]
fn a_threshold_finer_than_a_code_holds_the_finest_and_not_data_ready() {
    let mut rig = with_threshold(0.001);
    let given = orders(&mut rig, 10);
    let every = |action| action == ChipAction::DataReady;
    assert_eq!(count(&given, Input::ChipAccel, every), 0);
    let told = rig.autopilot.recorder().iter().rev().find_map(|stamped| {
        let Call::OrderDone(order, Ok(setting)) = stamped.call else {
            return None;
        };
        let programs = matches!(order.action, ChipAction::Threshold(_));
        (order.input == Input::ChipAccel && programs).then_some(setting)
    });
    assert!(
        told.is_some_and(|setting| setting.serves(0.001)),
        "{told:?}"
    );
}

#[test]
fn periodic_control_reads_the_magnetometer_for_the_estimator_and_the_other_chip_not_at_all() {
    let mut rig = Rig::armed(Settings {
        policy: Policy::Periodic,
        period: micros(2_500),
        ..SETTINGS
    });
    orders(&mut rig, 500);
    let given = orders(&mut rig, 1_000);
    let reads = count(&given, Input::ChipMag, |action| action == ChipAction::Read);
    assert!((40..=50).contains(&reads), "{reads} in a second");
    let others = |action| !matches!(action, ChipAction::Read | ChipAction::Heartbeat);
    assert_eq!(count(&given, Input::ChipMag, others), 0);
    let but_heartbeats = |action| action != ChipAction::Heartbeat;
    assert_eq!(count(&given, Input::ChipAccel, but_heartbeats), 0);
}

/// The chip sees the drone moved, so long after now: the run that this alone led to, and how long
/// after that. No sample of the inertial sensor comes between.
fn run_of_a_crossing(rig: &mut Rig, after_us: u64) -> (Ran, u64) {
    let at = at_micros(rig.now + after_us);
    let moved = force([8_000, 0, -8192], Cause::Threshold);
    let Next::HyperperiodAt(due) = rig.autopilot.on_chip(at, &moved) else {
        panic!("a crossing asks for a run");
    };
    let due = due.max(at);
    let output = rig.autopilot.on_hyperperiod(due);
    assert!(output.is_some(), "control runs");
    let last = rig.autopilot.recorder().last().expect("a call").call;
    let Call::Ran(ran) = last else {
        panic!("{last:?}");
    };
    (ran, span(at, due).ticks())
}

/// A steady drone, seen by a noisy sensor.
fn steady(now: u64) -> Option<i16> {
    Some((now / 1000 % 3) as i16)
}

fn check_that_a_crossing_runs_control(mut rig: Rig, after_us: u64) {
    let (ran, waited_us) = run_of_a_crossing(&mut rig, after_us);
    let asked = Inputs::NONE.with(Input::ChipAccel);
    assert_eq!((ran.reason, ran.asked), (Reason::Trigger, asked));
    let bound = (HYPERPERIOD * 3 / 2).ticks();
    assert!(waited_us <= bound, "{waited_us} us");
}

#[test]
fn with_an_inertial_sensor_at_a_tenth_of_its_rate_a_crossing_calls_control() {
    for after_us in [100, 1_000, 4_000, 9_000] {
        let mut rig = with_threshold(1.0);
        rig.milliseconds(100, |now| steady(now).filter(|_| now % 10_000 == 0));
        check_that_a_crossing_runs_control(rig, after_us);
    }
}

#[test]
fn with_an_inertial_sensor_that_repeats_its_sample_a_crossing_calls_control() {
    let mut rig = with_threshold(1.0);
    rig.milliseconds(50, |_| Some(1));
    check_that_a_crossing_runs_control(rig, 300);
}

#[test]
fn with_an_inertial_sensor_that_delivers_late_a_crossing_calls_control_and_the_sample_counts() {
    let mut rig = with_threshold(1.0);
    rig.milliseconds(50, steady);
    let stamped = at_micros(rig.now + 1_000);
    let (ran, waited_us) = run_of_a_crossing(&mut rig, 8_000);
    assert_eq!((ran.asked.sole(), waited_us), (Some(Input::ChipAccel), 0));
    let next = rig.autopilot.on_imu(stamped, &alive(2, 0));
    assert_eq!(rig.autopilot.faults(Fault::ImuJump), 0);
    assert_eq!(next, Next::Wait, "it asks for nothing");
}
