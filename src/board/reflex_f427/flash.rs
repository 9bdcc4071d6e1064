//! Flash for the store: two sectors of the second bank, where no code is.
//!
//! While a sector of 16 KiB is erased (250 ms, 500 at most; DS9405, table 47), code goes on in the
//! first bank, which is all that `memory.x` gives the linker (RM0090, 3.5.4). Bits are programmed 32 at
//! once, which wants 2.7 V: below, the brown-out reset comes first.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_write,
};
use reflex::time::{Duration, micros, span};
use stm32f4xx_hal::pac;

use crate::board::now;

/// Where the second bank begins.
const START: usize = 0x0810_0000;
/// Bytes of each of its first four sectors.
const SECTOR: usize = 16 * 1024;
/// One for each copy of the store.
const SECTORS: usize = 2;
/// Number of its first sector in the register (RM0090, 3.9.8).
const FIRST_SECTOR: u8 = 0b1_0000;
/// Bytes that are programmed at once.
const WORD: usize = 4;

/// What is written in this order to be let in.
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];

/// Twice what a sector takes at most.
const LONGEST_ERASE: Duration = micros(1_000_000);
/// Ten times what a word takes at most.
const LONGEST_WRITE: Duration = micros(1_000);

/// The two sectors.
pub struct Flash(pac::FLASH);

/// Why flash was not read or changed.
#[derive(Clone, Copy, Debug)]
pub struct Refused(NorFlashErrorKind);

impl NorFlashError for Refused {
    fn kind(&self) -> NorFlashErrorKind {
        self.0
    }
}

impl Flash {
    /// Of a controller whose wait states are set.
    pub fn new(controller: pac::FLASH) -> Self {
        Self(controller)
    }

    /// Lets a change in, and locks flash behind it again.
    fn unlocked(
        &mut self,
        change: impl FnOnce(&Self) -> Result<(), Refused>,
    ) -> Result<(), Refused> {
        if self.0.cr().read().lock().bit() {
            for key in KEYS {
                self.0.keyr().write(|w| w.key().set(key));
            }
        }
        let changed = match self.0.cr().read().lock().bit() {
            true => Err(Refused(NorFlashErrorKind::Other)),
            false => change(self),
        };
        self.0.cr().write(|w| w.lock().set_bit());
        self.forget();
        changed
    }

    /// What was read before the change is in the data cache still (RM0090, 3.9.1).
    fn forget(&self) {
        let access = self.0.acr();
        access.modify(|_, w| w.dcen().clear_bit());
        access.modify(|_, w| w.dcrst().set_bit());
        access.modify(|_, w| w.dcrst().clear_bit().dcen().set_bit());
    }

    /// Waits for the change that began; flags of errors are taken back by the next.
    fn wait(&self, longest: Duration) -> Result<(), Refused> {
        let begun = now();
        while self.0.sr().read().bsy().bit() {
            if span(begun, now()) > longest {
                return Err(Refused(NorFlashErrorKind::Other));
            }
        }
        match self.0.sr().read().bits() & ERRORS {
            0 => Ok(()),
            _ => Err(Refused(NorFlashErrorKind::Other)),
        }
    }

    fn erase_sector(&self, number: u8) -> Result<(), Refused> {
        self.clear_errors();
        // SAFETY: the number is one of the two sectors', in the second bank.
        let sector = |w: &mut pac::flash::cr::W| unsafe {
            w.psize().psize32().ser().set_bit().snb().bits(number);
        };
        self.0.cr().write(|w| {
            sector(w);
            w
        });
        self.0.cr().write(|w| {
            sector(w);
            w.strt().set_bit()
        });
        self.wait(LONGEST_ERASE)
    }

    fn write_word(&self, at: usize, word: [u8; WORD]) -> Result<(), Refused> {
        self.clear_errors();
        self.0.cr().write(|w| w.psize().psize32().pg().set_bit());
        // SAFETY: `check_write` has found it aligned and within the two sectors, where nothing but
        // the store is; volatile, because it is an order to the controller.
        unsafe { (at as *mut u32).write_volatile(u32::from_ne_bytes(word)) }
        self.wait(LONGEST_WRITE)
    }

    fn clear_errors(&self) {
        // SAFETY: each of these flags is cleared by a one, the others have no use for one.
        self.0.sr().write(|w| unsafe { w.bits(ERRORS) });
    }
}

/// OPERR, WRPERR, PGAERR, PGPERR, PGSERR of the status register (RM0090, 3.9.7).
const ERRORS: u32 = 0b1111_0010;

impl ErrorType for Flash {
    type Error = Refused;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    #[inline(never)]
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Refused> {
        let offset = offset as usize;
        let end = offset.saturating_add(bytes.len());
        if end > self.capacity() {
            return Err(Refused(NorFlashErrorKind::OutOfBounds));
        }
        for (byte, at) in bytes.iter_mut().zip(START + offset..) {
            // SAFETY: within the two sectors, see above; volatile, because the controller changes it.
            *byte = unsafe { (at as *const u8).read_volatile() };
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        SECTORS * SECTOR
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Refused> {
        check_erase(self, from, to).map_err(Refused)?;
        let sectors = from as usize / SECTOR..to as usize / SECTOR;
        self.unlocked(|flash| {
            let mut sectors = sectors;
            sectors.try_for_each(|sector| flash.erase_sector(FIRST_SECTOR + sector as u8))
        })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Refused> {
        check_write(self, offset, bytes.len()).map_err(Refused)?;
        let (words, _) = bytes.as_chunks();
        let mut places = words.iter().zip((START + offset as usize..).step_by(WORD));
        self.unlocked(|flash| places.try_for_each(|(word, at)| flash.write_word(at, *word)))
    }
}
