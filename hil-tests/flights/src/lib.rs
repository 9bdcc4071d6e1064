//! Recorded flights: read, checked, turned into the body frame and replayed.
//!
//! A log becomes a [`Flight`]; a [`FlightStimulus`] lets the emulated sensors
//! feel it, [`Setpoints`] say what the drone was asked to do, and [`Sightings`]
//! where it was.
//!
//! ```text
//! log -- packed, formats --> Recording -- parts, check, rotation, gaps --> Flight
//!                                        Flight -- FlightStimulus --> chips
//!                                        Flight -- Setpoints, Sightings --> link
//! ```

mod attitude;
mod contents;
mod error;
mod flight;
mod formats;
mod gaps;
mod lowpass;
mod packed;
mod parts;
mod quaternion;
mod recording;
pub mod recordings;
mod rotation;
mod sample_flight;
mod samples;
mod setpoint;
mod sighting;
mod skipped;
mod stimulus;
mod track;
mod units;

pub use contents::{Contents, Replayed, Signal};
pub use error::{Fault, FlightError, Location};
pub use flight::{Flight, Reading, RotationReason};
pub use gaps::Gap;
pub use parts::{Evidence, Flown, Part, PartReason, Taken};
pub use recording::{Dropouts, LogFormat, MAX_MOTORS, Motors, Recorded, Sensor, Vehicle};
pub use rotation::{Rotate, Rotation, RotationError};
pub use sample_flight::sample_flight;
pub use setpoint::{Setpoint, SetpointSource, SetpointSources, Setpoints};
pub use sighting::{Sighting, Sightings};
pub use skipped::{Skip, Skipped};
pub use stimulus::{FlightStimulus, Standstill};
pub use track::{Span, Track, seconds};
pub use units::{Units, UnitsError};
