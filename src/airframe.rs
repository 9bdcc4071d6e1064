//! The airframe: how torque and thrust become motor commands, and commands pulses.

mod mixer;
mod pulse;

pub use mixer::{MIXER, Mixed, Mixer};
pub use pulse::{period_ticks, ticks};

use crate::config::MOTORS;

/// One command per motor, each a share of full scale, 0 to 1.
pub type MotorShares = [f32; MOTORS];
