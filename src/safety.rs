//! What stands between the control logic and the motors.

mod arming;
mod motor_gate;

pub use arming::{Arming, ArmingEvent, Refusal};
pub use motor_gate::{MotorGate, MotorOutput};
