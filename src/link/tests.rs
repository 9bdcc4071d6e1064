//! Frames made by the crate's own serialiser, and every way to spoil them.

use super::*;
use crate::time::{Instant, at_micros};
use mavlink::MessageData;
use mavlink::dialects::common::{
    AttitudeTargetTypemask, COMMAND_INT_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, MavCmd, MavFrame,
    ODOMETRY_DATA, PositionTargetTypemask, SET_ATTITUDE_TARGET_DATA,
    SET_POSITION_TARGET_LOCAL_NED_DATA, SETUP_SIGNING_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, calculate_crc};

extern crate std;
use std::vec::Vec;

mod goals;
mod noise;
mod reading;
mod roles;
mod sending;
mod signing;
mod values;

const GROUND: Peer = Peer {
    system: 255,
    component: 190,
};

const NOW: Instant = at_micros(1_000_000);

/// A frame of `message` from the ground station, as the crate makes it.
fn frame<M: MessageData>(sequence: u8, message: &M) -> Vec<u8> {
    let header = MavHeader {
        system_id: GROUND.system.into(),
        component_id: GROUND.component,
        sequence,
    };
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message_data(header, message);
    let length = 12 + usize::from(raw.payload_length());
    raw.as_slice()[..length].to_vec()
}

/// The checksum of a frame made again after a change; signature left out.
fn seal(frame: &mut [u8], extra: u8) {
    let end = frame.len() - 2;
    let checksum = calculate_crc(&frame[1..end], extra);
    frame[end..].copy_from_slice(&checksum.to_le_bytes());
}

/// What a new parser makes of the bytes.
fn read(bytes: &[u8]) -> (Vec<Incoming>, LinkCounters) {
    let mut parser = Parser::new();
    let found = parser.feed(NOW, bytes).collect();
    (found, parser.counters())
}

/// The one message in a frame with this content, `None` where it is refused.
fn message_of<M: MessageData>(message: &M) -> Option<Message> {
    let (found, counters) = read(&frame(0, message));
    assert_eq!(counters.frames, 1);
    match found[..] {
        [] => {
            assert_eq!(counters.refused_value + counters.not_for_us, 1);
            None
        }
        [Incoming::Message { from, message }] => {
            assert_eq!(from, GROUND);
            assert_eq!(
                counters,
                LinkCounters {
                    frames: 1,
                    ..LinkCounters::default()
                }
            );
            Some(message)
        }
        _ => panic!("{found:?}"),
    }
}

fn attitude_target() -> SET_ATTITUDE_TARGET_DATA {
    SET_ATTITUDE_TARGET_DATA {
        time_boot_ms: 77,
        q: [0.8, 0.0, 0.6, 0.0],
        body_roll_rate: 0.1,
        body_pitch_rate: -0.2,
        body_yaw_rate: 0.3,
        thrust: 0.5,
        target_system: SYSTEM,
        target_component: COMPONENT,
        type_mask: AttitudeTargetTypemask::empty(),
    }
}

fn arm_command(arm: f32) -> COMMAND_LONG_DATA {
    COMMAND_LONG_DATA {
        param1: arm,
        command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        target_system: SYSTEM,
        target_component: COMPONENT,
        confirmation: 1,
        ..COMMAND_LONG_DATA::DEFAULT
    }
}

fn odometry() -> ODOMETRY_DATA {
    ODOMETRY_DATA {
        time_usec: 123_456,
        x: 1.0,
        y: -2.0,
        z: -3.0,
        q: [
            core::f32::consts::FRAC_1_SQRT_2,
            0.0,
            0.0,
            core::f32::consts::FRAC_1_SQRT_2,
        ],
        vx: 4.0,
        vy: 0.5,
        vz: 0.25,
        frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
        child_frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
        ..ODOMETRY_DATA::DEFAULT
    }
}

fn position_target() -> SET_POSITION_TARGET_LOCAL_NED_DATA {
    SET_POSITION_TARGET_LOCAL_NED_DATA {
        time_boot_ms: 77,
        x: 1.0,
        y: -2.0,
        z: -3.0,
        vx: 0.5,
        vy: 0.25,
        vz: -0.125,
        afx: 9.0,
        afy: 9.0,
        afz: 9.0,
        yaw: 0.5,
        yaw_rate: 9.0,
        type_mask: PositionTargetTypemask::from_bits_retain(64 | 128 | 256 | 2048),
        target_system: SYSTEM,
        target_component: COMPONENT,
        coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
    }
}

fn int_command() -> COMMAND_INT_DATA {
    COMMAND_INT_DATA {
        param1: 1.0,
        x: -1,
        command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        target_system: SYSTEM,
        target_component: COMPONENT,
        ..COMMAND_INT_DATA::DEFAULT
    }
}

fn signing_setup() -> SETUP_SIGNING_DATA {
    SETUP_SIGNING_DATA {
        initial_timestamp: 7,
        target_system: SYSTEM,
        target_component: COMPONENT,
        secret_key: [9; 32],
    }
}

/// How many messages are used.
const FRAMES: usize = 7;

/// One frame of every message used.
fn all_frames() -> [Vec<u8>; FRAMES] {
    [
        frame(0, &HEARTBEAT_DATA::DEFAULT),
        frame(1, &attitude_target()),
        frame(2, &arm_command(1.0)),
        frame(3, &odometry()),
        frame(4, &position_target()),
        frame(5, &int_command()),
        frame(6, &signing_setup()),
    ]
}
