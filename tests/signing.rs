//! Signed frames of other programs are obeyed, and ours are believed by them.

use std::env;
use std::io::Write;
use std::process::{Command, Stdio};

use mavlink::dialects::common::{
    COMMAND_LONG_DATA, HEARTBEAT_DATA, MavCmd, MavMessage, SET_ATTITUDE_TARGET_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, SigningConfig, SigningData};
use reflex::link::{
    ArmCommand, Incoming, Message, Notice, Parser, Sender, Severity, SigningKey, Status,
};
use reflex::time::{Instant, at_micros};

/// As in `signing/peer.py`.
const SECRET: [u8; 32] = *b"an orange parrot on a blue drone";
const STAMP: u64 = 36_000_000_000_000;

const NOW: Instant = at_micros(1_000_000);

fn with_key() -> Parser {
    let mut parser = Parser::new();
    let key = SigningKey::new(SECRET, STAMP).expect("48 bits");
    parser.signing().set(NOW, key);
    parser
}

fn read(parser: &mut Parser, bytes: &[u8]) -> Vec<Message> {
    let found = parser.feed(NOW, bytes).map(|incoming| match incoming {
        Incoming::Message { message, .. } => message,
        other => panic!("{other:?}"),
    });
    found.collect()
}

/// Frames are obeyed once; altered they do nothing, and everything is counted.
fn are_obeyed_once(frames: &[Vec<u8>]) {
    let mut parser = with_key();
    for frame in frames {
        for place in frame.len() - 13..frame.len() {
            let mut altered = frame.clone();
            altered[place] ^= 0x10;
            assert_eq!(read(&mut parser, &altered), [], "altered at {place}");
        }
    }
    let spoilt = parser.counters();
    let all = 13 * frames.len() as u32;
    assert_eq!(spoilt.bad_signature + spoilt.old_stamp, all);
    for frame in frames {
        assert_eq!(read(&mut parser, frame).len(), 1);
    }
    for frame in frames {
        assert_eq!(read(&mut parser, frame), [], "replayed");
    }
    assert_eq!(
        parser.counters().old_stamp,
        spoilt.old_stamp + frames.len() as u32
    );
}

/// A heartbeat, an answer and a notice, signed.
fn ours() -> Vec<Vec<u8>> {
    let (mut parser, mut sender) = (with_key(), Sender::new(4));
    let to = reflex::link::Peer {
        system: 255,
        component: 190,
    };
    let frames = [
        sender.heartbeat(true, Status::Active),
        sender.command_ack(to, 400, reflex::link::Answer::Denied),
        sender.notice(&Notice::new(Severity::Warning, "too hot", "land")),
    ];
    let signed = frames.into_iter().map(|mut frame| {
        parser.signing().sign(NOW, &mut frame);
        frame.as_bytes().to_vec()
    });
    signed.collect()
}

/// The crate's own, as of today: its stamps come from the computer's clock.
fn of_the_crate() -> SigningData {
    SigningData::from_config(SigningConfig::new(SECRET, 3, true, false))
}

fn raw(bytes: &[u8]) -> MAVLinkV2MessageRaw {
    let mut whole = [0; mavlink::consts::MAX_FRAME_SIZE];
    whole[..bytes.len()].copy_from_slice(bytes);
    MAVLinkV2MessageRaw::from_bytes_unparsed(whole)
}

#[test]
fn frames_signed_by_the_crate_are_obeyed_once() {
    let data = of_the_crate();
    let messages = [
        MavMessage::HEARTBEAT(HEARTBEAT_DATA::default()),
        MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            param1: 1.0,
            command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
            target_system: 1,
            ..COMMAND_LONG_DATA::default()
        }),
        MavMessage::SET_ATTITUDE_TARGET(SET_ATTITUDE_TARGET_DATA {
            q: [1.0, 0.0, 0.0, 0.0],
            target_system: 1,
            ..SET_ATTITUDE_TARGET_DATA::default()
        }),
    ];
    let frames = messages.map(|message| {
        let mut frame = MAVLinkV2MessageRaw::new();
        frame.serialize_message_for_signing(MavHeader::default(), &message);
        data.sign_message(&mut frame);
        frame.raw_bytes().to_vec()
    });
    are_obeyed_once(&frames);
}

#[test]
fn frames_of_ours_have_the_signature_that_the_crate_computes() {
    for bytes in ours() {
        let frame = raw(&bytes);
        assert!(frame.has_valid_crc::<MavMessage>());
        let mut expected = [0; 6];
        frame.calculate_signature(&SECRET, &mut expected);
        assert_eq!(frame.signature_value(), expected);
        assert!(frame.signature_timestamp() >= STAMP);
    }
}

/// What `signing/peer.py` prints; `None` where pymavlink is missing.
///
/// Continuous integration installs it and says so: there its absence is a failure.
fn pymavlink(task: &str, input: &str) -> Option<Vec<String>> {
    let python = env::var("REFLEX_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let found = Command::new(&python)
        .args(["-c", "import pymavlink"])
        .output();
    if !found.is_ok_and(|found| found.status.success()) {
        assert!(env::var_os("CI").is_none(), "{python} lacks pymavlink");
        eprintln!(
            "skipped: {python} lacks pymavlink, see .ci/python.txt; REFLEX_PYTHON names another"
        );
        return None;
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/signing/peer.py");
    let mut peer = Command::new(python)
        .args([script, task])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("started before");
    let mut stdin = peer.stdin.take().expect("piped");
    stdin.write_all(input.as_bytes()).expect("it reads");
    drop(stdin);
    let output = peer.wait_with_output().expect("it ends");
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).expect("hex and names");
    Some(text.lines().map(str::to_owned).collect())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn of_hex(line: &String) -> Vec<u8> {
    let pairs = line.as_bytes().chunks(2);
    pairs
        .map(|pair| {
            let digits = str::from_utf8(pair).expect("ASCII");
            u8::from_str_radix(digits, 16).expect("hex")
        })
        .collect()
}

#[test]
fn frames_signed_by_pymavlink_are_obeyed_once() {
    let Some(lines) = pymavlink("sign", "") else {
        return;
    };
    let frames: Vec<Vec<u8>> = lines.iter().map(of_hex).collect();
    are_obeyed_once(&frames);
    let found = read(&mut with_key(), &frames.concat());
    assert_eq!(found.len(), 5);
    assert_eq!(found[0], Message::Heartbeat);
    assert_eq!(found[1], Message::Arm(ArmCommand::ARM));
    assert!(matches!(found[2], Message::Setpoint(_)));
    assert!(matches!(found[3], Message::Pose(_)));
    assert_eq!(found[4], Message::Arm(ArmCommand::DISARM));
}

#[test]
fn frames_of_ours_are_believed_by_pymavlink_once_and_altered_ones_never() {
    let frames = ours();
    let mut altered = frames[0].clone();
    *altered.last_mut().expect("some") ^= 1;
    let mut lines: Vec<String> = frames.iter().map(|frame| hex(frame)).collect();
    lines.extend([hex(&frames[2]), hex(&altered)]);
    let Some(read) = pymavlink("check", &lines.join("\n")) else {
        return;
    };
    let expected = [
        "HEARTBEAT",
        "COMMAND_ACK",
        "STATUSTEXT",
        "BAD_DATA",
        "BAD_DATA",
    ];
    assert_eq!(read, expected);
}
