//! What a restart must not forget: the signing key and parameters, twice in flash.
//!
//! Flash is halved into two copies. A copy is a row of slots that are written one after the other,
//! and erased where none is left; its last slot counts. Whatever is to be stored goes into the worse
//! copy first and, once that reads back, into the other: at each instant one copy holds what was
//! stored before, or what is stored now, as a whole.
//!
//! | the copies hold | found |
//! |---|---|
//! | nothing, both | [`Found::Empty`] |
//! | the same, both | [`Found::Sound`] |
//! | one something, the other nothing, something older or rubbish | [`Found::OneCopy`]: a save was cut off, or a copy is damaged |
//! | none anything sound, one something of another version | [`Found::OtherVersion`] |
//! | none anything sound | [`Found::Damaged`] |
//!
//! `sequential-storage` would keep one copy, step over what is damaged to something older without a
//! word, take 10 KiB of flash, and bring panics into the firmware. This asks for what flash can do
//! through [`NorFlash`], as it does: an FRAM that erases by writing ones serves as well.

mod image;
#[cfg(test)]
pub(crate) mod tests;

use embedded_storage::nor_flash::NorFlash;
use heapless::Vec;

use crate::link::SigningKey;
use crate::numbered::numbered;
use crate::settings::Parameter;
use image::{Image, Unread};

/// Bytes of a slot.
pub const SLOT: usize = 1024;

/// Parameters that fit into a slot.
pub const MOST_PARAMETERS: usize = 120;

/// Bytes that are read or compared at once.
const CHUNK: usize = 64;

/// What erased flash reads.
const ERASED: u8 = 0xFF;

numbered! {
    /// What a start found in the store.
    Found {
        /// Nothing was ever stored.
        Empty,
        /// What was stored, twice.
        Sound,
        /// What was stored, or was before the last save, once.
        OneCopy,
        /// What another version stored, or values out of their ranges: none is used.
        OtherVersion,
        /// Something that is no store.
        Damaged,
        /// Values, some of which this version does not know: the others are used.
        PartlyKnown,
    }
}

impl Found {
    /// True where something that was stored is not in force.
    #[must_use]
    pub fn is_loss(self) -> bool {
        matches!(self, Self::OtherVersion | Self::Damaged | Self::PartlyKnown)
    }
}

/// What is stored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Content {
    /// What frames are signed with.
    pub key: Option<SigningKey>,
    /// Values that differ from the configuration, in any order, each number once.
    pub parameters: Vec<Parameter, MOST_PARAMETERS>,
}

impl Content {
    /// Puts a parameter in the place of the one with its number.
    ///
    /// # Errors
    /// There is no room for one more.
    pub fn set(&mut self, parameter: Parameter) -> Result<(), NotSaved> {
        let mut held = self.parameters.iter_mut();
        if let Some(held) = held.find(|held| held.number == parameter.number) {
            *held = parameter;
            return Ok(());
        }
        let pushed = self.parameters.push(parameter);
        pushed.map_err(|_| NotSaved::NoRoom)
    }
}

/// Why nothing was saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum NotSaved {
    /// The flash refused, or does not read what was written.
    Flash,
    /// More than a slot holds.
    NoRoom,
}

/// The store in a piece of flash, all of which is its own.
#[derive(Debug)]
pub struct Store<F> {
    flash: F,
}

/// What the last slot of a copy holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Last {
    Nothing,
    /// An image with this sequence number.
    Image(u32),
    OtherVersion,
    Spoilt,
}

/// A copy as it was looked at.
#[derive(Clone, Copy, Debug)]
struct Copy {
    /// Where it begins.
    start: u32,
    /// Slots up to the last that is not erased.
    used: u32,
    last: Last,
}

impl Copy {
    /// The sequence number of a sound one.
    fn sequence(&self) -> Option<u32> {
        match self.last {
            Last::Image(sequence) => Some(sequence),
            _ => None,
        }
    }

    fn slot(&self, number: u32) -> u32 {
        self.start + number * SLOT as u32
    }
}

impl<F: NorFlash> Store<F> {
    /// A store in this flash, of at least two times a slot, a multiple of what is erased at once.
    pub const fn new(flash: F) -> Self {
        const { assert!(SLOT.is_multiple_of(F::WRITE_SIZE)) }
        Self { flash }
    }

    /// What is stored; nothing where that is a loss.
    #[inline(never)]
    pub fn load(&mut self) -> (Found, Content) {
        let copies = self.copies();
        let [first, second] = copies.map(|copy| copy.sequence());
        let best = if first >= second {
            copies[0]
        } else {
            copies[1]
        };
        let found = match (copies.map(|copy| copy.last), first == second) {
            ([Last::Nothing, Last::Nothing], _) => Found::Empty,
            ([Last::Image(_), _], true) => Found::Sound,
            ([Last::Image(_), _] | [_, Last::Image(_)], _) => Found::OneCopy,
            ([Last::OtherVersion, _] | [_, Last::OtherVersion], _) => Found::OtherVersion,
            _ => Found::Damaged,
        };
        let read = best.sequence().and_then(|_| self.read(&best).ok());
        match read {
            Some(image) => (found, image.content),
            None => (found, Content::default()),
        }
    }

    /// Stores anew, in both copies.
    ///
    /// # Errors
    /// Why one of them, or both, hold what they held before, or nothing.
    #[inline(never)]
    pub fn save(&mut self, content: &Content) -> Result<(), NotSaved> {
        let mut copies = self.copies();
        let newest = copies.iter().filter_map(Copy::sequence).max();
        let sequence = newest.map_or(1, |newest| newest.saturating_add(1));
        let mut image = image::write(content, sequence).ok_or(NotSaved::NoRoom)?;
        let whole = image.len().next_multiple_of(F::WRITE_SIZE);
        let resized = image.resize(whole, ERASED);
        resized.map_err(|_| NotSaved::NoRoom)?;
        copies.sort_unstable_by_key(|copy| copy.sequence());
        let [worse, better] = &copies;
        self.write(worse, &image)?;
        self.write(better, &image)
    }

    /// Appends an image to a copy; erases the copy before, where it must be.
    fn write(&mut self, copy: &Copy, image: &[u8]) -> Result<(), NotSaved> {
        let goes_on = matches!(copy.last, Last::Nothing | Last::Image(_));
        if goes_on && copy.used < self.slots() && self.put(copy.slot(copy.used), image) {
            return Ok(());
        }
        let end = copy.slot(self.slots());
        let erased = self.flash.erase(copy.start, end).is_ok();
        let written = erased && self.put(copy.start, image);
        written.then_some(()).ok_or(NotSaved::Flash)
    }

    /// Writes bytes; true where they read back.
    fn put(&mut self, at: u32, image: &[u8]) -> bool {
        self.flash.write(at, image).is_ok()
            && image
                .chunks(CHUNK)
                .zip((at..).step_by(CHUNK))
                .all(|(part, at)| {
                    let read = self.chunk(at);
                    read.is_some_and(|read| read.starts_with(part))
                })
    }

    fn copies(&mut self) -> [Copy; 2] {
        let second = self.slots() * SLOT as u32;
        [0, second].map(|start| self.look(start))
    }

    /// How many slots a copy has: whole pieces that are erased at once.
    fn slots(&self) -> u32 {
        let half = self.flash.capacity() / 2 / F::ERASE_SIZE * F::ERASE_SIZE;
        (half / SLOT) as u32
    }

    fn look(&mut self, start: u32) -> Copy {
        let mut copy = Copy {
            start,
            used: self.slots(),
            last: Last::Nothing,
        };
        while copy.used > 0 && self.is_erased(copy.slot(copy.used - 1)) {
            copy.used -= 1;
        }
        if copy.used > 0 {
            copy.last = match self.read(&copy) {
                Ok(image) => Last::Image(image.sequence),
                Err(Unread::OtherVersion) => Last::OtherVersion,
                Err(Unread::Spoilt) => Last::Spoilt,
            };
        }
        copy
    }

    /// The image in the last slot of a copy.
    #[inline(never)]
    fn read(&mut self, copy: &Copy) -> Result<Image, Unread> {
        let last = copy.used.checked_sub(1).ok_or(Unread::Spoilt)?;
        let mut bytes = [0; SLOT];
        let read = self.flash.read(copy.slot(last), &mut bytes);
        read.map_err(|_| Unread::Spoilt)?;
        image::read(&bytes)
    }

    /// True where nothing was written since the slot was erased; false where it cannot be read.
    fn is_erased(&mut self, slot: u32) -> bool {
        (0..SLOT as u32).step_by(CHUNK).all(|at| {
            let chunk = self.chunk(slot + at);
            chunk.is_some_and(|chunk| chunk.iter().all(|byte| *byte == ERASED))
        })
    }

    fn chunk(&mut self, at: u32) -> Option<[u8; CHUNK]> {
        let mut chunk = [0; CHUNK];
        self.flash.read(at, &mut chunk).ok().map(|()| chunk)
    }
}
