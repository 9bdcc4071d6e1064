//! The link: bytes to commands, frames that are whole, spoilt, and signed.
//!
//! An input is what comes over the wire; how it is cut into pieces, and when they come, follows from its bytes.

use arbitrary::{Result as Made, Unstructured};
use clap::ValueEnum;
use mavlink::dialects::common::{
    COMMAND_INT_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, ODOMETRY_DATA, SET_ATTITUDE_TARGET_DATA,
    SET_POSITION_TARGET_LOCAL_NED_DATA, SETUP_SIGNING_DATA,
};
use mavlink::{MAV_STX_V2, MessageData, calculate_crc};
use reflex::link::{Incoming, Parser, SigningKey};
use reflex::time::at_micros;
use sha2::{Digest, Sha256};

use super::flyer::Flyer;
use super::spoil::some;
use super::{Loaded, Source, Target};
use crate::logics::{LogicName, Start};
use reflex::config::SETTINGS;

pub(super) const LINK: Target = Target {
    name: "link",
    reads: "bytes of the link, signed ones too, and the autopilot behind it",
    inputs: 5_000,
    load: || Ok(Loaded::new(Source::Made(stream), check)),
};

/// Number, longest payload and extra byte of the checksum of each message that is used.
const MESSAGES: [(u32, usize, u8); 7] = [
    message::<HEARTBEAT_DATA>(),
    message::<SET_ATTITUDE_TARGET_DATA>(),
    message::<COMMAND_LONG_DATA>(),
    message::<COMMAND_INT_DATA>(),
    message::<ODOMETRY_DATA>(),
    message::<SET_POSITION_TARGET_LOCAL_NED_DATA>(),
    message::<SETUP_SIGNING_DATA>(),
];

const fn message<M: MessageData>() -> (u32, usize, u8) {
    (M::ID, M::ENCODED_LEN, M::EXTRA_CRC)
}

/// The key of the frames that are signed well.
const SECRET: [u8; 32] = [7; 32];

/// Some pieces: frames, parts of them, noise.
fn stream(from: &mut Unstructured<'_>) -> Made<Vec<u8>> {
    // Whether the link begins with a key.
    let mut bytes = vec![from.int_in_range(0..=1)?];
    for _ in 0..from.int_in_range(1..=40)? {
        match from.int_in_range(0..=9)? {
            0 => bytes.extend(some(from, 0..=60)?),
            1 => {
                let whole = frame(from)?;
                bytes.extend(&whole[..from.int_in_range(0..=whole.len())?]);
            }
            2 => {
                let mut whole = frame(from)?;
                let at = from.int_in_range(0..=whole.len() - 1)?;
                whole[at] ^= 1 << from.int_in_range(0..=7)?;
                bytes.extend(whole);
            }
            _ => bytes.extend(frame(from)?),
        }
    }
    Ok(bytes)
}

/// A frame whose checksum holds, with any payload, signed or not.
fn frame(from: &mut Unstructured<'_>) -> Made<Vec<u8>> {
    let (id, longest, extra) = *from.choose(&MESSAGES)?;
    let length = if from.ratio(1, 8)? {
        from.int_in_range(0..=255)?
    } else {
        longest
    };
    let mut payload = vec![0; length];
    for word in payload.chunks_mut(4) {
        let value = match from.int_in_range(0..=9)? {
            0 => from.arbitrary()?,
            1 => *from.choose(&[f32::NAN, f32::INFINITY, f32::MAX, -1.0])?,
            2..=5 => from.int_in_range(0..=10)? as f32 / 10.0,
            _ => 0.0,
        };
        word.copy_from_slice(&value.to_le_bytes()[..word.len()]);
    }
    address(id, &mut payload, from)?;
    let signed = from.arbitrary()?;
    let [a, b, c, _] = id.to_le_bytes();
    let system = *from.choose(&[255, 255, 254, 1, 0])?;
    let sequence = from.arbitrary()?;
    let mut bytes = vec![
        MAV_STX_V2,
        length as u8,
        u8::from(signed),
        0,
        sequence,
        system,
        190,
        a,
        b,
        c,
    ];
    bytes.extend(payload);
    let checksum = calculate_crc(&bytes[1..], extra);
    bytes.extend(checksum.to_le_bytes());
    if signed {
        sign(&mut bytes, from)?;
    }
    Ok(bytes)
}

/// Mostly to us, and mostly a command that is known.
fn address(id: u32, payload: &mut [u8], from: &mut Unstructured<'_>) -> Made<()> {
    let places: &[(usize, &[u8])] = match id {
        SET_ATTITUDE_TARGET_DATA::ID => &[(36, &[1, 1, 0])],
        COMMAND_LONG_DATA::ID => &[(28, &[144, 1, 1, 1])],
        COMMAND_INT_DATA::ID => &[(28, &[144, 1, 1, 1])],
        SET_POSITION_TARGET_LOCAL_NED_DATA::ID => &[(48, &[0xC0, 0x09, 1, 1, 1])],
        SETUP_SIGNING_DATA::ID => &[(8, &[1, 1])],
        _ => &[],
    };
    if from.ratio(7, 8)? {
        for (at, values) in places {
            for (byte, value) in payload.iter_mut().skip(*at).zip(*values) {
                *byte = *value;
            }
        }
    }
    Ok(())
}

fn sign(bytes: &mut Vec<u8>, from: &mut Unstructured<'_>) -> Made<()> {
    let stamp: u64 = match from.int_in_range(0..=3)? {
        0 => from.arbitrary()?,
        _ => from.int_in_range(0..=100_000_000)?,
    };
    let mut secret = SECRET;
    secret[0] ^= u8::from(from.ratio(1, 10)?);
    let link = from.int_in_range(0..=9)?;
    bytes.push(link);
    let signed = bytes.len() - 1;
    bytes.extend(&stamp.to_le_bytes()[..6]);
    let hash = Sha256::new()
        .chain_update(secret)
        .chain_update(&bytes[..signed])
        .chain_update(&bytes[signed..])
        .finalize();
    bytes.extend(&hash[..6]);
    Ok(())
}

/// What comes of any bytes is finite, counted, and does no harm.
fn check(input: &[u8]) -> bool {
    let Some((keyed, bytes)) = input.split_first() else {
        return false;
    };
    let logic =
        LogicName::value_variants()[usize::from(*keyed) % LogicName::value_variants().len()];
    let mut flyer = Flyer::new(&Start::configured(SETTINGS, logic.gains()));
    let mut parser = Parser::new();
    if *keyed & 1 == 1
        && let Some(key) = SigningKey::new(SECRET, 1)
    {
        parser.signing().set(at_micros(0), key);
    }
    flyer.pass(600, 1.0);
    let (mut rest, mut found) = (bytes, 0);
    while let Some(first) = rest.first() {
        let length = 1 + usize::from(first % 90);
        let (piece, behind) = rest.split_at(length.min(rest.len()));
        // Now and then a pause: longer than a frame may take.
        flyer.pass(if *first == 0xFF { 150 } else { 1 }, 1.0);
        let mut feed = parser.feed(flyer.at(), piece);
        while let Some(incoming) = feed.next() {
            found += 1;
            match incoming {
                Incoming::Message { message, .. } => {
                    assert!(message.is_finite(), "{message:?}");
                    flyer.tell(&message);
                }
                Incoming::Key(key) => feed.signing().set(flyer.at(), key),
                Incoming::Refused { .. } => {}
            }
        }
        rest = behind;
    }
    let counters = parser.counters();
    assert!(counters.frames as usize >= found, "{found} of {counters:?}");
    assert!(counters.frames as usize <= bytes.len(), "{counters:?}");
    flyer.pass(50, 1.0);
    found > 0
}
