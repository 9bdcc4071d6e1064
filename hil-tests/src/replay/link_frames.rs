//! What the ground station sends during a replay, as MAVLink 2 frames.
//!
//! | message | when |
//! |---|---|
//! | HEARTBEAT | every second from the start |
//! | SET_ATTITUDE_TARGET | 50 Hz, from 0.3 s before the flight: attitude, rates (see `ignored`), from the flight on thrust |
//! | COMMAND_LONG, arm | 0.2, 0.15, 0.1 and 0.05 s before the flight |
//! | ODOMETRY | 10 Hz in flight, where the log has a valid position |

use mavlink::dialects::common::{
    AttitudeTargetTypemask, MavFrame, MavMessage, SET_ATTITUDE_TARGET_DATA,
};
use recorded_flights::{Flight, SetpointSource, SetpointSources, Setpoints, Sightings, Standstill};

use crate::faults::{BrokenLink, Script};
use crate::ground_station::{
    ARM_LEADS_NS, DRONE, HEARTBEAT_PERIOD_NS, LinkFrame, MILLISECOND_NS, arm, frame, heartbeat,
    odometry,
};

const SETPOINT_PERIOD_NS: u64 = 20 * MILLISECOND_NS;
const SETPOINT_LEAD_NS: u64 = 300 * MILLISECOND_NS;
const ODOMETRY_PERIOD_NS: u64 = 100 * MILLISECOND_NS;
const NOISE_PERIOD_NS: u64 = 10 * MILLISECOND_NS;

/// All frames of a replay, in order of time, to the end of the flight.
#[must_use]
pub(super) fn schedule(
    flight: &Flight,
    setpoints: &Setpoints,
    standstill: Standstill,
    faults: &Script,
) -> Vec<LinkFrame> {
    let start = standstill.length_ns();
    let end = start + u64::try_from(flight.duration_ns).unwrap_or_default();
    let mut messages: Vec<(u64, MavMessage)> = Vec::new();
    messages.extend(every(0, end, HEARTBEAT_PERIOD_NS).map(|at| (at, heartbeat())));
    let first = start.saturating_sub(SETPOINT_LEAD_NS);
    messages.extend(
        every(first, end, SETPOINT_PERIOD_NS)
            .map(|at| (at, attitude_target(at, setpoints, standstill))),
    );
    messages.extend(ARM_LEADS_NS.iter().zip(0..).map(|(lead, confirmation)| {
        let at = start.saturating_sub(*lead);
        (at, arm(confirmation))
    }));
    if let Some(sightings) = Sightings::of(flight, setpoints) {
        messages.extend(every(start, end, ODOMETRY_PERIOD_NS).filter_map(|at| {
            let sighting = sightings.at(standstill.log_time_ns(at))?;
            // The frame's x axis is the heading at the start, as for setpoints: not north.
            Some((at, odometry(at, MavFrame::MAV_FRAME_LOCAL_FRD, &sighting)))
        }));
    }
    messages.sort_by_key(|&(at, _)| at);
    let mut link = BrokenLink::of(faults);
    let sent = messages.into_iter().flat_map(|(at, message)| {
        let times = link.times(at, &message);
        std::iter::repeat_n((at, message), times)
    });
    let mut frames: Vec<LinkFrame> = sent
        .zip((0..=u8::MAX).cycle())
        .map(|((at_ns, message), sequence)| LinkFrame {
            at_ns,
            bytes: frame(&message, sequence),
        })
        .collect();
    if !faults.is_empty() {
        let noise = every(0, end, NOISE_PERIOD_NS).filter_map(|at_ns| {
            let bytes = link.noise(at_ns, (1_000_000_000 / NOISE_PERIOD_NS) as usize)?;
            Some(LinkFrame { at_ns, bytes })
        });
        frames.extend(noise);
        frames.sort_by_key(|frame| frame.at_ns);
    }
    frames
}

/// Instants from a first to an end, the end included.
fn every(first: u64, end: u64, period: u64) -> impl Iterator<Item = u64> {
    (0..)
        .map(move |step| first + step * period)
        .take_while(move |&at| at <= end)
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
fn attitude_target(at_ns: u64, setpoints: &Setpoints, standstill: Standstill) -> MavMessage {
    let setpoint = setpoints.at(standstill.log_time_ns(at_ns));
    let [roll, pitch, yaw] = setpoint.rates;
    MavMessage::SET_ATTITUDE_TARGET(SET_ATTITUDE_TARGET_DATA {
        time_boot_ms: (at_ns / MILLISECOND_NS) as u32,
        q: setpoint.attitude.map(|component| component as f32),
        body_roll_rate: roll as f32,
        body_pitch_rate: pitch as f32,
        body_yaw_rate: yaw as f32,
        // Motors are armed without thrust.
        thrust: if at_ns < standstill.length_ns() {
            0.0
        } else {
            setpoint.thrust as f32
        },
        target_system: DRONE.0,
        target_component: DRONE.1,
        type_mask: ignored(setpoints.sources),
    })
}

#[cfg(test)]
mod tests {
    //! Frames are read back with the crate that users would use.

    use mavlink::dialects::common::MavCmd;
    use mavlink::{MAVLinkV2MessageRaw, MavlinkVersion, Message};
    use recorded_flights::{Recorded, Rotate, Rotation, Track};

    use super::*;

    /// A flight of gyroscope and accelerometer at 200 Hz, not turned.
    fn flight(length_s: u64, [gyro, accel]: [[f64; 3]; 2]) -> Flight {
        let mut text = "t_us,gx,gy,gz,ax,ay,az\n".to_owned();
        let values: Vec<String> = [gyro, accel].concat().iter().map(f64::to_string).collect();
        for sample in 0..=length_s * 200 {
            text += &format!("{},{}\n", sample * 5000, values.join(","));
        }
        let rotate = Rotate::Named(Rotation::NONE);
        Flight::of_bytes("made-up".to_owned(), text.as_bytes(), rotate).expect("a good log")
    }

    /// Three seconds of a drone that hovers.
    fn hover() -> Flight {
        flight(3, [[0.0; 3], [0.0, 0.0, -9.806_65]])
    }

    const START_NS: u64 = 1_500_000_000;

    fn frames(flight: &Flight) -> Vec<LinkFrame> {
        schedule(
            flight,
            &Setpoints::of(flight),
            Standstill::default(),
            &Script::default(),
        )
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
        let turning = flight(4, [[0.0, 0.0, 0.5], [0.0, 0.0, -9.806_65]]);
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
        let mut flight = hover();
        flight.recorded = Recorded {
            attitude: Some(Track::constant([1.0, 0.0, 0.0, 0.0])),
            attitude_setpoint: Some(Track::constant([1.0, 0.0, 0.0, 0.0])),
            rates_setpoint: Some(Track::constant([0.1, 0.2, 0.3])),
            thrust_setpoint: Some(Track::constant([0.6])),
            ..Recorded::default()
        };
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
        let mut position = Track::new();
        for step in 0..10 {
            position.push(step * 100_000_000, [1.0, 2.0, -3.0, 0.1, 0.2, 0.3]);
        }
        let mut flight = hover();
        flight.recorded.position = Some(position);
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
}
