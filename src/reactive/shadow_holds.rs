//! Shadow holds: what reactive control would have met, learned in advance.
//!
//! A command that is held ages, and the change that has then piled up is not the change from
//! one sample to the next. So the warm-up pretends: for each of some candidate thresholds it
//! holds a command and the sample behind it, waits until the change first crosses the
//! candidate (or the failsafe would have come), labels that crossing, and holds anew. Where
//! the leading input would have asked for a run first, there is nothing left to learn of the
//! others: the hold is *overtaken*, as runs that several inputs ask for teach nothing.
//!
//! Where impulses count, a label is known only when the new command had its time to repay; the hold
//! waits for that.
//!
//! Where no change crosses any candidate, a hold may end after a number of samples instead.

use super::owed::{Course, OfAxes};
use super::{Label, Labels, Sample};
use crate::airframe::MotorShares;
use crate::config::{Changes, HYPERPERIOD};
use crate::math::Vec3;
use crate::settings::{Pairs, Reference};
use crate::time::{Duration, Instant, span};

/// Number of candidate thresholds, and of lags; and from one lag to the next, in hyperperiods: from 1 to 90.
///
/// They take most of the autopilot's memory: a reduced build learns from fewer.
const CANDIDATES: usize = if cfg!(feature = "reduced") { 4 } else { 12 };
const LAG_STEP: f32 = if cfg!(feature = "reduced") {
    4.481
} else {
    1.506
};

/// A command in force and the sample behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held<S = Vec3> {
    /// The input's sample that the command was computed from.
    pub sample: S,
    /// The command.
    pub command: Commanded,
    /// The gyroscope's rates behind it, in rad/s: they lead where no command is foreseen.
    pub rates: Vec3,
}

/// A command, as it counts for the leading input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Commanded {
    /// At one instant: it is changed when some motor's moved by a quantum or more.
    Now(MotorShares),
    /// Over time: it is changed when the new one repays what it is worth.
    Over(Course),
}

/// The input that is asked first, and the change past which it calls for a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lead {
    /// The command itself, past this share of full scale, or the impulse owed, past this one.
    Command(f32),
    /// The gyroscope, past this rate in rad/s.
    Gyro(f32),
    /// Nobody: the labels are the leading input's own.
    Itself,
}

/// The shadow holds of one input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowHolds<S = Vec3> {
    holds: [Hold<S>; CANDIDATES],
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Hold<S> {
    /// The change that ends it.
    threshold: f32,
    /// The samples that end it.
    lag: u16,
    state: State<S>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State<S> {
    /// Nothing is held.
    Idle,
    /// Held since then.
    Holding(Instant, Held<S>),
    /// It ended in a change of this size; whether the new command repays is yet to be seen.
    Ended {
        x: f32,
        run: Course,
        replaced: OfAxes,
    },
}

/// How a hold ended.
enum End {
    Label(Label),
    /// The leading input asked first.
    Overtaken,
}

/// What labels depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// What a change is measured against.
    pub reference: Reference,
    /// When a hold ends.
    pub pairs: Pairs,
    /// The change of a command that counts: a share of full scale, or an impulse.
    pub counts: f32,
    /// The longest hold.
    pub failsafe: Duration,
}

impl<S: Sample> ShadowHolds<S> {
    /// Candidates spread evenly in the logarithm over the input's changes.
    #[must_use]
    pub fn new(changes: &Changes) -> Self {
        let ratio = changes.largest / changes.smallest;
        let step = libm::powf(ratio, 1.0 / (CANDIDATES as f32 + 1.0));
        let mut threshold = changes.smallest;
        let mut lag = 1.0;
        let mut holds = [Hold {
            threshold,
            lag: 1,
            state: State::Idle,
        }; CANDIDATES];
        for hold in &mut holds {
            threshold *= step;
            hold.threshold = threshold;
            hold.lag = lag as u16;
            lag *= LAG_STEP;
        }
        Self { holds }
    }

    /// Forgets what is held: the next sample starts all holds.
    pub fn restart(&mut self) {
        for hold in &mut self.holds {
            hold.state = State::Idle;
        }
    }

    /// Takes the newest sample and command; adds and tells a label for every hold that ends.
    pub fn take(
        &mut self,
        now: Instant,
        newest: &Held<S>,
        rule: &Rule,
        lead: &Lead,
        labels: &mut Labels,
        mut tell: impl FnMut(&Label),
    ) {
        let holds = match rule.pairs {
            Pairs::Published => 1,
            Pairs::FirstCrossings | Pairs::WeightedLags => CANDIDATES,
        };
        for hold in self.holds.iter_mut().take(holds) {
            match hold.take(now, newest, rule, lead) {
                Some(End::Label(label)) => {
                    labels.add(&label);
                    tell(&label);
                }
                Some(End::Overtaken) => labels.add_overtaken(),
                None => {}
            }
        }
    }
}

impl<S: Sample> Hold<S> {
    fn take(&mut self, now: Instant, newest: &Held<S>, rule: &Rule, lead: &Lead) -> Option<End> {
        let anew = State::Holding(now, *newest);
        let (since, held) = match &mut self.state {
            State::Idle => {
                self.state = anew;
                return None;
            }
            State::Ended { x, run, replaced } => {
                let repaid = newest.command.course()?.repaid(run, *replaced)?;
                let label = Label {
                    x: *x,
                    changed: repaid >= rule.counts,
                    weight: 1.0,
                };
                self.state = anew;
                return Some(End::Label(label));
            }
            State::Holding(since, held) => (*since, held),
        };
        if lead.calls(newest, held) {
            self.state = anew;
            return Some(End::Overtaken);
        }
        let x = newest.sample.change_since(&held.sample);
        let age = span(since, now);
        let ends = match rule.pairs {
            Pairs::FirstCrossings => x >= self.threshold,
            Pairs::WeightedLags | Pairs::Published => {
                age + HYPERPERIOD / 2 >= HYPERPERIOD * u32::from(self.lag)
            }
        };
        if !(ends || age >= rule.failsafe) {
            if rule.reference == Reference::PreviousSample {
                held.sample = newest.sample;
            }
            return None;
        }
        match (&newest.command, &held.command) {
            (Commanded::Over(run), Commanded::Over(before)) => {
                let (run, replaced) = (*run, before.command());
                self.state = State::Ended { x, run, replaced };
                None
            }
            (newest, held) => {
                let label = Label {
                    x,
                    changed: newest.change_since(held) >= rule.counts,
                    weight: 1.0,
                };
                self.state = anew;
                Some(End::Label(label))
            }
        }
    }
}

impl Commanded {
    fn course(&self) -> Option<&Course> {
        match self {
            Self::Now(_) => None,
            Self::Over(course) => Some(course),
        }
    }
}

impl Sample for Commanded {
    fn change_since(&self, reference: &Self) -> f32 {
        match (self, reference) {
            (Self::Now(command), Self::Now(before)) => command.change_since(before),
            (Self::Over(course), Self::Over(before)) => course.change_since(before),
            _ => 0.0,
        }
    }
}

impl Lead {
    fn calls<S>(&self, newest: &Held<S>, held: &Held<S>) -> bool {
        match self {
            Self::Command(threshold) => newest.command.change_since(&held.command) > *threshold,
            Self::Gyro(threshold) => newest.rates.change_since(&held.rates) > *threshold,
            Self::Itself => false,
        }
    }
}

/// True where some motor's command differs by a quantum or more: a dead-band, not a rounding.
#[must_use]
pub fn differs(a: &MotorShares, b: &MotorShares, quantum: f32) -> bool {
    a.fold_with(b, false, |differs, a, b| {
        differs | ((a - b).abs() >= quantum)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::of_input;
    use crate::sensors::Input;
    use crate::time::{at_micros, micros};

    fn rule(reference: Reference) -> Rule {
        Rule {
            reference,
            pairs: Pairs::FirstCrossings,
            counts: 1.0 / 255.0,
            failsafe: micros(100_000),
        }
    }

    /// A slow ramp of the sample, with a command that follows it.
    fn ramp(reference: Reference) -> Labels {
        let mut holds = ShadowHolds::new(&of_input(Input::Gyro).changes);
        let mut labels = Labels::new(&of_input(Input::Gyro).changes);
        for step in 0..20_000u64 {
            let rate = step as f32 * 1e-4;
            let newest = Held {
                sample: Vec3::new(rate, 0.0, 0.0),
                command: Commanded::Now(MotorShares::all(0.5 + 0.06 * rate, 4)),
                rates: Vec3::ZERO,
            };
            holds.take(
                at_micros(step * 1000),
                &newest,
                &rule(reference),
                &Lead::Itself,
                &mut labels,
                |_| {},
            );
        }
        labels
    }

    #[test]
    fn a_slow_ramp_crosses_only_where_the_reference_is_the_last_run() {
        let last_run = ramp(Reference::LastRun);
        let previous = ramp(Reference::PreviousSample);
        // Every hold against the previous sample lasts until the failsafe.
        assert_eq!(previous.total(), 12.0 * 199.0);
        assert!(last_run.total() > previous.total());
    }

    #[test]
    fn a_difference_of_exactly_a_quantum_counts() {
        let quantum = 0.25;
        let level = |share| MotorShares::all(share, 4);
        assert!(differs(&level(0.5), &level(0.75), quantum));
        assert!(!differs(&level(0.5), &level(0.7), quantum));
    }
}
