//! What can be set or chosen: declared once for the build, the firmware and the host.
#![no_std]
#![forbid(unsafe_code)]

mod choices;
pub mod gains;
mod inputs;
mod logics;
mod range;
mod time;

pub use choices::{Feedback, MotorProtocol, Pairs, Policy, Reference, WarmUp};
pub use inputs::{Declaration, Input, Inputs, Source, Unit};
pub use range::{Range, above, between, from_below, one_of, within};
pub use time::{Duration, micros};
