//! Frames of every kind in sequence: skipping, signatures, sequence numbers, time.

use super::*;
use crate::time::micros;
use mavlink::dialects::common::ATTITUDE_DATA;

fn with_signature(mut frame: Vec<u8>, extra: u8) -> Vec<u8> {
    frame[2] = 1;
    seal(&mut frame, extra);
    frame.extend([0xFD; 13]);
    frame
}

fn heartbeat(sequence: u8) -> Vec<u8> {
    frame(sequence, &HEARTBEAT_DATA::DEFAULT)
}

#[test]
fn all_messages_in_one_piece_are_read_in_order() {
    let bytes = all_frames().concat();
    let (found, counters) = read(&bytes);
    assert_eq!(found.len(), all_frames().len());
    assert!(matches!(
        found[2],
        Incoming::Message {
            message: Message::Arm(ArmCommand::ARM),
            ..
        }
    ));
    assert_eq!(
        counters,
        LinkCounters {
            frames: all_frames().len() as u32,
            ..LinkCounters::default()
        }
    );
}

#[test]
fn without_a_key_signatures_are_not_looked_at() {
    let mut bytes = with_signature(heartbeat(0), HEARTBEAT_DATA::EXTRA_CRC);
    bytes.extend(with_signature(
        frame(1, &odometry()),
        ODOMETRY_DATA::EXTRA_CRC,
    ));
    bytes.extend(frame(2, &arm_command(0.0)));
    let (found, counters) = read(&bytes);
    assert_eq!(found.len(), 3);
    assert_eq!(
        counters,
        LinkCounters {
            frames: 3,
            ..LinkCounters::default()
        }
    );
}

#[test]
fn the_longest_frame_fits_and_extensions_not_known_yet_are_ignored() {
    let mut bytes = frame(0, &odometry());
    bytes.truncate(10 + 230);
    bytes.resize(10 + 255, 7);
    bytes.extend([0, 0]);
    bytes[1] = 255;
    let bytes = with_signature(bytes, ODOMETRY_DATA::EXTRA_CRC);
    assert_eq!(bytes.len(), 280);
    assert_eq!(read(&bytes.repeat(3)).0.len(), 3);
}

#[test]
fn other_flags_refuse_the_frame() {
    for flags in 2..=255 {
        let mut bytes = frame(0, &arm_command(1.0));
        bytes[2] = flags;
        seal(&mut bytes, COMMAND_LONG_DATA::EXTRA_CRC);
        let (found, counters) = read(&bytes);
        assert_eq!((found.len(), counters.frames), (0, 0));
        assert!(counters.bad_flags >= 1);
    }
}

#[test]
fn a_frame_without_payload_is_refused() {
    for (id, extra) in [
        (0, HEARTBEAT_DATA::EXTRA_CRC),
        (76, COMMAND_LONG_DATA::EXTRA_CRC),
    ] {
        let mut bytes = [0xFD, 0, 0, 0, 0, 255, 190, id, 0, 0, 0, 0];
        seal(&mut bytes, extra);
        let (found, counters) = read(&bytes);
        assert_eq!(
            (found.len(), counters.frames, counters.bad_length),
            (0, 1, 1)
        );
    }
}

#[test]
fn frames_of_other_messages_are_skipped_with_all_that_they_quote() {
    let mut bytes = frame(0, &ATTITUDE_DATA::DEFAULT);
    // A frame of another kind with an order to arm as its payload.
    let arm = frame(1, &arm_command(1.0));
    bytes.extend([0xFD, arm.len() as u8, 0, 0, 1, 255, 190, 110, 0, 0]);
    bytes.extend(arm);
    bytes.extend([0, 0]);
    bytes.extend(heartbeat(2));
    let (found, counters) = read(&bytes);
    assert!(matches!(
        found[..],
        [Incoming::Message {
            message: Message::Heartbeat,
            ..
        }]
    ));
    assert_eq!((counters.unknown_message, counters.garbage_bytes), (2, 0));
}

#[test]
fn mavlink_1_frames_are_skipped_and_counted() {
    let quoted = frame(0, &arm_command(1.0));
    let mut bytes = std::vec![0xFE, quoted.len() as u8, 0, 255, 190, 76];
    bytes.extend(quoted);
    bytes.extend([0, 0]);
    bytes.extend([0xFE, 0, 0, 255, 190, 0, 0, 0]);
    bytes.extend(heartbeat(1));
    let (found, counters) = read(&bytes);
    assert!(matches!(
        found[..],
        [Incoming::Message {
            message: Message::Heartbeat,
            ..
        }]
    ));
    assert_eq!((counters.version_1, counters.garbage_bytes), (2, 0));
}

#[test]
fn lost_frames_are_counted_for_each_sender() {
    let mut bytes = [heartbeat(250), heartbeat(251), heartbeat(255), heartbeat(2)].concat();
    let mut other = heartbeat(77);
    other[6] = 9;
    seal(&mut other, HEARTBEAT_DATA::EXTRA_CRC);
    bytes.extend(other);
    bytes.extend(heartbeat(3));
    // Messages that are not used have numbers too.
    bytes.extend(frame(4, &ATTITUDE_DATA::DEFAULT));
    bytes.extend(heartbeat(5));
    assert_eq!(read(&bytes).1.lost_sequence, 3 + 2);
}

#[test]
fn more_senders_than_are_followed_are_read_all_the_same() {
    let mut parser = Parser::new();
    for sender in 2..=255 {
        let mut bytes = heartbeat(sender);
        bytes[5] = sender;
        seal(&mut bytes, HEARTBEAT_DATA::EXTRA_CRC);
        assert_eq!(parser.feed(NOW, &bytes).count(), 1);
    }
    assert_eq!(parser.counters().lost_sequence, 0);
}

#[test]
fn a_frame_that_takes_too_long_is_dropped_and_the_next_is_read() {
    let arm = frame(0, &arm_command(1.0));
    let (begin, end) = arm.split_at(20);
    let mut parser = Parser::new();
    assert_eq!(parser.feed(NOW, begin).count(), 0);
    assert_eq!(parser.feed(NOW + PATIENCE + micros(1), end).count(), 0);
    assert_eq!(parser.counters().truncated, 1);
    assert_eq!(
        parser
            .feed(NOW + PATIENCE + micros(2), &heartbeat(1))
            .count(),
        1
    );
}

#[test]
fn a_frame_in_two_pieces_just_in_time_is_read() {
    let arm = frame(0, &arm_command(1.0));
    let (begin, end) = arm.split_at(20);
    let mut parser = Parser::new();
    // The patience is counted from the frame's own first byte.
    assert_eq!(parser.feed(NOW - PATIENCE, &heartbeat(0)[..20]).count(), 0);
    let piece = [&heartbeat(0)[20..], begin].concat();
    assert_eq!(parser.feed(NOW, &piece).count(), 1);
    assert_eq!(parser.feed(NOW + PATIENCE, end).count(), 1);
    assert_eq!(parser.counters().truncated, 0);
}

#[test]
fn stamps_that_go_back_do_no_harm() {
    let arm = frame(0, &arm_command(1.0));
    let (begin, end) = arm.split_at(20);
    let mut parser = Parser::new();
    assert_eq!(parser.feed(NOW, begin).count(), 0);
    assert_eq!(parser.feed(at_micros(0), end).count(), 1);
}

#[test]
fn the_parser_stays_small() {
    assert!(size_of::<Parser>() <= 640, "{}", size_of::<Parser>());
}
