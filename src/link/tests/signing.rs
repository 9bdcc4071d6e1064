//! Which signed frames are believed. The interplay with other programs is in `tests/signing.rs`.

use super::*;
use crate::time::micros;
use sha2::{Digest, Sha256};

const SECRET: [u8; 32] = *b"an orange parrot on a blue drone";
const STAMP: u64 = 36_000_000_000_000;
const MINUTE: u64 = 6_000_000;

fn key() -> SigningKey {
    SigningKey::new(SECRET, STAMP).expect("48 bits")
}

fn signed(mut frame: Vec<u8>, link: u8, stamp: u64, extra: u8) -> Vec<u8> {
    frame[2] = 1;
    seal(&mut frame, extra);
    let stamp = stamp.to_le_bytes();
    let mut hash = Sha256::new();
    hash.update(SECRET);
    hash.update(&frame);
    hash.update([link]);
    hash.update(&stamp[..6]);
    let hash = hash.finalize();
    frame.push(link);
    frame.extend(&stamp[..6]);
    frame.extend(&hash[..6]);
    frame
}

fn arm(link: u8, stamp: u64) -> Vec<u8> {
    let arm = frame(0, &arm_command(1.0));
    signed(arm, link, stamp, COMMAND_LONG_DATA::EXTRA_CRC)
}

fn with_key() -> Parser {
    let mut parser = Parser::new();
    parser.signing().set(NOW, key());
    parser
}

/// True where it is obeyed.
fn obeys(parser: &mut Parser, at: Instant, bytes: &[u8]) -> bool {
    let found = parser.feed(at, bytes).count();
    assert!(found <= 1);
    found == 1
}

#[test]
fn unsigned_frames_do_nothing_once_there_is_a_key() {
    let mut parser = with_key();
    for bytes in all_frames() {
        assert!(!obeys(&mut parser, NOW, &bytes));
    }
    assert_eq!(parser.counters().unsigned, FRAMES as u32);
    assert!(obeys(&mut parser, NOW, &arm(0, STAMP)));
}

#[test]
fn any_bit_altered_does_nothing() {
    let good = arm(2, STAMP);
    let extra = COMMAND_LONG_DATA::EXTRA_CRC;
    let end = good.len() - 13;
    for bit in 0..8 * good.len() {
        let byte = bit / 8;
        // Not its mark, length, flags and message, which make another frame of it.
        if byte < 3 || (7..10).contains(&byte) {
            continue;
        }
        let mut bytes = good.clone();
        bytes[byte] ^= 1 << (bit % 8);
        // The checksum is no secret.
        if byte < end - 2 {
            seal(&mut bytes[..end], extra);
        }
        let mut parser = with_key();
        assert!(!obeys(&mut parser, NOW, &bytes), "bit {bit}");
        let counters = parser.counters();
        let of_checksum = (end - 2..end).contains(&byte);
        assert_eq!(counters.bad_checksum, u32::from(of_checksum), "bit {bit}");
        let refused = counters.bad_signature + counters.old_stamp;
        assert_eq!(refused, u32::from(!of_checksum), "bit {bit}");
    }
    assert!(obeys(&mut with_key(), NOW, &good));
}

#[test]
fn a_replayed_frame_does_nothing_and_is_counted() {
    let mut parser = with_key();
    let (first, second) = (arm(0, STAMP + 1), arm(0, STAMP + 2));
    for (bytes, obeyed) in [
        (&first, true),
        (&second, true),
        (&second, false),
        (&first, false),
    ] {
        assert_eq!(obeys(&mut parser, NOW, bytes), obeyed);
    }
    assert_eq!(parser.counters().old_stamp, 2);
}

#[test]
fn every_stream_has_stamps_of_its_own_and_begins_within_a_minute() {
    let mut parser = with_key();
    assert!(obeys(&mut parser, NOW, &arm(0, STAMP + 100)));
    assert!(obeys(&mut parser, NOW, &arm(1, STAMP + 50)));
    assert!(!obeys(&mut parser, NOW, &arm(1, STAMP + 50)));
    assert!(!obeys(&mut parser, NOW, &arm(2, STAMP + 99 - MINUTE)));
    assert!(obeys(&mut parser, NOW, &arm(2, STAMP + 100 - MINUTE)));
    // The clock runs on: a minute later the oldest stamp is a minute later, too.
    let later = NOW + micros(60_000_000);
    assert!(!obeys(&mut parser, later, &arm(3, STAMP + 99)));
    assert!(obeys(&mut parser, later, &arm(3, STAMP + 100)));
    assert_eq!(parser.counters().old_stamp, 3);
}

#[test]
fn no_stream_is_forgotten_for_another() {
    let mut parser = with_key();
    let obeyed = (0..=255).filter(|link| obeys(&mut parser, NOW, &arm(*link, STAMP)));
    assert_eq!(obeyed.collect::<Vec<u8>>(), [0, 1, 2, 3, 4, 5, 6, 7]);
    assert!(obeys(&mut parser, NOW, &arm(3, STAMP + 1)));
}

#[test]
fn a_wrong_signature_moves_no_stamp() {
    let mut parser = with_key();
    let mut forged = arm(0, STAMP + 1000);
    *forged.last_mut().expect("some") ^= 1;
    assert!(!obeys(&mut parser, NOW, &forged));
    assert!(obeys(&mut parser, NOW, &arm(0, STAMP)));
}

#[test]
fn the_same_key_again_forgets_nothing_another_one_does_and_none_ends_it() {
    let mut parser = with_key();
    assert!(obeys(&mut parser, NOW, &arm(0, STAMP + 5)));
    parser
        .signing()
        .set(NOW, SigningKey::new(SECRET, 0).expect("48 bits"));
    assert!(!obeys(&mut parser, NOW, &arm(0, STAMP + 5)), "known");
    assert!(!obeys(&mut parser, NOW, &arm(1, STAMP - MINUTE)), "too old");
    parser
        .signing()
        .set(NOW, SigningKey::new([1; 32], 0).expect("48 bits"));
    assert!(!obeys(&mut parser, NOW, &arm(0, STAMP + 6)), "another key");
    parser
        .signing()
        .set(NOW, SigningKey::new([0; 32], 0).expect("48 bits"));
    assert_eq!(parser.signing().key(NOW), None);
    assert!(obeys(&mut parser, NOW, &frame(0, &arm_command(1.0))));
}

#[test]
fn a_key_is_read_and_its_secret_is_not_printed() {
    let (found, _) = read(&frame(0, &signing_setup()));
    let key = SigningKey::new([9; 32], 7).expect("48 bits");
    assert_eq!(found, [Incoming::Key(key)]);
    assert!(!std::format!("{key:?}").contains('9'));
    let too_late = SETUP_SIGNING_DATA {
        initial_timestamp: 1 << 48,
        ..signing_setup()
    };
    let (found, counters) = read(&frame(0, &too_late));
    assert_eq!((found.len(), counters.refused_value), (0, 1));
}

#[test]
fn the_key_to_be_kept_has_the_stamp_of_now() {
    let mut parser = with_key();
    let later = NOW + micros(20_000_000);
    let kept = parser.signing().key(later);
    assert_eq!(kept, SigningKey::new(SECRET, STAMP + 2_000_000));
}

#[test]
fn a_full_notice_fits_with_its_signature_and_no_stamp_is_used_twice() {
    let mut parser = with_key();
    let mut sender = Sender::new(4);
    let longest = "12345678901234567890123456789012345678901234567890";
    let mut stamps = [0, 1, 2].map(|_| {
        let mut frame = sender.notice(&Notice::new(Severity::Info, longest, ""));
        parser.signing().sign(NOW, &mut frame);
        let bytes = frame.as_bytes();
        assert_eq!(bytes.len(), LONGEST_FRAME_OUT);
        bytes[LONGEST_FRAME_OUT - 12..LONGEST_FRAME_OUT - 6].to_vec()
    });
    stamps.sort();
    assert!(stamps.windows(2).all(|pair| pair[0] != pair[1]));
}
