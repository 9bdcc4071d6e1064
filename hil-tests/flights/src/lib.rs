//! Recorded flights: read, checked, turned into the body frame and replayed.
//!
//! A log becomes a [`Flight`]; a [`FlightStimulus`] lets the emulated sensors
//! feel it, [`Setpoints`] say what the drone was asked to do, and [`Sightings`]
//! where it was.
//!
//! ```text
//! log -- csv_log, ulog --> Recording -- check, rotation, gaps --> Flight
//!                                      Flight -- FlightStimulus --> chips
//!                                      Flight -- Setpoints, Sightings --> link
//! ```

mod attitude;
mod csv_log;
mod error;
mod flight;
mod gaps;
mod lowpass;
mod quaternion;
mod recording;
pub mod recordings;
mod rotation;
mod sample_flight;
mod setpoint;
mod sighting;
mod stimulus;
mod track;
mod ulog;

pub use error::{Fault, FlightError, Location};
pub use flight::{Flight, RotationReason};
pub use gaps::Gap;
pub use recording::{LogFormat, MAX_MOTORS, Motors, Recorded, Sensor};
pub use rotation::{Rotate, Rotation, RotationError};
pub use sample_flight::sample_flight;
pub use setpoint::{Setpoint, SetpointSource, SetpointSources, Setpoints};
pub use sighting::{Sighting, Sightings};
pub use stimulus::{FlightStimulus, Standstill};
pub use track::{Track, seconds};
