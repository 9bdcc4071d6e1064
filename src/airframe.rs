//! The airframe: how torque and thrust become motor commands, and commands pulses.

mod axes;
mod mixer;
mod motor_shares;
mod pulse;

pub use axes::Axes;
pub use mixer::{Allocation, Asked, Evenly, LevelFirst, Mixed, Mixer, Shared, Sharing};
pub use motor_shares::MotorShares;
pub use pulse::{period_ticks, ticks};
