//! The store in flash: whatever it holds, it is named, and can be stored anew.

use std::cell::RefCell;
use std::rc::Rc;

use arbitrary::{Result as Made, Unstructured};
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use reflex::link::SigningKey;
use reflex::settings::Parameter;
use reflex::store::{Content, Found, MOST_PARAMETERS, SLOT, Store};
use reflex_settings::bytes::CHECKSUM;

use super::{Loaded, Source, Target};

pub(super) const STORE: Target = Target {
    name: "store",
    reads: "the store of key and parameters in flash",
    inputs: 20_000,
    load: || Ok(Loaded::new(Source::Made(flash), check)),
};

/// Slots of both copies.
const SLOTS: usize = 4;

/// Flash that obeys its rules: bits fall one by one, and rise by slots. Its bytes can be looked at from outside.
#[derive(Clone)]
struct Nor(Rc<RefCell<Vec<u8>>>);

impl ErrorType for Nor {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Nor {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        let from = offset as usize;
        let flash = self.0.borrow();
        let held = flash.get(from..from + bytes.len());
        bytes.copy_from_slice(held.ok_or(NorFlashErrorKind::OutOfBounds)?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.borrow().len()
    }
}

impl NorFlash for Nor {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SLOT;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        self.0.borrow_mut()[from as usize..to as usize].fill(0xFF);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        let mut flash = self.0.borrow_mut();
        let held = flash[offset as usize..].iter_mut();
        held.zip(bytes).for_each(|(held, byte)| *held &= byte);
        Ok(())
    }
}

/// Some saves, of which some bytes are then others; the sums mostly hold.
fn flash(from: &mut Unstructured<'_>) -> Made<Vec<u8>> {
    let nor = Nor(Rc::new(RefCell::new(vec![0xFF; SLOTS * SLOT])));
    for _ in 0..from.int_in_range(0..=3)? {
        let content = content(from)?;
        let _ = Store::new(nor.clone()).save(&content);
    }
    let mut bytes = nor.0.take();
    for _ in 0..from.int_in_range(0..=4)? {
        let slot = SLOT * from.int_in_range(0..=SLOTS - 1)?;
        // Heads and first parameters more often than what is hardly ever used.
        let last = if from.ratio(3, 4)? { 60 } else { SLOT - 1 };
        let at = slot + from.int_in_range(0..=last)?;
        bytes[at] = from.arbitrary()?;
        if from.ratio(3, 4)? {
            seal(&mut bytes[slot..slot + SLOT]);
        }
    }
    Ok(bytes)
}

fn content(from: &mut Unstructured<'_>) -> Made<Content> {
    let mut content = Content::default();
    if from.arbitrary()? {
        content.key = SigningKey::new(from.arbitrary()?, from.int_in_range(0..=1 << 47)?);
    }
    for _ in 0..from
        .int_in_range(0..=MOST_PARAMETERS)?
        .min(from.int_in_range(0..=MOST_PARAMETERS)?)
    {
        let number = from.int_in_range(0..=500)?;
        // There is room.
        let _ = content.set(Parameter {
            number,
            word: from.arbitrary()?,
        });
    }
    Ok(content)
}

/// Makes the sum of an image right, where its length is one.
fn seal(slot: &mut [u8]) {
    let length = usize::from(u16::from_le_bytes([slot[6], slot[7]]));
    if let Some((content, sum)) = slot
        .get_mut(..length)
        .and_then(<[u8]>::split_last_chunk_mut)
    {
        *sum = CHECKSUM.checksum(content).to_le_bytes();
    }
}

fn check(input: &[u8]) -> bool {
    let mut bytes = input.to_vec();
    bytes.resize(SLOTS * SLOT, 0xFF);
    let mut store = Store::new(Nor(Rc::new(RefCell::new(bytes))));
    let (found, content) = store.load();
    let is_sound = matches!(found, Found::Sound | Found::OneCopy);
    assert!(
        is_sound || content == Content::default(),
        "{found:?}: {content:?}"
    );
    let mut next = content.clone();
    if next
        .set(Parameter {
            number: 501,
            word: [1; 4],
        })
        .is_ok()
    {
        store.save(&next).expect("the flash is sound");
        let (after, stored) = store.load();
        assert_eq!((after, &stored), (Found::Sound, &next), "behind {found:?}");
    }
    is_sound
}
