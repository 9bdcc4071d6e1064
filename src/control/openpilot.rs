//! OpenPilot's laws: attitude PI and rate PID, and the path follower above them.
//!
//! The original works in degrees and in deflections of -1 to 1. Here a gain per degree is
//! `180 / pi` times as large, and a deflection is half as large: the mixer of its quadrotor has a
//! level of 50 %, so that full deflection moves a motor by half of its range.

mod path_follower;
mod stabilization;
mod stretch;

pub use path_follower::{PathFollower, PathState};
pub use stabilization::{AttitudeError, AttitudePi, Integrals, Stabilization, StabilizedStretch};
pub use stretch::ErrorStretch;
