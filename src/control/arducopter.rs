//! ArduCopter's loops: angle, rate, position, altitude, and how motors are shared.
//!
//! Written anew from the published structure of ArduCopter 4.5; the page `graph/arducopter.rs`
//! says which part follows what, and how its gains were converted. Every piece gives the same
//! after one long step as after many short ones, as far as its input moved linearly.

mod angle;
mod approach;
mod course;
mod lift;
mod rate;
mod sharing;

pub use angle::{Asked, angle_loop};
pub use approach::{Approach, approach};
pub use course::{Climb, Course, climbing, moved, steered};
pub use lift::{Lift, boosted, lifted};
pub use rate::{RateLoop, RateMemory};
pub use sharing::AroundHover;
