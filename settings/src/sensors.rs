//! Ranges of what sensors show of their own, for settings, files and options.

use crate::range::{Range, within};

/// The field of magnets that travel with a magnetometer, gauss.
pub const HARD_IRON: Range = within(-4.0, 4.0);
/// The diagonal of the matrix that undoes what steel bends.
pub const SOFT_IRON_DIAGONAL: Range = within(0.5, 2.0);
/// What is beside it: with these ranges the matrix always has an inverse.
pub const SOFT_IRON_OFF_DIAGONAL: Range = within(-0.2, 0.2);
/// The field of motors at a magnetometer, gauss for each A of all of them.
pub const MOTOR_FIELD: Range = within(-0.1, 0.1);
/// What an axis of a gyroscope shows at rest, deg/s.
pub const TURN_ON: Range = within(0.0, 60.0);
/// By how much a gyroscope's die warms up, degrees Celsius.
pub const WARMING: Range = within(0.0, 60.0);
