//! Recorded flights replayed, by the firmware on the emulated board or natively.
//!
//! ```text
//! log -> flight -> chips -> [ autopilot on its board ] -> calls -> timeline -> score
//!           \-> setpoints -> link frames -^
//! ```
//! [`emulated`] runs the unmodified firmware on an emulated processor, [`native`] the same
//! autopilot without one. Both take the same [`options`], refuse the same flights, and judge
//! the calls of the autopilot in the same way.

mod asking;
pub mod emulated;
mod link_frames;
pub(crate) mod logs;
pub mod native;
pub mod options;
pub(crate) mod refusals;
mod report;
mod setup;
mod timeline;

pub(crate) use report::{options_in_effect, unit_of};
pub(crate) use setup::open_flight;
