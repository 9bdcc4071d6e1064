//! Which gains each control logic has: one table per file of `logics/*.toml`.
//!
//! A new gain is one line in its table and a few in the TOML, a new logic a table and its entry
//! in [`LOGICS`]. Checks and constants both come from here.

mod arducopter;
mod cascade;
mod cleanflight;
mod observer;
mod openpilot;

use reflex_settings::{Range, above, within};

use crate::logic::{Gain, Shape};

/// Every control logic: the name of its file and its gains.
pub(crate) const LOGICS: &[(&str, &[Gain])] = &[
    ("arducopter", arducopter::GAINS),
    ("cascade", cascade::GAINS),
    ("cleanflight", cleanflight::GAINS),
    ("observer", observer::GAINS),
    ("openpilot", openpilot::GAINS),
];

/// A gain of one number.
const fn number(path: [&'static str; 2], range: Range, unit: &'static str) -> Gain {
    let [section, key] = path;
    Gain {
        section,
        key,
        name: None,
        shape: Shape::Number,
        range,
        unit,
        meaning: "",
        growth: 0,
    }
}

/// A gain of three numbers: roll, pitch, yaw.
const fn axes(path: [&'static str; 2], range: Range, unit: &'static str) -> Gain {
    let mut gain = number(path, range, unit);
    gain.shape = Shape::Axes;
    gain
}

impl Gain {
    /// With what it does, in words that end without a full stop.
    const fn meaning(mut self, meaning: &'static str) -> Self {
        self.meaning = meaning;
        self
    }

    /// A gain of the attitude or rate loop, and the power of their bandwidth that it grows with.
    ///
    /// Loops that are to be twice as fast ask for twice the rate per error, twice the torque per
    /// rate, and four times the torque per angle.
    const fn grows(mut self, power: i32) -> Self {
        self.growth = power;
        self
    }

    /// With a constant's name that is not made of section and key.
    const fn named(mut self, name: &'static str) -> Self {
        self.name = Some(name);
        self
    }
}
