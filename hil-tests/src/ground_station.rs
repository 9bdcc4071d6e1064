//! What a ground station sends, as MAVLink 2 frames.

use mavlink::dialects::common::{
    COMMAND_LONG_DATA, HEARTBEAT_DATA, MavAutopilot, MavCmd, MavFrame, MavMessage, MavModeFlag,
    MavState, MavType, ODOMETRY_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader};
use recorded_flights::Sighting;

/// A frame and the virtual time at which its first byte is sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkFrame {
    /// Virtual time, ns.
    pub at_ns: u64,
    /// The whole frame.
    pub bytes: Vec<u8>,
}

/// Nanoseconds of a millisecond.
pub const MILLISECOND_NS: u64 = 1_000_000;
/// Between two heartbeats, ns.
pub const HEARTBEAT_PERIOD_NS: u64 = 1000 * MILLISECOND_NS;
/// How long before a flight the drone is told to arm, ns: in case that it missed a frame.
pub const ARM_LEADS_NS: [u64; 4] = [
    200 * MILLISECOND_NS,
    150 * MILLISECOND_NS,
    100 * MILLISECOND_NS,
    50 * MILLISECOND_NS,
];

/// The ground station's identity.
const GROUND_STATION: (u32, u8) = (255, 190);
/// The drone's identity: system 1, component 1 (the autopilot).
pub const DRONE: (u8, u8) = (1, 1);

/// A message as bytes.
pub fn frame(message: &MavMessage, sequence: u8) -> Vec<u8> {
    let (system_id, component_id) = GROUND_STATION;
    let header = MavHeader {
        system_id,
        component_id,
        sequence,
    };
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message(header, message);
    raw.raw_bytes().to_vec()
}

/// The ground station is there.
pub fn heartbeat() -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        custom_mode: 0,
        mavtype: MavType::MAV_TYPE_GCS,
        autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
        base_mode: MavModeFlag::empty(),
        system_status: MavState::MAV_STATE_ACTIVE,
        mavlink_version: 3,
    })
}

/// Arms the motors.
pub fn arm(confirmation: u8) -> MavMessage {
    MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        param1: 1.0,
        command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        target_system: DRONE.0,
        target_component: DRONE.1,
        confirmation,
        ..COMMAND_LONG_DATA::DEFAULT
    })
}

/// Where the drone is, as somebody beside it sees it; axes as `frame` says.
pub fn odometry(at_ns: u64, frame: MavFrame, seen: &Sighting) -> MavMessage {
    let [x, y, z] = seen.position.map(|c| c as f32);
    let [vx, vy, vz] = seen.velocity.map(|c| c as f32);
    let [rollspeed, pitchspeed, yawspeed] = seen.rates.map(|rate| rate as f32);
    // MAVLink writes NaN first where a covariance or attitude is unknown.
    let mut unknown = [0.0; 21];
    unknown[0] = f32::NAN;
    MavMessage::ODOMETRY(ODOMETRY_DATA {
        time_usec: at_ns / 1000,
        x,
        y,
        z,
        q: seen.attitude.map_or([f32::NAN; 4], |q| q.map(|c| c as f32)),
        vx,
        vy,
        vz,
        rollspeed,
        pitchspeed,
        yawspeed,
        pose_covariance: unknown,
        velocity_covariance: unknown,
        frame_id: frame,
        child_frame_id: frame,
    })
}
