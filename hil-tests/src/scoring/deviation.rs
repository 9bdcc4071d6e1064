//! How far a held command strays from the reference: one measure for all.

use super::flight::Command;

/// Whether some motor's two commands differ by at least a quantum.
///
/// A dead-band, not a rounding, in the firmware's own `f32`. A command that is not a number
/// differs from every other.
#[must_use]
pub fn differs(one: &Command, other: &Command, quantum: f32) -> bool {
    one.iter()
        .zip(other.iter())
        .any(|(one, other)| (one - other).abs() >= quantum || one.is_nan() || other.is_nan())
}

/// Sum over the motors of the squared difference, in full scale squared.
pub(super) fn square(one: &Command, other: &Command) -> f64 {
    one.iter()
        .zip(other.iter())
        .map(|(one, other)| (f64::from(*one) - f64::from(*other)).powi(2))
        .sum()
}

/// Staleness and RMS deviation of held commands, summed over hyperperiods.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Deviation {
    hyperperiods: u64,
    motors: usize,
    stale: u64,
    squares: f64,
}

impl Deviation {
    /// Adds one hyperperiod: what is held at its end against the reference.
    pub fn add(&mut self, held: &Command, reference: &Command, quantum: f32) {
        let stale = differs(held, reference, quantum);
        self.add_judged(stale, square(held, reference), reference.len());
    }

    /// Adds one hyperperiod of so many motors, of which staleness and squared deviation are known.
    pub fn add_judged(&mut self, stale: bool, square: f64, motors: usize) {
        self.motors = motors;
        self.hyperperiods += 1;
        self.stale += u64::from(stale);
        self.squares += square;
    }

    /// RMS over hyperperiods and motors, in quanta; `None` without a hyperperiod.
    pub fn rms_quanta(&self, quantum: f32) -> Option<f64> {
        let mean = self.squares / (self.hyperperiods as f64 * self.motors as f64);
        finite(mean.sqrt() / f64::from(quantum))
    }

    /// Share of hyperperiods that ended stale; `None` without a hyperperiod.
    pub fn stale_fraction(&self) -> Option<f64> {
        share(self.stale, self.hyperperiods)
    }
}

/// `part / whole`, `None` where there is no whole.
pub(super) fn share(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

/// Events a second, `None` over no time.
pub(super) fn rate(events: u64, length_s: f64) -> Option<f64> {
    finite(events as f64 / length_s)
}

/// The value where it is a finite number: JSON knows no other.
pub(super) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
