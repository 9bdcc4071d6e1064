//! The messages that the link brings to the autopilot, decoded and checked.

use super::{ARM_DISARM, CALIBRATE, MOTOR_TEST, STORE};
use crate::control::{Goal, MotorTest, Setpoint};
use crate::math::Quaternion;
use crate::numbered::numbered;
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
    /// How often the sender moved its frame, having found out that it was wrong; wraps.
    pub reset_counter: u8,
}

/// A place to fly to; as a [`Goal`], but for the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Destination {
    /// Where to, in the local north-east-down frame.
    pub position: Position,
    /// Velocity with which the place itself moves; zero where the sender gives none.
    pub velocity: Velocity,
    /// Heading in rad within -pi to pi, where the sender gives one.
    pub heading: Option<f32>,
}

impl Destination {
    /// The goal, with a heading (rad) to hold where the sender gives none.
    #[must_use]
    pub fn goal(&self, heading: f32) -> Goal {
        Goal {
            position: self.position,
            velocity: self.velocity,
            heading: self.heading.unwrap_or(heading),
        }
    }
}

/// What a command to arm or to disarm says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArmCommand {
    /// Arm; else disarm.
    pub arm: bool,
    /// Disarm in the air, too (`param2` is 21196); an arm command is never forced.
    pub force: bool,
}

impl ArmCommand {
    /// Arm, if the checks allow it.
    pub const ARM: Self = Self {
        arm: true,
        force: false,
    };

    /// Disarm, on the ground.
    pub const DISARM: Self = Self {
        arm: false,
        force: false,
    };

    /// Disarm, wherever the drone is.
    pub const FORCED_DISARM: Self = Self {
        arm: false,
        force: true,
    };
}

numbered! {
    /// What is to be calibrated, while the drone stands still.
    Calibrate {
        /// The gyroscope's bias (`param1` is 1).
        Gyroscope,
        /// The accelerometer, of a drone that stands level (`param5` is 2).
        Level,
    }
}

numbered! {
    /// What the store is to do.
    StoreCommand {
        /// Keep every setting in force (`param1` is 1).
        Save,
        /// Forget all settings: from the next start on those of the configuration hold (`param1` is 2).
        Reset,
    }
}

/// What a peer may send to the autopilot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message {
    /// The peer is alive (HEARTBEAT).
    Heartbeat,
    /// What to fly (SET_ATTITUDE_TARGET).
    Setpoint(Setpoint),
    /// Arm, or disarm (COMMAND_LONG or COMMAND_INT, MAV_CMD_COMPONENT_ARM_DISARM).
    Arm(ArmCommand),
    /// Turn one motor of a disarmed drone (MAV_CMD_DO_MOTOR_TEST).
    TestMotor(MotorTest),
    /// Calibrate (MAV_CMD_PREFLIGHT_CALIBRATION).
    Calibrate(Calibrate),
    /// Store settings (MAV_CMD_PREFLIGHT_STORAGE).
    Store(StoreCommand),
    /// Where the drone is (ODOMETRY).
    Pose(ExternalPose),
    /// Where to fly (SET_POSITION_TARGET_LOCAL_NED).
    Goal(Destination),
}

impl Message {
    /// The number of the command (MAV_CMD) that it came as, and is answered as.
    #[must_use]
    pub fn command(&self) -> Option<u16> {
        match self {
            Self::Arm(_) => Some(ARM_DISARM),
            Self::TestMotor(_) => Some(MOTOR_TEST),
            Self::Calibrate(_) => Some(CALIBRATE),
            Self::Store(_) => Some(STORE),
            Self::Heartbeat | Self::Setpoint(_) | Self::Pose(_) | Self::Goal(_) => None,
        }
    }

    /// False where some value is no number; quaternions and thrusts always are.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Heartbeat | Self::Arm(_) | Self::Calibrate(_) | Self::Store(_) => true,
            Self::TestMotor(test) => test.share.is_finite(),
            Self::Setpoint(setpoint) => setpoint.rates.is_finite(),
            Self::Pose(pose) => pose.position.is_finite() && pose.velocity.is_finite(),
            Self::Goal(goal) => {
                goal.position.is_finite()
                    && goal.velocity.is_finite()
                    && goal.heading.is_none_or(f32::is_finite)
            }
        }
    }
}

/// The answer to a command (MAV_RESULT in COMMAND_ACK).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Answer {
    /// Done.
    Accepted,
    /// Not now: the reason is in the log. The peer may ask again.
    TemporarilyRejected,
    /// Not so: a parameter means nothing here.
    Denied,
    /// Never: the command is not one of ours.
    Unsupported,
}
