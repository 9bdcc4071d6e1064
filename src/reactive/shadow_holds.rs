//! Shadow holds: what reactive control would have met, learned in advance.
//!
//! A command that is held ages, and the change that has then piled up is not the change from
//! one sample to the next. So the warm-up pretends: for each of some candidate thresholds it
//! holds a command and the sample behind it, waits until the change first crosses the
//! candidate (or the failsafe would have come), labels that crossing, and holds anew.

use super::Labels;
use crate::airframe::MotorShares;
use crate::config::{MOTORS, SensorInput};
use crate::math::Vec3;
use crate::settings::Reference;
use crate::time::{Duration, Instant, span};

/// Number of candidate thresholds.
const CANDIDATES: usize = 12;

/// A command in force and the sample behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Held {
    /// The input's sample that the command was computed from.
    pub sample: Vec3,
    /// The command.
    pub command: MotorShares,
}

/// The shadow holds of one input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowHolds {
    holds: [Hold; CANDIDATES],
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Hold {
    threshold: f32,
    held: Held,
    since: Option<Instant>,
}

/// What labels depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// What a change is measured against.
    pub reference: Reference,
    /// The change of a command that counts.
    pub quantum: f32,
    /// The longest hold.
    pub failsafe: Duration,
}

impl ShadowHolds {
    /// Candidates spread evenly in the logarithm over the input's changes.
    #[must_use]
    pub fn new(input: &SensorInput) -> Self {
        let ratio = input.largest_change / input.smallest_change;
        let step = libm::powf(ratio, 1.0 / (CANDIDATES as f32 + 1.0));
        let mut threshold = input.smallest_change;
        let mut holds = [Hold::default(); CANDIDATES];
        for hold in &mut holds {
            threshold *= step;
            hold.threshold = threshold;
        }
        Self { holds }
    }

    /// Forgets what is held: the next sample starts all holds.
    pub fn restart(&mut self) {
        for hold in &mut self.holds {
            hold.since = None;
        }
    }

    /// Takes the newest sample and command; adds a label for every hold that ends.
    pub fn take(&mut self, now: Instant, newest: &Held, rule: &Rule, labels: &mut Labels) {
        for hold in &mut self.holds {
            hold.take(now, newest, rule, labels);
        }
    }
}

impl Hold {
    fn take(&mut self, now: Instant, newest: &Held, rule: &Rule, labels: &mut Labels) {
        let Some(since) = self.since else {
            self.begin(now, newest);
            return;
        };
        let x = (newest.sample - self.held.sample).max_norm();
        if x >= self.threshold || span(since, now) >= rule.failsafe {
            let changed = differs(&newest.command, &self.held.command, rule.quantum);
            labels.add(x, changed, 1.0);
            self.begin(now, newest);
        } else if rule.reference == Reference::PreviousSample {
            self.held.sample = newest.sample;
        }
    }

    fn begin(&mut self, now: Instant, newest: &Held) {
        self.held = *newest;
        self.since = Some(now);
    }
}

/// True where some motor's command differs by a quantum or more: a dead-band, not a rounding.
#[must_use]
pub fn differs(a: &MotorShares, b: &MotorShares, quantum: f32) -> bool {
    (0..MOTORS).any(|motor| match (a.get(motor), b.get(motor)) {
        (Some(a), Some(b)) => (a - b).abs() >= quantum,
        _ => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::GYRO;
    use crate::time::{at_micros, micros};

    fn rule(reference: Reference) -> Rule {
        Rule {
            reference,
            quantum: 1.0 / 255.0,
            failsafe: micros(100_000),
        }
    }

    /// A slow ramp of the sample, with a command that follows it.
    fn ramp(reference: Reference) -> Labels {
        let mut holds = ShadowHolds::new(&GYRO);
        let mut labels = Labels::new(&GYRO);
        for step in 0..20_000u64 {
            let rate = step as f32 * 1e-4;
            let newest = Held {
                sample: Vec3::new(rate, 0.0, 0.0),
                command: [0.5 + 0.06 * rate; MOTORS],
            };
            holds.take(
                at_micros(step * 1000),
                &newest,
                &rule(reference),
                &mut labels,
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
        assert!(differs(&[0.5; MOTORS], &[0.75; MOTORS], quantum));
        assert!(!differs(&[0.5; MOTORS], &[0.7; MOTORS], quantum));
    }
}
