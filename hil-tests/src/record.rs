//! The record of a run: the autopilot's calls, and what its board did.
//!
//! Every tier that flies, recorded or in closed loop, is judged by such a record. On the emulated
//! board three independent sources make it: motor registers, edges on interrupt lines, and the
//! firmware's call log. They are held against each other ([`Alignment`]), and the calls are made
//! again on the host ([`Mirror`]), which must compute the same bits.

mod alignment;
mod call_stream;
mod counted;
mod handlers;
mod looks;
mod mirror;
pub(crate) mod motor_timers;
mod observation;
mod struck;

pub(crate) use alignment::{AlignedRun, Alignment};
pub use counted::Counted;
pub(crate) use counted::CountedFrom;
pub(crate) use handlers::HANDLERS;
pub(crate) use looks::{ChipState, Look, OfChips, samples_since};
pub(crate) use mirror::Mirror;
pub(crate) use observation::{DecodedLog, Observation, WAY};
pub(crate) use struck::run_struck;
