//! The link: MAVLink 2 over a serial line, from bytes to checked messages and back.
//!
//! [`Parser`] turns bytes in any chunking into [`Incoming`] messages, [`Sender`] makes the
//! few frames that the drone sends. Only what is flown is decoded: HEARTBEAT,
//! SET_ATTITUDE_TARGET, SET_POSITION_TARGET_LOCAL_NED, COMMAND_LONG, COMMAND_INT, ODOMETRY and
//! SETUP_SIGNING. The crate `mavlink` supplies the messages' layouts, checksums and enumerations;
//! its reader is left out, because it decodes the whole dialect (hundreds of messages, more than
//! the flash budget).
//!
//! Promises:
//! - A malformed, truncated or implausible frame changes nothing and is counted
//!   ([`LinkCounters`]). No value that is infinite or not a number passes.
//! - Nothing is delivered late: a frame that is not complete [`PATIENCE`] after its first byte
//!   is dropped, so noise cannot hold back a command to arm and release it seconds later.
//! - The first station that commands is the pilot, alone; with a key, only signed frames count.
//!   Who may do what is in `docs/link.md`.
//! - What lies inside a frame is never read as a frame while the outer one may be sound: a
//!   recorded flight that passes through as payload (file transfer, tunnel) arms nothing.
//!
//! Limits:
//! - Without a key anyone who can write to the link can be its pilot.
//! - MAVLink 1 frames are skipped. Their payload is not looked at.
//! - Noise that looks like the start of a frame of another kind takes up to 267 following
//!   bytes with it, or [`PATIENCE`], whichever ends first.

mod admission;
mod counters;
mod decode;
mod encode;
mod framing;
mod message;
mod notice;
mod parser;
mod peers;
mod roles;
mod signing;
#[cfg(test)]
mod tests;

pub use admission::Incoming;
pub use counters::LinkCounters;
pub use encode::{Frame, LONGEST_FRAME_OUT, Sender, Status};
pub use message::{
    Answer, ArmCommand, Calibrate, Destination, ExternalPose, Message, StoreCommand,
};
pub use notice::{Notice, Severity};
pub use parser::{Feed, Parser};
pub use peers::Peer;
pub use signing::{Signing, SigningKey};

use crate::time::{Duration, micros};
use mavlink::dialects::common::MavCmd;

/// The drone's MAVLink system number.
pub const SYSTEM: u8 = 1;

/// The autopilot's MAVLink component number (MAV_COMP_ID_AUTOPILOT1).
pub const COMPONENT: u8 = 1;

/// Number of the command that arms and disarms (MAV_CMD_COMPONENT_ARM_DISARM).
pub const ARM_DISARM: u16 = MavCmd::MAV_CMD_COMPONENT_ARM_DISARM as u16;

/// Number of the command that turns one motor (MAV_CMD_DO_MOTOR_TEST).
pub const MOTOR_TEST: u16 = MavCmd::MAV_CMD_DO_MOTOR_TEST as u16;

/// Number of the command that calibrates (MAV_CMD_PREFLIGHT_CALIBRATION).
pub const CALIBRATE: u16 = MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION as u16;

/// Number of the command that stores settings (MAV_CMD_PREFLIGHT_STORAGE).
pub const STORE: u16 = MavCmd::MAV_CMD_PREFLIGHT_STORAGE as u16;

/// How long a frame may take to arrive.
///
/// The longest takes 6 ms at 460800 baud; radios and USB adapters add gaps of tens of ms.
pub const PATIENCE: Duration = micros(100_000);
