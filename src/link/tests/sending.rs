//! What we send, read by the crate.

use super::*;
use mavlink::MavlinkVersion;
use mavlink::dialects::common::{
    COMMAND_ACK_DATA, MavAutopilot, MavModeFlag, MavResult, MavSeverity, MavState, MavType,
    STATUSTEXT_DATA,
};

/// The content of a frame of ours, checked; its sequence number.
fn content<M: MessageData>(frame: &Frame) -> (M, u8) {
    let mut bytes = [0; mavlink::consts::MAX_FRAME_SIZE];
    bytes[..frame.as_bytes().len()].copy_from_slice(frame.as_bytes());
    let raw = MAVLinkV2MessageRaw::from_bytes_unparsed(bytes);
    assert!(raw.has_valid_crc_with_extra_crc(M::EXTRA_CRC));
    assert_eq!(raw.message_id(), M::ID);
    assert_eq!((raw.system_id(), raw.component_id()), (1, 1));
    assert_eq!(
        frame.as_bytes().len(),
        12 + usize::from(raw.payload_length())
    );
    let content = M::deser(MavlinkVersion::V2, raw.payload()).expect("readable");
    (content, raw.sequence())
}

fn heartbeat(motors: usize, armed: bool, status: Status) -> HEARTBEAT_DATA {
    content(&Sender::new(motors).heartbeat(armed, status)).0
}

#[test]
fn a_heartbeat_tells_kind_arming_and_status() {
    let armed = heartbeat(4, true, Status::Active);
    assert_eq!(armed.mavtype, MavType::MAV_TYPE_QUADROTOR);
    assert_eq!(armed.autopilot, MavAutopilot::MAV_AUTOPILOT_GENERIC);
    assert_eq!(armed.base_mode, MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
    assert_eq!(armed.system_status, MavState::MAV_STATE_ACTIVE);
    assert_eq!(armed.mavlink_version, 3);
    let standby = heartbeat(4, false, Status::Standby);
    assert_eq!(standby.base_mode, MavModeFlag::empty());
    assert_eq!(standby.system_status, MavState::MAV_STATE_STANDBY);
}

#[test]
fn a_heartbeat_is_byte_for_byte_what_the_crate_sends() {
    let frame = Sender::new(4).heartbeat(true, Status::Active);
    let header = MavHeader {
        system_id: SYSTEM.into(),
        component_id: COMPONENT,
        sequence: 0,
    };
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message_data(header, &heartbeat(4, true, Status::Active));
    assert_eq!(frame.as_bytes(), &raw.as_slice()[..frame.as_bytes().len()]);
}

#[test]
fn a_heartbeat_names_the_airframe_by_its_motors() {
    let kind = |motors| heartbeat(motors, false, Status::Standby).mavtype;
    assert_eq!(kind(5), MavType::MAV_TYPE_GENERIC_MULTIROTOR);
    assert_eq!(kind(6), MavType::MAV_TYPE_HEXAROTOR);
    assert_eq!(kind(7), MavType::MAV_TYPE_GENERIC_MULTIROTOR);
    assert_eq!(kind(8), MavType::MAV_TYPE_OCTOROTOR);
}

#[test]
fn every_answer_has_its_result() {
    for (answer, result) in [
        (Answer::Accepted, MavResult::MAV_RESULT_ACCEPTED),
        (
            Answer::TemporarilyRejected,
            MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
        ),
        (Answer::Denied, MavResult::MAV_RESULT_DENIED),
        (Answer::Unsupported, MavResult::MAV_RESULT_UNSUPPORTED),
    ] {
        let frame = Sender::new(4).command_ack(GROUND, ARM_DISARM, answer);
        let command = MavCmd::MAV_CMD_COMPONENT_ARM_DISARM;
        assert_eq!(content(&frame), (COMMAND_ACK_DATA { command, result }, 0));
    }
}

#[test]
fn an_answer_names_its_peer_and_any_command() {
    let frame = Sender::new(4).command_ack(GROUND, 60_000, Answer::Unsupported);
    let payload = [0x60, 0xEA, 3, 0, 0, 0, 0, 0, 255, 190];
    assert_eq!(frame.as_bytes()[10..20], payload);
    assert_eq!(frame.as_bytes().len(), 12 + payload.len());
}

#[test]
fn a_notice_says_what_happened_and_why_and_how_bad_it_is() {
    let long = "1234567890123456789012345678901234567890";
    let cases = [
        (
            Severity::Emergency,
            MavSeverity::MAV_SEVERITY_EMERGENCY,
            "",
            ": ",
        ),
        (
            Severity::Warning,
            MavSeverity::MAV_SEVERITY_WARNING,
            "tilted",
            "tilted: ",
        ),
        (Severity::Debug, MavSeverity::MAV_SEVERITY_DEBUG, long, long),
    ];
    for (ours, severity, what, line) in cases {
        let frame = Sender::new(4).notice(&Notice::new(ours, what, ""));
        assert!(frame.as_bytes().len() <= LONGEST_FRAME_OUT);
        let told = content::<STATUSTEXT_DATA>(&frame).0;
        assert_eq!(told.severity, severity);
        assert!(
            told.text
                .to_str()
                .is_ok_and(|text| text.starts_with(line.trim_end()))
        );
    }
}

#[test]
fn a_notice_that_is_too_long_is_cut_off() {
    let letters = "123456789012345678901234567890";
    let frame = Sender::new(4).notice(&Notice::new(Severity::Info, letters, letters));
    let told = content::<STATUSTEXT_DATA>(&frame).0;
    assert_eq!(
        told.text.to_str(),
        Ok(&*format!("{letters}: {letters}")[..Notice::LONGEST].to_owned())
    );
}

#[test]
fn frames_are_numbered_and_the_number_wraps() {
    let mut sender = Sender::new(4);
    for sequence in (0..=255_u8).chain(0..3) {
        let frame = if sequence % 2 == 0 {
            sender.heartbeat(false, Status::Calibrating)
        } else {
            sender.command_ack(GROUND, ARM_DISARM, Answer::Accepted)
        };
        assert_eq!(frame.as_bytes()[4], sequence);
    }
}

#[test]
fn our_own_echo_is_ignored() {
    let frame = Sender::new(4).heartbeat(true, Status::Active);
    let (found, counters) = read(frame.as_bytes());
    assert_eq!((found.len(), counters.not_for_us), (0, 1));
}
