//! Flash that obeys its rules, and dies at any word.

use super::*;
use crate::settings::Parameter;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use proptest::prelude::*;

/// What is erased at once: two slots, so that wrapping comes soon.
const SECTOR: usize = 2 * SLOT;
const WORD: usize = 4;

/// NOR flash of two sectors: bits fall one by one, and rise by sectors.
#[derive(Clone, Debug)]
pub(crate) struct Nor {
    bytes: Vec<u8, { 2 * SECTOR }>,
    /// Words and sectors that are still changed before power fails; half of the next one is.
    left: u32,
    /// Bits that a change which is cut off reaches.
    torn: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Broken(NorFlashErrorKind);

impl NorFlashError for Broken {
    fn kind(&self) -> NorFlashErrorKind {
        self.0
    }
}

impl Nor {
    fn filled(byte: u8) -> Self {
        let bytes = Vec::from_slice(&[byte; 2 * SECTOR]).expect("room");
        Self {
            bytes,
            left: u32::MAX,
            torn: 0,
        }
    }

    pub(crate) fn erased() -> Self {
        Self::filled(ERASED)
    }

    /// A step of the flash: done, cut off half way, or no power for it.
    fn step(&mut self) -> Result<bool, Broken> {
        let whole = self.left > 0;
        if self.left == 0 && self.torn == 0 {
            return Err(Broken(NorFlashErrorKind::Other));
        }
        self.left = self.left.saturating_sub(1);
        Ok(whole)
    }
}

impl ErrorType for Nor {
    type Error = Broken;
}

impl ReadNorFlash for Nor {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Broken> {
        let from = offset as usize;
        bytes.copy_from_slice(&self.bytes[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Nor {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Broken> {
        assert!((from as usize).is_multiple_of(SECTOR) && (to as usize).is_multiple_of(SECTOR));
        for sector in self
            .bytes
            .clone()
            .chunks(SECTOR)
            .enumerate()
            .map(|(sector, _)| sector)
        {
            if !(from as usize..to as usize).contains(&(sector * SECTOR)) {
                continue;
            }
            let whole = self.step()?;
            let torn = core::mem::take(&mut self.torn);
            for (place, byte) in self.bytes[sector * SECTOR..][..SECTOR]
                .iter_mut()
                .enumerate()
            {
                let reaches = torn.rotate_left(place as u32) & 1 == 1;
                *byte |= if whole || reaches { ERASED } else { torn as u8 };
            }
            self.torn = torn * u32::from(whole);
            if !whole {
                return Err(Broken(NorFlashErrorKind::Other));
            }
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Broken> {
        assert!((offset as usize).is_multiple_of(WORD) && bytes.len().is_multiple_of(WORD));
        for (word, at) in bytes.chunks(WORD).zip((offset as usize..).step_by(WORD)) {
            let held = &self.bytes[at..at + WORD];
            assert!(
                held.iter().all(|byte| *byte == ERASED),
                "written twice without an erase"
            );
            let whole = self.step()?;
            let torn = core::mem::take(&mut self.torn);
            for ((place, byte), kept) in word.iter().enumerate().zip(torn.to_le_bytes()) {
                self.bytes[at + place] = if whole { *byte } else { *byte | kept };
            }
            self.torn = torn * u32::from(whole);
            if !whole {
                return Err(Broken(NorFlashErrorKind::Other));
            }
        }
        Ok(())
    }
}

fn parameter(number: u32, value: f32) -> Parameter {
    Parameter {
        number,
        word: value.to_le_bytes(),
    }
}

/// Content that differs in every part from that of other numbers.
fn content(number: u8) -> Content {
    let mut content = Content {
        key: SigningKey::new([number; 32], number.into()),
        ..Content::default()
    };
    for place in 0..number % 8 {
        content
            .set(parameter(place.into(), number.into()))
            .expect("room");
    }
    content
}

/// Flash with so many saves behind it.
fn saved(saves: u8) -> Nor {
    let mut store = Store::new(Nor::erased());
    (1..=saves).for_each(|save| store.save(&content(save)).expect("it works"));
    store.flash
}

fn load(flash: &Nor) -> (Found, Content) {
    let mut flash = flash.clone();
    (flash.left, flash.torn) = (u32::MAX, 0);
    Store::new(flash).load()
}

#[test]
fn what_was_saved_last_is_found_however_often_flash_was_erased_between() {
    assert_eq!(load(&Nor::erased()), (Found::Empty, Content::default()));
    for saves in 1..=9 {
        assert_eq!(
            load(&saved(saves)),
            (Found::Sound, content(saves)),
            "{saves}"
        );
    }
}

#[test]
fn power_that_fails_at_any_word_leaves_the_old_or_the_new_and_the_next_save_mends() {
    for before in 0..=5 {
        let (old, new) = (load(&saved(before)).1, content(9));
        let mut cuts = 0;
        for (left, torn) in
            (0..).flat_map(|left| [0, 0x5A3C_96F0, 0xFFFF_FFFE].map(|torn| (left, torn)))
        {
            let mut store = Store::new(Nor {
                left,
                torn,
                ..saved(before)
            });
            if store.save(&new).is_ok() {
                break;
            }
            cuts += 1;
            let (found, held) = load(&store.flash);
            let whole = held == new || held == old;
            assert!(
                whole,
                "{before} saves, {left} steps, {torn:x}: {found:?} {held:?}"
            );
            // Before the first save ended there is nothing to be lost.
            assert!(
                before == 0 || !found.is_loss(),
                "{before} saves, {left} steps: {found:?}"
            );
            // Cut off once more while it is mended.
            for again in 0..40 {
                let cut = Nor {
                    left: again,
                    torn,
                    ..store.flash.clone()
                };
                let mut second = Store::new(cut);
                let _ = second.save(&held);
                let (_, still) = load(&second.flash);
                assert!(
                    before == 0 || still == held,
                    "{before} saves, {left} and {again} steps"
                );
            }
            (store.flash.left, store.flash.torn) = (u32::MAX, 0);
            store.save(&new).expect("power is back");
            assert_eq!(load(&store.flash), (Found::Sound, new.clone()));
        }
        assert!(cuts > 60, "{cuts} cuts");
    }
}

#[test]
fn one_damaged_copy_is_told_and_does_no_harm_two_are_a_loss() {
    for saves in 1..=4 {
        let sound = saved(saves);
        let slot = usize::from((saves - 1) % 2) * SLOT;
        for byte in (0..60).chain([SLOT - 1]) {
            let mut one = sound.clone();
            one.bytes[slot + byte] ^= 0x10;
            let (found, held) = load(&one);
            assert_eq!(held, content(saves), "{saves} saves, byte {byte}");
            // Behind the image nothing counts but that the slot is used.
            let behind = byte == SLOT - 1;
            assert_eq!(found, if behind { Found::Sound } else { Found::OneCopy });
            one.bytes[SECTOR + slot + byte] ^= 0x10;
            let lost = (Found::Damaged, Content::default());
            assert_eq!(load(&one) == lost, !behind, "{saves} saves, byte {byte}");
        }
    }
}

#[test]
fn flash_that_is_stuck_is_told() {
    let mut dead = Store::new(Nor {
        left: 0,
        ..Nor::filled(0)
    });
    assert_eq!(dead.save(&content(1)), Err(NotSaved::Flash));
    assert_eq!(dead.load(), (Found::Damaged, Content::default()));
}

#[test]
fn what_another_version_stored_is_told_apart_from_damage() {
    let mut flash = saved(1);
    for copy in [0, SECTOR] {
        let length = usize::from(u16::from_le_bytes([
            flash.bytes[copy + 6],
            flash.bytes[copy + 7],
        ]));
        flash.bytes[copy + 4] ^= 0xFF;
        let sum = reflex_settings::bytes::CHECKSUM.checksum(&flash.bytes[copy..copy + length - 4]);
        flash.bytes[copy + length - 4..copy + length].copy_from_slice(&sum.to_le_bytes());
    }
    assert_eq!(load(&flash), (Found::OtherVersion, Content::default()));
    let mut store = Store::new(flash);
    store.save(&content(2)).expect("it works");
    assert_eq!(load(&store.flash), (Found::Sound, content(2)));
}

#[test]
fn a_slot_is_filled_and_no_more() {
    let mut full = Content {
        key: content(1).key,
        ..Content::default()
    };
    for number in 0..MOST_PARAMETERS as u32 {
        full.set(parameter(number, 0.5)).expect("room");
    }
    assert_eq!(full.set(parameter(7, 0.25)), Ok(()));
    assert_eq!(full.set(parameter(u32::MAX, 0.5)), Err(NotSaved::NoRoom));
    let mut store = Store::new(Nor::erased());
    store.save(&full).expect("it fits");
    assert_eq!(store.load(), (Found::Sound, full));
}

proptest! {
    #[test]
    fn any_bytes_are_read_without_a_panic_and_a_save_repairs_them(
        bytes in prop::collection::vec(any::<u8>(), 2 * SECTOR),
        image in any::<bool>(), flips in prop::collection::vec((0..2 * SECTOR, any::<u8>()), 0..8),
    ) {
        let mut flash = if image { saved(3) } else { Nor::erased() };
        if !image {
            flash.bytes.copy_from_slice(&bytes);
        }
        for (place, bits) in flips {
            flash.bytes[place] ^= bits;
        }
        let (found, held) = load(&flash);
        prop_assert!(!found.is_loss() || held == Content::default());
        prop_assert!(image || found.is_loss());
        let mut store = Store::new(flash);
        store.save(&content(5)).expect("it works");
        prop_assert_eq!(store.load(), (Found::Sound, content(5)));
    }

    #[test]
    fn a_key_keeps_its_bytes(secret: [u8; 32], stamp in 0_u64..1 << 48) {
        let key = SigningKey::new(secret, stamp);
        prop_assert_eq!(SigningKey::from_bytes(key.expect("48 bits").to_bytes()), key);
    }
}
