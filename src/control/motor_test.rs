//! One motor that shall turn while the drone is disarmed: what a motor test asks for.

use crate::time::Duration;

/// A test of one motor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct MotorTest {
    /// Its place in the airframe, from 0.
    pub motor: u8,
    /// Its command, as a share of full scale; limited to what is configured.
    pub share: f32,
    /// For how long; limited to what is configured.
    pub length: Duration,
}
