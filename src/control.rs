//! Control laws: from attitude and setpoint to torque demands.
//!
//! Configuration, state and step are separate: `law.step(&mut state, input, dt)`. `dt` is the
//! measured time covered by the samples consumed; with `dt` of zero the output is recomputed
//! from the present inputs and no state advances.

mod attitude_law;
mod rate_law;
mod setpoint;

pub use attitude_law::{AttitudeLaw, Wanted};
pub use rate_law::{RateInput, RateLaw, RateState};
pub use setpoint::{Setpoint, Yaw};
