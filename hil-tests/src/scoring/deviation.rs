//! How far held commands stray from the reference: one measure for all.

use super::felt::{Lag, Motors};
use super::flight_steps::Command;
use schemars::JsonSchema;
use serde::Serialize;

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

/// How far held commands strayed from the reference; null without a hyperperiod.
///
/// *Felt* is the same deviation behind the lag of the motors, which vibration hardly passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Deviation {
    /// Share of hyperperiods that ended a quantum or more away.
    pub stale_fraction: Option<f64>,
    /// RMS deviation over hyperperiods and motors, in configured quanta.
    pub rms_deviation_quanta: Option<f64>,
    /// Largest deviation of a motor, in configured quanta.
    pub largest_deviation_quanta: Option<f64>,
    /// RMS deviation as the motors feel it, in configured quanta.
    pub rms_felt_quanta: Option<f64>,
    /// Largest deviation as a motor felt it, in configured quanta.
    pub largest_felt_quanta: Option<f64>,
}

impl Deviation {
    /// Each number's mean; null where one is.
    pub(super) fn mean(all: &[Self]) -> Self {
        let of = |number: fn(&Self) -> Option<f64>| {
            let sum: Option<f64> = all.iter().map(number).sum();
            finite(sum? / all.len() as f64)
        };
        Self {
            stale_fraction: of(|one| one.stale_fraction),
            rms_deviation_quanta: of(|one| one.rms_deviation_quanta),
            largest_deviation_quanta: of(|one| one.largest_deviation_quanta),
            rms_felt_quanta: of(|one| one.rms_felt_quanta),
            largest_felt_quanta: of(|one| one.largest_felt_quanta),
        }
    }
}

/// How far a held command has strayed at the end of one hyperperiod.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strayed {
    pub stale: bool,
    motors: usize,
    now: Size,
    felt: Size,
}

/// Follows a held command and the reference through a flight, hyperperiod by hyperperiod.
pub(super) struct Straying {
    quantum: f32,
    lag: Lag,
}

impl Straying {
    pub fn new(quantum: f32) -> Self {
        Self {
            quantum,
            lag: Lag::default(),
        }
    }

    /// What is held at a hyperperiod's end against the reference.
    pub fn at(&mut self, at_us: u64, held: &Command, reference: &Command) -> Strayed {
        let mut off = Motors::default();
        for (off, (held, reference)) in off.iter_mut().zip(held.iter().zip(reference.iter())) {
            *off = f64::from(*held) - f64::from(*reference);
        }
        Strayed {
            stale: differs(held, reference, self.quantum),
            motors: reference.len(),
            now: Size::of(&off),
            felt: Size::of(&self.lag.pass(at_us, off)),
        }
    }
}

/// What hyperperiods add up to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    hyperperiods: u64,
    motors: usize,
    stale: u64,
    now: Size,
    felt: Size,
}

impl Tally {
    pub fn add(&mut self, strayed: &Strayed) {
        self.hyperperiods += 1;
        self.motors += strayed.motors;
        self.stale += u64::from(strayed.stale);
        self.now.add(strayed.now);
        self.felt.add(strayed.felt);
    }

    /// In quanta of this size.
    pub fn deviation(&self, quantum: f32) -> Deviation {
        let largest = |size: &Size| {
            let any = self.hyperperiods > 0;
            finite(size.largest / f64::from(quantum)).filter(|_| any)
        };
        let rms = |size: &Size| {
            let mean = size.square / self.motors as f64;
            finite(mean.sqrt() / f64::from(quantum))
        };
        Deviation {
            stale_fraction: share(self.stale, self.hyperperiods),
            rms_deviation_quanta: rms(&self.now),
            largest_deviation_quanta: largest(&self.now),
            rms_felt_quanta: rms(&self.felt),
            largest_felt_quanta: largest(&self.felt),
        }
    }
}

/// Of deviations in shares of full scale: the sum of their squares, and the largest.
#[derive(Clone, Copy, Debug, Default)]
struct Size {
    square: f64,
    largest: f64,
}

impl Size {
    fn of(off: &Motors) -> Self {
        let mut size = Self::default();
        for off in off {
            size.add(Self {
                square: off * off,
                largest: off.abs(),
            });
        }
        size
    }

    /// A deviation that is not a number leaves none.
    fn add(&mut self, other: Self) {
        self.square += other.square;
        if other.largest > self.largest || other.largest.is_nan() {
            self.largest = other.largest;
        }
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
