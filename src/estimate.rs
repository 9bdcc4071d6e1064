//! From samples to what the control logic wants to know: rates and attitude.

pub mod arducopter;
mod arrival;
mod attitude;
mod calibration;
mod iron;
mod mahony;
mod openpilot;
mod place;
mod response;
mod track;
mod vertical;

pub use arrival::{Arrival, Increment, Motion, Rotation, trusted_down};
pub use attitude::{AttitudeFilter, Corrections, in_small_turns};
pub use calibration::{AtRest, Calibrating, GyroCalibration, LARGEST_BIAS};
pub use iron::Iron;
pub use mahony::{Evidence, MahonyFilter};
pub use openpilot::{OpenPilotFilter, Turned};
pub use place::Place;
pub use response::{Response, Unanswered};
pub use track::{Followed, Track};
pub use vertical::Vertical;
