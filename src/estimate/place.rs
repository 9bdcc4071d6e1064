//! Where the drone is, as something outside the control logic knows it.

use crate::units::{Position, Velocity};

/// Position and velocity, with the time that they stand for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Position in the local north-east-down frame.
    pub position: Position,
    /// Velocity in the same frame.
    pub velocity: Velocity,
    /// Time since the place before, in s; zero for the first one, and after a silence.
    pub dt: f32,
}
