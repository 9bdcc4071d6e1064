//! Where the drone shall be: the demand on position and altitude loops.

use crate::units::{Position, Velocity};

/// A place to fly to, and to hover at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Goal {
    /// Desired position in the local north-east-down frame.
    pub position: Position,
    /// Velocity with which the goal itself moves, zero for a place to hover at.
    pub velocity: Velocity,
    /// Desired heading in rad from north, clockwise.
    pub heading: f32,
}
