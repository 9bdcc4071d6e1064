//! Reads flights from PX4's ULog files.
//!
//! The crate `px4-ulog` decodes the messages. Framing is done here, so that a
//! cut or spoilt message is named by its byte offset, and so that only what a
//! flight needs is decoded. The whole log is taken, armed or not.
//!
//! Which topic gives what, first found first:
//!
//! | of the flight | topics |
//! |---|---|
//! | gyroscope, accelerometer | the fastest of `sensor_combined`, `vehicle_imu`, `sensor_gyro` with `sensor_accel` |
//! | magnetometer | `vehicle_magnetometer`, `sensor_combined` (older logs), `sensor_mag` |
//! | motors | `actuator_motors`, else `actuator_outputs` as 1000..2000 us pulses |
//! | attitude, position | `vehicle_attitude`, `vehicle_local_position` (where valid) |
//! | setpoints | `vehicle_attitude_setpoint`, `vehicle_rates_setpoint`, thrust from either |
//!
//! A sensor value that is not finite refuses the log. Elsewhere PX4 writes NaN
//! for "not controlled": such messages are left out.

mod messages;
mod table;
mod topics;

use super::error::Fault;
use super::recording::Recording;

/// What every ULog file starts with, before its version byte.
pub(super) const MAGIC: [u8; 7] = [b'U', b'L', b'o', b'g', 0x01, 0x12, 0x35];

/// Reads a whole log.
///
/// # Errors
/// The first byte offset that cannot be read, or what the log lacks.
pub(super) fn read(bytes: &[u8]) -> Result<Recording, Fault> {
    topics::recording(&messages::read(bytes)?)
}
