//! What the ground station sends during a replay, as MAVLink 2 frames.
//!
//! | message | when |
//! |---|---|
//! | HEARTBEAT | every second from the start |
//! | SET_ATTITUDE_TARGET | 50 Hz, from 0.3 s before the flight: attitude, rates (see `ignored`) and thrust |
//! | COMMAND_LONG, arm | 0.2, 0.15, 0.1 and 0.05 s before the flight |
//! | ODOMETRY | 10 Hz in flight, where the log has a valid position |

use mavlink::dialects::common::{
    AttitudeTargetTypemask, COMMAND_LONG_DATA, HEARTBEAT_DATA, MavAutopilot, MavCmd, MavFrame,
    MavMessage, MavModeFlag, MavState, MavType, ODOMETRY_DATA, SET_ATTITUDE_TARGET_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader};
use nalgebra::Vector3;

use super::flight::Flight;
use super::quaternion::{about_down, continuous, from_array, to_array};
use super::setpoint::{SetpointSource, SetpointSources, Setpoints};
use super::stimulus::Bench;
use super::track::{Cursor, Track};

/// A frame and the virtual time at which its first byte is sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkFrame {
    /// Virtual time, ns.
    pub at_ns: u64,
    /// The whole frame.
    pub bytes: Vec<u8>,
}

const MILLISECOND_NS: u64 = 1_000_000;
const HEARTBEAT_PERIOD_NS: u64 = 1000 * MILLISECOND_NS;
const SETPOINT_PERIOD_NS: u64 = 20 * MILLISECOND_NS;
const SETPOINT_LEAD_NS: u64 = 300 * MILLISECOND_NS;
const ARM_LEADS_NS: [u64; 4] = [200, 150, 100, 50];
const ODOMETRY_PERIOD_NS: u64 = 100 * MILLISECOND_NS;
/// A position older than this is not sent again.
const ODOMETRY_STALE_NS: i64 = 250_000_000;

/// The ground station's identity.
const GROUND_STATION: (u32, u8) = (255, 190);
/// The drone's identity: system 1, component 1 (the autopilot).
pub const DRONE: (u8, u8) = (1, 1);

/// All frames of a replay, in order of time, to the end of the flight.
#[must_use]
pub fn schedule(flight: &Flight, setpoints: &Setpoints, bench: Bench) -> Vec<LinkFrame> {
    let start = bench.length_ns();
    let end = start + u64::try_from(flight.duration_ns).unwrap_or_default();
    let mut messages: Vec<(u64, MavMessage)> = Vec::new();
    messages.extend(every(0, end, HEARTBEAT_PERIOD_NS).map(|at| (at, heartbeat())));
    let first = start.saturating_sub(SETPOINT_LEAD_NS);
    messages.extend(
        every(first, end, SETPOINT_PERIOD_NS).map(|at| (at, attitude_target(at, setpoints, bench))),
    );
    messages.extend(ARM_LEADS_NS.iter().zip(0..).map(|(lead, confirmation)| {
        let at = start.saturating_sub(lead * MILLISECOND_NS);
        (at, arm(confirmation))
    }));
    if let Some(position) = &flight.recorded.position {
        let place = Place::new(flight, setpoints, position);
        messages.extend(
            every(start, end, ODOMETRY_PERIOD_NS)
                .filter_map(|at| Some((at, place.odometry(at, bench)?))),
        );
    }
    messages.sort_by_key(|&(at, _)| at);
    messages
        .into_iter()
        .zip((0..=u8::MAX).cycle())
        .map(|((at_ns, message), sequence)| LinkFrame {
            at_ns,
            bytes: frame(&message, sequence),
        })
        .collect()
}

/// Instants from a first to an end, the end included.
fn every(first: u64, end: u64, period: u64) -> impl Iterator<Item = u64> {
    (0..)
        .map(move |step| first + step * period)
        .take_while(move |&at| at <= end)
}

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

/// Which parts of the setpoint the drone shall ignore.
///
/// A recorded rate setpoint is what the log's own attitude loop made of the
/// recorded attitude setpoint. With both, roll and pitch rates would be asked
/// for twice; the yaw rate stands, since it replaces the heading.
fn ignored(sources: SetpointSources) -> AttitudeTargetTypemask {
    let recorded = [sources.attitude, sources.rates] == [SetpointSource::Recorded; 2];
    if recorded {
        AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
            | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
    } else {
        AttitudeTargetTypemask::empty()
    }
}

/// The setpoint at a virtual time.
fn attitude_target(at_ns: u64, setpoints: &Setpoints, bench: Bench) -> MavMessage {
    let setpoint = setpoints.at(bench.log_time_ns(at_ns));
    let [roll, pitch, yaw] = setpoint.rates;
    MavMessage::SET_ATTITUDE_TARGET(SET_ATTITUDE_TARGET_DATA {
        time_boot_ms: (at_ns / MILLISECOND_NS) as u32,
        q: setpoint.attitude.map(|component| component as f32),
        body_roll_rate: roll as f32,
        body_pitch_rate: pitch as f32,
        body_yaw_rate: yaw as f32,
        thrust: setpoint.thrust as f32,
        target_system: DRONE.0,
        target_component: DRONE.1,
        type_mask: ignored(setpoints.sources),
    })
}

/// Where the drone is, as an external observer would report it.
///
/// The frame's x axis is the heading at the start, as for setpoints: not north,
/// so it is MAVLink's LOCAL_FRD.
struct Place<'a> {
    position: &'a Track<6>,
    attitude: Option<Track<4>>,
    gyro: &'a Track<3>,
    cursor: Cursor,
    heading_at_start: f64,
}

impl<'a> Place<'a> {
    fn new(flight: &'a Flight, setpoints: &Setpoints, position: &'a Track<6>) -> Self {
        Self {
            position,
            attitude: flight.recorded.attitude.as_ref().map(continuous),
            gyro: &flight.gyro,
            cursor: Cursor::default(),
            heading_at_start: setpoints.heading_at_start(),
        }
    }

    /// The report at a virtual time; none while the log's position is invalid.
    fn odometry(&self, at_ns: u64, bench: Bench) -> Option<MavMessage> {
        let time = bench.log_time_ns(at_ns);
        let (measured, [x, y, z, vx, vy, vz]) = self.position.latest(time)?;
        if time - measured > ODOMETRY_STALE_NS {
            return None;
        }
        let turn = about_down(-self.heading_at_start);
        let position = (turn * Vector3::new(x, y, z)).map(|c| c as f32);
        let velocity = (turn * Vector3::new(vx, vy, vz)).map(|c| c as f32);
        let attitude = self.attitude.as_ref().and_then(|track| track.at(time));
        let attitude = attitude.map(|q| to_array(turn * from_array(q)));
        let rates = self.gyro.at_cursor(time, &self.cursor).unwrap_or_default();
        let [rollspeed, pitchspeed, yawspeed] = rates.map(|rate| rate as f32);
        // MAVLink writes NaN first where a covariance or attitude is unknown.
        let mut unknown = [0.0; 21];
        unknown[0] = f32::NAN;
        Some(MavMessage::ODOMETRY(ODOMETRY_DATA {
            time_usec: at_ns / 1000,
            x: position.x,
            y: position.y,
            z: position.z,
            q: attitude.map_or([f32::NAN; 4], |q| q.map(|c| c as f32)),
            vx: velocity.x,
            vy: velocity.y,
            vz: velocity.z,
            rollspeed,
            pitchspeed,
            yawspeed,
            pose_covariance: unknown,
            velocity_covariance: unknown,
            frame_id: MavFrame::MAV_FRAME_LOCAL_FRD,
            child_frame_id: MavFrame::MAV_FRAME_LOCAL_FRD,
        }))
    }
}
