//! Control, decisions, calibration, actuators of a flight or a window.

use super::deviation::{Deviation, Tally, rate, share};
use super::flight_steps::{FlightSteps, Step};
use super::judge::{Class, Judged};
use super::reason::ByReason;
use super::rules::Rules;
use schemars::JsonSchema;
use serde::Serialize;

/// How often control ran, and why.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Control {
    /// Runs of every reason: the sum of `by_reason`.
    pub runs: u64,
    /// Runs per second, those by exploration left out; null over no time.
    pub rate_hz: Option<f64>,
    /// Runs of each reason.
    pub by_reason: ByReason<u64>,
}

/// How the decisions of the hyperperiods turned out; all six kinds add up to them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Decisions {
    /// A trigger asked for a run and the command had changed.
    pub true_positive: u64,
    /// A trigger asked for a run and the command had not changed.
    pub false_positive: u64,
    /// No trigger asked though the command had changed: once until the next run.
    pub false_negative: u64,
    /// No trigger asked and the command had not changed.
    pub true_negative: u64,
    /// Further hyperperiods, before the next run, in which a missed change was open.
    pub still_missed: u64,
    /// Hyperperiods whose run was time-triggered, or by exploration or for a setpoint alone.
    pub outside: u64,
    /// Failsafe runs that changed the command though every model had said no.
    pub failsafe_changed: u64,
}

/// What the motors held against the reference.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Actuators {
    /// How far the held commands strayed.
    #[serde(flatten)]
    pub deviation: Deviation,
    /// `stale_fraction` with the reference's commands at the policy's runs; null without any.
    pub stale_from_trigger: Option<f64>,
    /// Share of hyperperiods that were stale only because the control state had diverged.
    pub stale_from_state: Option<f64>,
    /// `rms_deviation_quanta` with the reference's commands at the policy's runs; null without any.
    pub rms_from_trigger_quanta: Option<f64>,
    /// `rms_felt_quanta` with the reference's commands at the policy's runs; null without any.
    pub rms_felt_from_trigger_quanta: Option<f64>,
    /// Share of hyperperiods in which some reference command sat at a limit.
    pub saturated_fraction: Option<f64>,
}

/// What the models expected of the runs that they asked for, and how many of those were changed.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Calibration {
    /// Runs that a model asked for.
    pub triggers: u64,
    /// Mean probability of a changed command by the models; null without such a run.
    pub expected_share: Option<f64>,
    /// Share of them that were changed: that repaid a quantum for 10 ms, or moved the command by one
    /// where the impulse owed does not trigger.
    pub changed_share: Option<f64>,
}

/// All of them over one stretch of a flight.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Section {
    /// How often control ran, and why.
    pub control: Control,
    /// How the decisions turned out.
    pub decisions: Decisions,
    /// Whether the models were right.
    pub calibration: Calibration,
    /// What the motors held.
    pub actuators: Actuators,
}

/// One window of the flight, as long as the others or, the last, shorter.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Window {
    /// Start in seconds of the flight.
    pub start_s: f64,
    /// Length in seconds.
    pub length_s: f64,
    /// Hyperperiods that ended within it.
    pub hyperperiods: u64,
    /// Its numbers.
    #[serde(flatten)]
    pub section: Section,
}

/// Length of a window in microseconds.
pub const WINDOW_US: u64 = 10_000_000;

impl Section {
    /// The numbers of consecutive hyperperiods that took `length_s` seconds.
    pub(super) fn of(steps: &[Step], judged: &[Judged], length_s: f64, rules: &Rules) -> Self {
        Self {
            control: Control::of(steps, length_s),
            decisions: Decisions::of(judged),
            calibration: Calibration::of(judged),
            actuators: Actuators::of(judged, rules),
        }
    }
}

impl Control {
    fn of(steps: &[Step], length_s: f64) -> Self {
        let mut by_reason = ByReason::<u64>::default();
        for run in steps.iter().flat_map(Step::runs) {
            *by_reason.get_mut(run.reason) += 1;
        }
        let runs = by_reason.total();
        Self {
            runs,
            rate_hz: rate(runs - by_reason.exploration, length_s),
            by_reason,
        }
    }
}

impl Decisions {
    fn of(judged: &[Judged]) -> Self {
        let mut sum = Self::default();
        for one in judged {
            *match one.class {
                Class::TruePositive => &mut sum.true_positive,
                Class::FalsePositive => &mut sum.false_positive,
                Class::FalseNegative => &mut sum.false_negative,
                Class::TrueNegative => &mut sum.true_negative,
                Class::StillMissed => &mut sum.still_missed,
                Class::Outside => &mut sum.outside,
            } += 1;
            sum.failsafe_changed += one.failsafe_changed;
        }
        sum
    }
}

impl Calibration {
    fn of(judged: &[Judged]) -> Self {
        let predictions = judged.iter().filter_map(|one| one.prediction);
        let (mut triggers, mut changed, mut expected) = (0, 0, 0.0);
        for (probability, differed) in predictions {
            triggers += 1;
            changed += u64::from(differed);
            expected += f64::from(probability);
        }
        Self {
            triggers,
            expected_share: (triggers > 0).then(|| expected / triggers as f64),
            changed_share: share(changed, triggers),
        }
    }
}

impl Actuators {
    fn of(judged: &[Judged], rules: &Rules) -> Self {
        let (mut own, mut trigger) = (Tally::default(), Tally::default());
        for one in judged {
            own.add(&one.own);
            trigger.add(&one.from_trigger);
        }
        let trigger = trigger.deviation(rules.quantum);
        let share_of = |is: fn(&Judged) -> bool| {
            let count = judged.iter().filter(|one| is(one)).count();
            share(count as u64, judged.len() as u64)
        };
        Self {
            deviation: own.deviation(rules.quantum),
            stale_from_trigger: trigger.stale_fraction,
            stale_from_state: share_of(|one| one.own.stale && !one.from_trigger.stale),
            rms_from_trigger_quanta: trigger.rms_deviation_quanta,
            rms_felt_from_trigger_quanta: trigger.rms_felt_quanta,
            saturated_fraction: share_of(|one| one.saturated),
        }
    }
}

/// Cuts the hyperperiods after warm-up into windows that start at the warm-up's end.
///
/// A hyperperiod belongs to the window in which it ended. A window that a gap in the flight
/// left without any is there too, with nulls, so that the windows' times stay evenly spaced.
pub(super) fn windows(flight: &FlightSteps, judged: &[Judged], rules: &Rules) -> Vec<Window> {
    let scored = flight.scored();
    let (mut steps, mut judged) = (scored.steps, judged.get(scored.first..).unwrap_or_default());
    let mut start_us = scored.start_us;
    let mut windows = Vec::new();
    while !steps.is_empty() {
        let full_us = start_us.saturating_add(WINDOW_US);
        let count = steps.partition_point(|step| step.at_us <= full_us);
        let (own_steps, later_steps) = steps.split_at(count);
        let (own_judged, later_judged) = judged.split_at(count);
        let end_us = full_us.min(flight.last_us());
        let length_s = scored.seconds(start_us, end_us);
        windows.push(Window {
            start_s: flight.seconds(start_us),
            length_s,
            hyperperiods: count as u64,
            section: Section::of(own_steps, own_judged, length_s, rules),
        });
        (steps, judged, start_us) = (later_steps, later_judged, full_us);
    }
    windows
}
