//! Every pair of phase and event, and how long each phase lasts.

use super::*;
use crate::time::{at_micros, micros};
use FallbackReason::{Aerobatics, FalsePositives, ImuLost};

fn phases() -> impl Iterator<Item = Phase> {
    let plain = [
        Phase::Ground,
        Phase::WarmUp,
        Phase::Reactive,
        Phase::Periodic,
    ];
    let fallbacks = FallbackReason::ALL.into_iter().map(Phase::Fallback);
    plain.into_iter().chain(fallbacks)
}

fn short(phase: Phase) -> String {
    match phase {
        Phase::Ground => "ground".into(),
        Phase::WarmUp => "warm-up".into(),
        Phase::Reactive => "reactive".into(),
        Phase::Periodic => "periodic".into(),
        Phase::Fallback(reason) => format!("{reason:?}"),
    }
}

/// Where each phase leads; `.` is nowhere else, and `warm-up` is `periodic` by that policy. The column of `Fallback` stands for every reason
/// but `ImuLost`.
const TABLE: &str = "
event          | Ground  | WarmUp   | Reactive       | Fallback | ImuLost | Periodic
Armed          | warm-up | .        | .              | .        | .       | .
Disarmed       | .       | ground   | ground         | ground   | ground  | ground
Learned        | .       | reactive | .              | reactive | .       | .
TimedOut       | .       | Unfit    | .              | .        | .       | .
ImuBack        | .       | .        | .              | .        | warm-up | .
Unfit          | .       | .        | Unfit          | .        | .       | .
FalsePositives | .       | .        | FalsePositives | .        | .       | .
Missed         | .       | .        | Missed         | .        | .       | .
Aerobatics     | .       | .        | Aerobatics     | .        | .       | .
Overrun        | .       | .        | Overrun        | .        | .       | .
SensorLost     | .       | .        | SensorLost     | .        | .       | .
ImuLost        | .       | ImuLost  | ImuLost        | ImuLost  | .       | ImuLost
";

fn event(name: &str) -> PhaseEvent {
    match name {
        "Armed" => PhaseEvent::Armed,
        "Disarmed" => PhaseEvent::Disarmed,
        "Learned" => PhaseEvent::Learned,
        "TimedOut" => PhaseEvent::TimedOut,
        "ImuBack" => PhaseEvent::ImuBack,
        reason => PhaseEvent::Fail(
            FallbackReason::ALL
                .into_iter()
                .find(|known| format!("{known:?}") == reason)
                .expect(reason),
        ),
    }
}

#[test]
fn every_pair_of_phase_and_event_leads_where_the_table_says() {
    let mut rows = TABLE.trim().lines();
    assert!(
        rows.next()
            .is_some_and(|header| header.starts_with("event"))
    );
    let mut seen = 0;
    for row in rows {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        for phase in phases() {
            let column = match phase {
                Phase::Ground => 1,
                Phase::WarmUp => 2,
                Phase::Reactive => 3,
                Phase::Fallback(ImuLost) => 5,
                Phase::Fallback(_) => 4,
                Phase::Periodic => 6,
            };
            for policy in [Policy::Reactive, Policy::Periodic] {
                let expected = match (cells[column], policy) {
                    (".", _) => short(phase),
                    ("warm-up", Policy::Periodic) => "periodic".to_owned(),
                    (other, _) => other.to_owned(),
                };
                let after = phase.after(event(cells[0]), policy);
                let case = format!("{phase:?} after {}, {policy:?}", cells[0]);
                assert_eq!(short(after), expected, "{case}");
                seen += 1;
            }
        }
    }
    assert_eq!(seen, 12 * 11 * 2);
}

fn learning(warm_up: WarmUp) -> Supervisor {
    let mut supervisor = Supervisor::new(Policy::Reactive, warm_up);
    supervisor.on(PhaseEvent::Armed, at_micros(0));
    supervisor
}

#[test]
fn warm_up_lasts_from_its_shortest_to_its_longest() {
    let supervisor = learning(WarmUp::Automatic);
    let just_before = at_micros(SHORTEST_WARM_UP.ticks() - 1);
    assert_eq!(supervisor.judge(true, true, just_before), None);
    let after = at_micros(SHORTEST_WARM_UP.ticks());
    assert_eq!(
        supervisor.judge(true, true, after),
        Some(PhaseEvent::Learned)
    );
    assert_eq!(supervisor.judge(false, true, after), None);
    let longest = at_micros(LONGEST_WARM_UP.ticks());
    assert_eq!(
        supervisor.judge(false, true, longest),
        Some(PhaseEvent::Learned)
    );
    assert_eq!(
        supervisor.judge(false, false, longest),
        Some(PhaseEvent::TimedOut)
    );
}

#[test]
fn a_fixed_warm_up_ends_when_it_says() {
    let supervisor = learning(WarmUp::Fixed(micros(5_000_000)));
    assert_eq!(supervisor.judge(true, true, at_micros(4_999_999)), None);
    let event = supervisor.judge(false, true, at_micros(5_000_000));
    assert_eq!(event, Some(PhaseEvent::Learned));
}

#[test]
fn a_fallback_for_want_of_a_model_ends_when_there_is_one_however_late() {
    for warm_up in [WarmUp::Automatic, WarmUp::Fixed(micros(1_000_000))] {
        let mut supervisor = learning(warm_up);
        supervisor.on(PhaseEvent::TimedOut, at_micros(0));
        let late = at_micros(LONGEST_WARM_UP.ticks() * 10);
        assert_eq!(supervisor.judge(false, false, late), None);
        let event = supervisor.judge(false, true, late);
        assert_eq!(event, Some(PhaseEvent::Learned));
    }
}

/// Goes to reactive control and back, over and over; how long each fallback lasted, in s.
fn fallbacks(every_s: u64, count: usize) -> Vec<u64> {
    let mut supervisor = learning(WarmUp::Automatic);
    let mut now = 5;
    supervisor.on(PhaseEvent::Learned, at_micros(now * 1_000_000));
    let mut lengths = Vec::new();
    for _ in 0..count {
        now += every_s;
        let fail = PhaseEvent::Fail(FalsePositives);
        supervisor.on(fail, at_micros(now * 1_000_000));
        let began = now;
        while supervisor
            .judge(true, true, at_micros(now * 1_000_000))
            .is_none()
        {
            now += 1;
        }
        lengths.push(now - began);
        supervisor.on(PhaseEvent::Learned, at_micros(now * 1_000_000));
    }
    lengths
}

#[test]
fn fallbacks_that_follow_each_other_last_ever_longer() {
    assert_eq!(fallbacks(10, 6), [6, 12, 24, 48, 60, 60]);
    assert_eq!(fallbacks(100, 3), [3, 3, 3]);
}

#[test]
fn what_goes_on_failing_keeps_the_way_back_closed() {
    let mut supervisor = learning(WarmUp::Automatic);
    supervisor.on(PhaseEvent::Learned, at_micros(100_000_000));
    supervisor.on(PhaseEvent::Fail(Aerobatics), at_micros(200_000_000));
    supervisor.on(PhaseEvent::Fail(Aerobatics), at_micros(210_000_000));
    assert_eq!(supervisor.judge(true, true, at_micros(212_000_000)), None);
    let event = supervisor.judge(true, true, at_micros(213_000_000));
    assert_eq!(event, Some(PhaseEvent::Learned));
}

#[test]
fn only_reasons_that_refute_the_models_begin_from_scratch() {
    let from_scratch = FallbackReason::ALL.map(FallbackReason::refutes_models);
    assert_eq!(
        from_scratch,
        [false, true, true, false, false, false, false]
    );
}
