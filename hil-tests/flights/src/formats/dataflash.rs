//! Reads flights from ArduPilot's binary DataFlash logs.
//!
//! The crate `ardupilot-binlog` decodes the fields. Framing is done here: the
//! crate's own reader counts nothing of what it skips, gives up behind 256
//! faults, and trusts lengths that would make it panic.
//!
//! Which message gives what, each with its instances (`IMU2`, or the field `I`):
//!
//! | of the flight | messages |
//! |---|---|
//! | gyroscope, accelerometer | the fastest that lives of `GYR` with `ACC`, `IMU`, `IMU2`, `IMU3` |
//! | magnetometer | the fastest that lives of `MAG`, `MAG2`, `MAG3`, milligauss |
//! | motors | `RCOU`, 1000..2000 us; which of them by `SERVOn_FUNCTION`, or by the frame |
//! | attitude, setpoints | `ATT`, degrees; `RATE`; thrust from `CTUN` |
//! | armed, landed | `EV`, `ARM` |
//!
//! Axes are forward, right, down.

mod framing;
mod messages;

use super::super::error::Fault;
use super::super::recording::Recording;

/// True for a log that says how its messages are laid out.
pub(super) fn knows(bytes: &[u8]) -> bool {
    framing::begins(bytes)
}

/// Reads a log as far as it can be read.
///
/// # Errors
/// What the log lacks.
pub(super) fn read(bytes: &[u8]) -> Result<Recording, Fault> {
    let mut flight = messages::Flight::default();
    framing::read(bytes, &mut flight);
    flight.finish()
}
