//! What can be set or chosen, declared once for build, firmware and host.
//!
//! - [`Setting`]: name, place in TOML, kind and range, unit, meaning, option of one value
//! - [`declare!`]: a struct of settings, fields and declarations in one place
//! - [`Settings`]: what may be chosen at each start; a [`Start`] is given them, airframe and gains
//! - [`Parameter`]: one word of a start, under a number that later builds know again
//! - [`REACTIVE`], [`INPUT`], [`SAFETY`], [`BOARD`]: what is fixed by a build
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod airframe;
mod block;
mod board;
pub mod bytes;
mod choices;
mod declare;
pub mod gains;
mod inputs;
mod logics;
mod parameter;
mod range;
mod reactive;
mod safety;
mod sensors;
mod setting;
mod settings;
mod text;
mod time;

pub use airframe::{
    ARMED_MINIMUM, Airframe, AirframeError, DIRECTION, FEWEST_MOTORS, MOST_MOTORS, Motor,
};
pub use block::{BlockError, Start};
pub use board::{BOARD, rates};
pub use choices::{Choice, Choices, Feedback, MotorProtocol, Mounting, Pairs, Policy, Reference};
pub use declare::{Declared, Field};
pub use inputs::{Declaration, Input, Inputs, Rate, Source, Unit};
pub use parameter::Parameter;
pub use range::{Range, above, between, from_below, one_of, within};
pub use reactive::{INPUT, REACTIVE, of_input};
pub use safety::SAFETY;
pub use sensors::{
    HARD_IRON, MOTOR_FIELD, SOFT_IRON_DIAGONAL, SOFT_IRON_OFF_DIAGONAL, TURN_ON, WARMING,
};
pub use setting::{Kind, Limit, Limits, OutOfRange, Path, Setting, Value, Written};
pub use settings::{LARGEST_TRIM, Settings, WarmUp};
pub use text::Unreadable;
pub use time::{Duration, micros};
