//! The frames of a replay, read back with the crate that users would use.

use mavlink::dialects::common::{MavCmd, MavMessage};
use mavlink::{MAVLinkV2MessageRaw, MavlinkVersion, Message};

use super::samples::{flight, hover};
use super::ulog_bytes::{Ulog, level_flight};
use recorded_flights::{Bench, Flight, LinkFrame, Rotate, Setpoints, schedule};

const START_NS: u64 = 1_500_000_000;

fn frames(flight: &Flight) -> Vec<LinkFrame> {
    schedule(flight, &Setpoints::of(flight), Bench::default())
}

/// A frame's sender, sequence number and message, checksum checked.
fn decoded(frame: &LinkFrame) -> (u32, u8, MavMessage) {
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.as_mut_slice()[..frame.bytes.len()].copy_from_slice(&frame.bytes);
    assert!(raw.has_valid_crc::<MavMessage>());
    let message = MavMessage::parse(MavlinkVersion::V2, raw.message_id(), raw.payload());
    let message = message.expect("a known message");
    (raw.system_id(), raw.sequence(), message)
}

fn times(frames: &[LinkFrame], is_wanted: impl Fn(&MavMessage) -> bool) -> Vec<u64> {
    let wanted = |frame: &&LinkFrame| is_wanted(&decoded(frame).2);
    frames.iter().filter(wanted).map(|f| f.at_ns).collect()
}

#[test]
fn the_drone_is_armed_before_the_flight_starts() {
    let arming = times(&frames(&hover()), |message| {
        matches!(message, MavMessage::COMMAND_LONG(c)
            if c.command == MavCmd::MAV_CMD_COMPONENT_ARM_DISARM && c.param1 == 1.0)
    });
    let before: Vec<u64> = arming
        .iter()
        .map(|at| (START_NS - at) / 1_000_000)
        .collect();
    assert_eq!(before, [200, 150, 100, 50]);
}

#[test]
fn setpoints_come_at_fifty_hertz_and_heartbeats_every_second() {
    let frames = frames(&hover());
    let setpoints = times(&frames, |m| matches!(m, MavMessage::SET_ATTITUDE_TARGET(_)));
    assert_eq!(setpoints[0], START_NS - 300_000_000);
    assert!(
        setpoints
            .windows(2)
            .all(|pair| pair[1] - pair[0] == 20_000_000)
    );
    assert_eq!(setpoints.last(), Some(&(START_NS + 3_000_000_000)));
    let heartbeats = times(&frames, |m| matches!(m, MavMessage::HEARTBEAT(_)));
    assert_eq!(heartbeats[..3], [0, 1_000_000_000, 2_000_000_000]);
}

#[test]
fn frames_are_in_order_and_numbered_without_a_hole() {
    let frames = frames(&hover());
    assert!(frames.windows(2).all(|pair| pair[0].at_ns <= pair[1].at_ns));
    for (frame, number) in frames.iter().zip((0..=u8::MAX).cycle()) {
        let (system, sequence, _) = decoded(frame);
        assert_eq!((system, sequence), (255, number));
    }
}

#[test]
fn a_setpoint_says_what_the_flight_did() {
    let turning = flight(4.0, |_| ([0.0, 0.0, 0.5], [0.0, 0.0, -9.806_65]));
    let frames = frames(&turning);
    let last = frames
        .iter()
        .rev()
        .find_map(|frame| match decoded(frame).2 {
            MavMessage::SET_ATTITUDE_TARGET(target) => Some(target),
            _ => None,
        });
    let target = last.expect("a setpoint");
    assert!(target.type_mask.is_empty());
    assert_eq!((target.target_system, target.target_component), (1, 1));
    assert!((target.body_yaw_rate - 0.5).abs() < 1e-6);
    assert_eq!(target.thrust, 0.5);
    assert_eq!(target.time_boot_ms, 5500);
    let norm: f32 = target.q.iter().map(|c| c * c).sum();
    assert!((norm - 1.0).abs() < 1e-5);
}

#[test]
fn recorded_roll_and_pitch_rates_are_not_asked_for_twice() {
    let flight = super::setpoints::with_setpoints(0.6);
    let masks: Vec<u8> = frames(&flight)
        .iter()
        .filter_map(|frame| match decoded(frame).2 {
            MavMessage::SET_ATTITUDE_TARGET(target) => Some(target.type_mask.bits()),
            _ => None,
        })
        .collect();
    assert!(
        !masks.is_empty() && masks.iter().all(|&mask| mask == 0b11),
        "{masks:?}"
    );
}

#[test]
fn position_is_sent_only_where_the_log_has_a_valid_one() {
    assert!(times(&frames(&hover()), is_odometry).is_empty());
    let mut log = Ulog::new();
    level_flight(&mut log);
    log.topic(
        "vehicle_local_position",
        "uint64_t timestamp;float x;float y;float z;float vx;float vy;float vz;\
         bool xy_valid;bool z_valid;bool v_xy_valid;bool v_z_valid;",
    );
    for step in 0..20_u64 {
        let valid = u8::from(step < 10);
        log.data(
            "vehicle_local_position",
            1_000_000 + step * 100_000,
            |data| {
                for value in [1.0_f32, 2.0, -3.0, 0.1, 0.2, 0.3] {
                    data.extend(value.to_le_bytes());
                }
                data.extend([valid; 4]);
            },
        );
    }
    let flight = Flight::of_bytes("log".to_owned(), &log.bytes, Rotate::Auto).expect("a good log");
    let frames = frames(&flight);
    let sent = times(&frames, is_odometry);
    assert_eq!(sent.first(), Some(&START_NS));
    assert!(
        sent.last().is_some_and(|&at| at < START_NS + 1_200_000_000),
        "{sent:?}"
    );
    let first = frames
        .iter()
        .map(|frame| decoded(frame).2)
        .find(is_odometry);
    let Some(MavMessage::ODOMETRY(odometry)) = first else {
        panic!("an odometry frame");
    };
    assert_eq!([odometry.x, odometry.y, odometry.z], [1.0, 2.0, -3.0]);
    assert_eq!([odometry.vx, odometry.vy, odometry.vz], [0.1, 0.2, 0.3]);
}

fn is_odometry(message: &MavMessage) -> bool {
    matches!(message, MavMessage::ODOMETRY(_))
}
