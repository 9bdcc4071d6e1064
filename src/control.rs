//! Control laws: from attitude and setpoint to torque demands.
//!
//! Configuration, state and what advances it are separate: `law.after(&state, stretch)` is the
//! state after a stretch of measured time, `law.demand(&state, input)` what it asks for. After a
//! stretch of no length the demand is recomputed from the present inputs, and the state stays.

pub mod arducopter;
mod attitude_law;
pub mod cleanflight;
mod goal;
mod integral;
mod motor_test;
mod observer_law;
mod one_pole;
pub mod openpilot;
mod rate_law;
mod setpoint;

pub use attitude_law::{AttitudeLaw, Wanted};
pub use goal::Goal;
pub use motor_test::MotorTest;
pub use observer_law::{ObserverLaw, ObserverState, ObserverStretch};
pub use rate_law::{RateInput, RateLaw, RateState, RateStretch};
pub use setpoint::{Setpoint, Yaw};
