//! MAVLink 2 signatures: only who has the key is obeyed.
//!
//! A signature is the first 6 bytes of SHA-256 over key, frame, link number and a stamp in units of
//! 10 us. A *stream* is what one component sends over one link: its stamps only grow, so that a frame
//! cannot be sent twice. This drone has no calendar: its clock begins at the stamp that came with the
//! key, runs on, and follows later stamps of valid frames.
//!
//! | refused | why |
//! |---|---|
//! | a frame without signature | anybody can have sent it |
//! | a stamp not above its stream's last | the frame was heard before |
//! | a new stream, a minute behind the clock | its last stamp is unknown, old frames could begin it |
//! | a ninth stream | as above: forgetting another stream would let its frames be sent again |
//! | another signature | altered, or made with another key |

use super::encode::Frame;
use super::framing::RawFrame;
use super::peers::Peer;
use crate::time::{Instant, span};
use core::fmt;
use heapless::LinearMap;
use mavlink::consts::v2::{SIGNATURE_SIZE, SIGNATURE_VALUE_SIZE};
use sha2::{Digest, Sha256};

/// Streams whose stamps are kept.
const STREAMS: usize = 8;

/// How far behind the clock a new stream may begin: a minute, in units of 10 us.
const MINUTE: u64 = 60 * 100_000;

/// Microseconds of a unit of stamps.
const UNIT: u64 = 10;

/// The largest stamp: 48 bits.
const LARGEST_STAMP: u64 = (1 << 48) - 1;

/// Number of the link in frames of ours: a drone has one link.
const LINK: u8 = 0;

/// Bytes of the hash that are sent.
const HASH: usize = SIGNATURE_VALUE_SIZE;

/// Bytes before it: link and stamp.
const LINK_AND_STAMP: usize = SIGNATURE_SIZE - HASH;

/// A key, and the stamp from which frames are signed with it: what a restart must not forget.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct SigningKey {
    secret: [u8; 32],
    stamp: u64,
}

/// Without the secret: what is printed can be read.
impl fmt::Debug for SigningKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SigningKey from {}", self.stamp)
    }
}

impl SigningKey {
    /// Length of [`Self::to_bytes`].
    pub const LENGTH: usize = 32 + 8;

    /// The key, where its stamp has 48 bits.
    #[must_use]
    pub fn new(secret: [u8; 32], stamp: u64) -> Option<Self> {
        (stamp <= LARGEST_STAMP).then_some(Self { secret, stamp })
    }

    /// True where all is zero: the customary way to say that there shall be no key.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.secret == [0; 32]
    }

    /// The bytes by which it is stored.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::LENGTH] {
        let mut bytes = [0; Self::LENGTH];
        let stored = self.secret.into_iter().chain(self.stamp.to_le_bytes());
        for (place, byte) in bytes.iter_mut().zip(stored) {
            *place = byte;
        }
        bytes
    }

    /// The key of such bytes, where they mean one.
    #[must_use]
    pub fn from_bytes(bytes: [u8; Self::LENGTH]) -> Option<Self> {
        let (secret, stamp) = bytes.split_first_chunk()?;
        Self::new(*secret, u64::from_le_bytes(stamp.try_into().ok()?))
    }

    fn hash(&self, signed: &[u8], link_and_stamp: &[u8]) -> [u8; HASH] {
        let hash = Sha256::new()
            .chain_update(self.secret)
            .chain_update(signed)
            .chain_update(link_and_stamp)
            .finalize();
        hash.0.first_chunk().copied().unwrap_or_default()
    }
}

/// Why a frame is not believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Doubt {
    Unsigned,
    OldStamp,
    NoRoom,
    /// Nothing would come of it: the hash was not computed.
    Unheeded,
    BadSignature,
}

#[derive(Clone, Copy, PartialEq, Eq)]
struct Stream {
    from: Peer,
    link: u8,
}

/// The key, the clock of stamps, and the last stamp of every stream.
pub struct Signing {
    /// With the newest stamp seen or given.
    key: Option<SigningKey>,
    /// When that stamp was the time.
    at: Instant,
    streams: LinearMap<Stream, u64, STREAMS>,
}

impl Signing {
    /// Without a key: frames are believed, and not signed.
    pub(super) const fn new() -> Self {
        Self {
            key: None,
            at: Instant::from_ticks(0),
            streams: LinearMap::new(),
        }
    }

    /// From now on frames are signed, and must be, with this key; one that [is none] ends that.
    ///
    /// The clock never goes back under the same key.
    ///
    /// [is none]: SigningKey::is_none
    pub fn set(&mut self, at: Instant, key: SigningKey) {
        let before = self.key(at).filter(|before| before.secret == key.secret);
        if before.is_none() {
            self.streams.clear();
        }
        let stamp = before.map_or(key.stamp, |before| before.stamp.max(key.stamp));
        self.key = Some(SigningKey { stamp, ..key }).filter(|key| !key.is_none());
        self.at = at;
    }

    /// True where there is a key.
    pub(super) fn is_on(&self) -> bool {
        self.key.is_some()
    }

    /// The key in force with the stamp of now: to be kept, and [set](Self::set) after a restart.
    #[must_use]
    pub fn key(&self, at: Instant) -> Option<SigningKey> {
        let passed = span(self.at, at).ticks() / UNIT;
        self.key.map(|key| SigningKey {
            stamp: key.stamp.saturating_add(passed).min(LARGEST_STAMP),
            ..key
        })
    }

    #[inline(never)]
    /// Judges a frame whose checksum holds; takes note of its stamp where it is believed.
    ///
    /// The hash, which takes longest, comes last.
    pub(super) fn check(
        &mut self,
        at: Instant,
        frame: &RawFrame<'_>,
        heeded: bool,
    ) -> Result<(), Doubt> {
        let Some(key) = self.key(at) else {
            return Ok(());
        };
        let (link_and_stamp, hash) = frame
            .signature
            .split_first_chunk::<LINK_AND_STAMP>()
            .ok_or(Doubt::Unsigned)?;
        let [link, a, b, c, d, e, f] = *link_and_stamp;
        let stamp = u64::from_le_bytes([a, b, c, d, e, f, 0, 0]);
        let from = frame.from;
        let stream = Stream { from, link };
        match self.streams.get(&stream) {
            Some(last) if stamp <= *last => return Err(Doubt::OldStamp),
            None if stamp.saturating_add(MINUTE) < key.stamp => return Err(Doubt::OldStamp),
            None if self.streams.is_full() => return Err(Doubt::NoRoom),
            _ if !heeded => return Err(Doubt::Unheeded),
            _ => {}
        }
        // All bytes are compared: the time taken tells nothing about the right ones.
        let differs = |(a, b): (&u8, &u8)| a ^ b;
        let expected = key.hash(frame.signed, link_and_stamp);
        let pairs = expected.iter().zip(hash);
        if hash.len() != HASH || pairs.map(differs).fold(0, |all, one| all | one) != 0 {
            return Err(Doubt::BadSignature);
        }
        // There is room, see above.
        let _ = self.streams.insert(stream, stamp);
        self.follow(at, key, stamp);
        Ok(())
    }

    /// Signs a frame, where there is a key.
    pub fn sign(&mut self, at: Instant, frame: &mut Frame) {
        let Some(key) = self.key(at) else {
            return;
        };
        frame.mark_signed();
        let [a, b, c, d, e, f, ..] = key.stamp.to_le_bytes();
        let link_and_stamp = [LINK, a, b, c, d, e, f];
        let hash = key.hash(frame.as_bytes(), &link_and_stamp);
        frame.append(&link_and_stamp);
        frame.append(&hash);
        // No stamp is used twice.
        self.follow(at, key, key.stamp.saturating_add(1));
    }

    /// Puts the clock forward.
    fn follow(&mut self, at: Instant, now: SigningKey, stamp: u64) {
        let stamp = stamp.max(now.stamp).min(LARGEST_STAMP);
        self.key = Some(SigningKey { stamp, ..now });
        self.at = at;
    }
}
