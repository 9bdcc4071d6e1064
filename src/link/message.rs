//! The messages that the link brings to the autopilot, decoded and checked.

use crate::control::Setpoint;
use crate::math::Quaternion;
use crate::units::{Position, Velocity};

/// Position and attitude from outside: a motion capture, a companion computer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExternalPose {
    /// Position in the local frame.
    pub position: Position,
    /// Velocity in the local frame.
    pub velocity: Velocity,
    /// Attitude, where the sender gives one.
    pub attitude: Option<Quaternion>,
}

/// What a peer may tell the autopilot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message {
    /// The peer is alive (HEARTBEAT).
    Heartbeat,
    /// What to fly (SET_ATTITUDE_TARGET).
    Setpoint(Setpoint),
    /// Arm, or disarm (COMMAND_LONG, MAV_CMD_COMPONENT_ARM_DISARM).
    Arm(bool),
    /// Where the drone is (ODOMETRY).
    Pose(ExternalPose),
}

impl Message {
    /// False where some value is no number; quaternions and thrusts always are.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Heartbeat | Self::Arm(_) => true,
            Self::Setpoint(setpoint) => setpoint.rates.is_finite(),
            Self::Pose(pose) => pose.position.is_finite() && pose.velocity.is_finite(),
        }
    }
}

/// The answer to an arm or disarm command (MAV_RESULT in COMMAND_ACK).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Answer {
    /// Done.
    Accepted,
    /// Not now: the reason is in the log. The peer may ask again.
    TemporarilyRejected,
    /// Never: the command is not one of ours.
    Unsupported,
}
