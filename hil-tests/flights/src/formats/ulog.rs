//! Reads flights from PX4's ULog files.
//!
//! The crate `px4-ulog` decodes the messages. Framing is done here, so that what
//! is cut or spoilt is skipped and counted, as pyulog does it, and so that only
//! what a flight needs is decoded. The whole log is taken, armed or not.
//!
//! Which topic gives what, first found first:
//!
//! | of the flight | topics |
//! |---|---|
//! | gyroscope, accelerometer | the fastest that lives of `sensor_combined`, `vehicle_imu`, `sensor_gyro` with `sensor_accel` |
//! | magnetometer | `vehicle_magnetometer`, `sensor_combined` (older logs), `sensor_mag` |
//! | motors | `actuator_motors`, else `actuator_outputs` as 1000..2000 us pulses |
//! | attitude, position | `vehicle_attitude`, `vehicle_local_position` (where valid) |
//! | setpoints | `vehicle_attitude_setpoint`, `vehicle_rates_setpoint`, thrust from either |
//! | armed, landed | `vehicle_status`, else `actuator_armed`; `vehicle_land_detected` |
//!
//! PX4 writes NaN for "not controlled": such messages are left out.

mod messages;
mod table;
mod topics;
mod vehicle;

use super::super::error::Fault;
use super::super::recording::Recording;

/// What every ULog file starts with, before its version byte.
const MAGIC: [u8; 7] = [b'U', b'L', b'o', b'g', 0x01, 0x12, 0x35];

/// True for a ULog.
pub(super) fn knows(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

/// Reads a log as far as it can be read.
///
/// # Errors
/// What the log lacks, or why nothing of it can be read.
pub(super) fn read(bytes: &[u8]) -> Result<Recording, Fault> {
    topics::recording(messages::read(bytes)?)
}
