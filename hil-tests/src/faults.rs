//! Faults of a simulated flight: what can break, and scripts that say when.
//!
//! [`KINDS`] declares every kind once; reading a script, its refusals and the list of kinds follow from it.

mod distortion;
mod kinds;
mod link;
mod random;
mod script;
mod signal;
mod strikes;

pub use distortion::{Distortion, Elements};
pub use kinds::{Chip, Effect, KINDS, Kind, Said, Size, list};
pub use link::BrokenLink;
pub use random::any_script;
pub use script::{Entry, Fault, Limits, Script};
pub use signal::broken;
pub use strikes::{Strike, Strikes, Struck};
