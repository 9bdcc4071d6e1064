//! The ways in which a sensor can be wrong.

use chip_models::Sensor;

/// Axes of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Elements {
    /// The sensor.
    pub of: Sensor,
    /// Those of its axes that are meant.
    pub axes: [bool; 3],
}

/// What becomes of a reading, in deg/s, g or gauss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distortion {
    /// The first of the fault is repeated.
    Stuck,
    /// Zero.
    Zero,
    /// Random, over the whole range.
    Garbage,
    /// At the end of the range.
    Saturated,
    /// So many times as much.
    Scaled(f64),
    /// So much more.
    Bias(f64),
    /// More by so much each second.
    Drift(f64),
    /// Turned about the vertical axis, degrees.
    Turned(f64),
}
