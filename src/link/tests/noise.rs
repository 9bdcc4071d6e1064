//! Truncation, flipped bits, garbage, any chunking.

use super::*;
use core::ops::Range;
use proptest::prelude::*;

/// Everything but the counters of noise.
fn messages(bytes: &[u8]) -> Vec<Incoming> {
    read(bytes).0
}

#[test]
fn a_frame_cut_short_at_any_length_brings_nothing() {
    for whole in all_frames() {
        for length in 0..whole.len() {
            let (found, counters) = read(&whole[..length]);
            assert!(found.is_empty());
            assert_eq!(counters, LinkCounters::default());
        }
    }
}

#[test]
fn a_frame_cut_short_at_any_length_does_not_take_the_next_with_it() {
    // Long enough for the longest frame to be completed, and thereby found out.
    let next = [frame(7, &arm_command(0.0)), frame(8, &odometry())].concat();
    let expected = messages(&next);
    for whole in all_frames() {
        for length in 0..whole.len() {
            let bytes = [&whole[..length], &next].concat();
            // Cut within its header, it passes for a frame of another kind, skipped by length.
            let found = messages(&bytes);
            if (3..10).contains(&length) {
                assert!(expected.ends_with(&found), "{length}");
            } else {
                assert_eq!(found, expected, "cut at {length} of {}", whole.len());
            }
        }
    }
}

#[test]
fn a_frame_missing_any_byte_brings_nothing() {
    for whole in all_frames() {
        for missing in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes.remove(missing);
            bytes.extend([0; 300]);
            assert!(messages(&bytes).is_empty(), "{missing}");
        }
    }
}

#[test]
fn a_frame_with_any_bit_flipped_brings_nothing() {
    for whole in all_frames() {
        for bit in 0..8 * whole.len() {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            bytes.extend([0; 300]);
            let (found, counters) = read(&bytes);
            assert!(found.is_empty(), "bit {bit}");
            assert_eq!(counters.frames, 0);
        }
    }
}

#[test]
fn a_frame_with_two_neighbouring_bytes_spoilt_brings_nothing() {
    for whole in all_frames() {
        for place in 0..whole.len() - 1 {
            let mut bytes = whole.clone();
            bytes[place] ^= 0xA5;
            bytes[place + 1] ^= 0x3C;
            bytes.extend([0; 300]);
            assert!(messages(&bytes).is_empty(), "{place}");
        }
    }
}

#[test]
fn starts_of_frames_without_end_are_survived() {
    for pattern in [
        &[0xFD][..],
        &[0xFE],
        &[0xFD, 0xFE],
        &[0xFD, 0xFF, 0],
        &[0xFD, 1, 0, 0, 0, 255, 190, 0, 0, 0],
        &[0xFD, 233, 1, 0, 0, 255, 190, 0x4B, 1, 0],
    ] {
        let mut bytes = pattern.repeat(300);
        bytes.extend([0; 300]);
        bytes.extend(frame(0, &arm_command(1.0)));
        assert_eq!(messages(&bytes).len(), 1, "{pattern:?}");
    }
}

#[test]
fn a_frame_behind_a_flood_of_frames_within_frames_is_read_once_they_have_passed() {
    let mut parser = Parser::new();
    let header = [0xFD, 255, 1, 0, 0, 255, 190, 0x4B, 1, 0];
    for _ in 0..1000 {
        assert_eq!(parser.feed(NOW, &header).count(), 0);
    }
    let counters = parser.counters();
    // Each header is a start, but not each is worth a checksum.
    assert!((20..400).contains(&counters.bad_checksum), "{counters:?}");
    let bytes = [&[0; 300][..], &frame(0, &arm_command(1.0))].concat();
    assert_eq!(parser.feed(NOW, &bytes).count(), 1);
}

#[test]
fn every_byte_is_accounted_for() {
    let bytes = [
        &[1, 2, 3][..],
        &frame(0, &arm_command(1.0)),
        &[0xFD, 9, 8],
        &[0xFE, 0, 0, 0, 0, 0, 0, 0],
    ]
    .concat();
    let (_, counters) = read(&bytes);
    let expected = LinkCounters {
        frames: 1,
        bad_flags: 1,
        version_1: 1,
        garbage_bytes: 6,
        ..LinkCounters::default()
    };
    assert_eq!(counters, expected);
}

/// A piece of a stream: a whole frame, part of one, or noise rich in starts of frames.
fn piece() -> impl Strategy<Value = Vec<u8>> {
    let whole = (0..FRAMES).prop_map(|which| all_frames()[which].clone());
    let part = (0..FRAMES, 0..260_usize).prop_map(|(which, length)| {
        let mut bytes = all_frames()[which].clone();
        bytes.truncate(length);
        bytes
    });
    let byte = prop_oneof![4 => any::<u8>(), 1 => Just(0xFD), 1 => Just(0xFE), 1 => Just(0)];
    let noise = proptest::collection::vec(byte, 0..60);
    prop_oneof![3 => whole, 1 => part, 2 => noise]
}

fn stream() -> impl Strategy<Value = Vec<u8>> {
    proptest::collection::vec(piece(), 0..12).prop_map(|pieces| pieces.concat())
}

/// Lengths of chunks, each with the pause before it in ms.
fn chunks(pauses: Range<u64>) -> impl Strategy<Value = Vec<(usize, u64)>> {
    proptest::collection::vec((1..40_usize, pauses), 1..20)
}

/// What a new parser makes of bytes that come in such chunks, over and over, and are fed in
/// pieces of so many bytes at most.
fn read_in_chunks(
    mut bytes: &[u8],
    chunks: &[(usize, u64)],
    most: usize,
) -> (Vec<Incoming>, LinkCounters) {
    let (mut parser, mut found, mut at) = (Parser::new(), Vec::new(), NOW);
    for (length, pause) in chunks.iter().cycle() {
        let (chunk, behind) = bytes.split_at(bytes.len().min(*length));
        if chunk.is_empty() {
            break;
        }
        at += crate::time::micros(1000 * pause);
        for piece in chunk.chunks(most) {
            found.extend(parser.feed(at, piece));
        }
        bytes = behind;
    }
    (found, parser.counters())
}

proptest! {
    #[test]
    fn any_chunking_gives_the_same_result(bytes in stream(), chunks in chunks(0..1)) {
        prop_assert_eq!(read_in_chunks(&bytes, &chunks, usize::MAX), read(&bytes));
    }

    #[test]
    fn chunks_with_pauses_are_read_as_if_byte_by_byte(
        bytes in stream(),
        chunks in chunks(0..150),
    ) {
        let found = read_in_chunks(&bytes, &chunks, usize::MAX);
        prop_assert_eq!(found, read_in_chunks(&bytes, &chunks, 1));
    }

    #[test]
    fn only_frames_that_were_sent_are_found(bytes in stream()) {
        let sent: Vec<Incoming> = all_frames().iter().flat_map(|it| messages(it)).collect();
        for incoming in messages(&bytes) {
            prop_assert!(sent.contains(&incoming), "{:?}", incoming);
        }
    }

    #[test]
    fn random_bytes_bring_nothing_but_counts(
        bytes in proptest::collection::vec(any::<u8>(), 0..5000)
    ) {
        let (found, counters) = read(&bytes);
        prop_assert!(found.is_empty());
        prop_assert_eq!(counters.frames, 0);
    }

    #[test]
    fn random_payloads_never_pass_a_value_that_is_no_number(
        which in 1..FRAMES,
        bytes in proptest::collection::vec(any::<u8>(), 280),
    ) {
        let mut spoilt = all_frames()[which].clone();
        let end = spoilt.len() - 2;
        spoilt[10..end].copy_from_slice(&bytes[..end - 10]);
        let extra = [0, SET_ATTITUDE_TARGET_DATA::EXTRA_CRC, COMMAND_LONG_DATA::EXTRA_CRC,
            ODOMETRY_DATA::EXTRA_CRC, SET_POSITION_TARGET_LOCAL_NED_DATA::EXTRA_CRC,
            COMMAND_INT_DATA::EXTRA_CRC, SETUP_SIGNING_DATA::EXTRA_CRC][which];
        seal(&mut spoilt, extra);
        for incoming in messages(&spoilt) {
            let Incoming::Message { message, .. } = incoming else { continue };
            match message {
                Message::Setpoint(it) => prop_assert!(it.rates.is_finite()),
                Message::Pose(it) => {
                    prop_assert!(it.position.is_finite() && it.velocity.is_finite());
                }
                Message::Goal(it) => {
                    prop_assert!(it.position.is_finite() && it.velocity.is_finite());
                    prop_assert!(it.heading.is_none_or(|heading| heading.abs() <= 3.2));
                }
                Message::TestMotor(it) => prop_assert!((0.0..=1.0).contains(&it.share)),
                Message::Heartbeat
                | Message::Arm(_)
                | Message::Calibrate(_)
                | Message::Store(_) => {}
            }
        }
    }

    #[test]
    fn after_noise_and_silence_a_frame_is_always_read(
        noise in proptest::collection::vec(any::<u8>(), 0..600)
    ) {
        let mut parser = Parser::new();
        let _ = parser.feed(NOW, &noise).count();
        let later = NOW + PATIENCE + crate::time::micros(1);
        prop_assert_eq!(parser.feed(later, &frame(0, &arm_command(1.0))).count(), 1);
    }
}
