//! The sensors on their buses and interrupt lines.
//!
//! The chips are shared with whoever built them, so that a test can look into
//! one between two runs; the emulated part reaches them through the bus peers
//! of this module, at the instants of the bytes on the wire.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rigless::chip::{Timeline, spi};
use rigless::device::Level;
use rigless::snapshot::Store;
use rigless::soc::stm32f427::Stm32f427;
use rigless::soc::stm32f427::peripherals::gpio::Pin;
use rigless::soc::stm32f427::peripherals::spi::Select;

use super::reflex_f427::{CHIPS_SPI, SELECTS, SensorLine, Wire};
use chip_models::{I2cChip, OfDies, SharedChips, SpiChip};

/// The chips of the board, each shared with its owner.
#[derive(Clone)]
pub struct Sensors {
    /// The inertial sensor, on I2C.
    pub imu: Arc<Mutex<dyn I2cChip>>,
    /// The dies with a clock of their own, on one SPI bus.
    pub dies: OfDies<Arc<Mutex<dyn SpiChip>>>,
}

impl From<&SharedChips> for Sensors {
    fn from(chips: &SharedChips) -> Self {
        Self {
            imu: chips.imu.clone(),
            dies: (chips.dies.each_ref()).map(|die| -> Arc<Mutex<dyn SpiChip>> { die.clone() }),
        }
    }
}

impl fmt::Debug for Sensors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Sensors")
    }
}

impl Sensors {
    /// Hangs the chips on the emulator's bus, as the board is wired; the inertial sensor's is ours.
    pub(super) fn attach(&self, soc: &mut Stm32f427) {
        let select = |Wire { port, pin, .. }| Select {
            port,
            pin: Pin::new(pin).expect("a port has sixteen pins"),
            active: Level::Low,
        };
        let spi = &mut soc.spi[CHIPS_SPI];
        for (die, wired) in self.dies.iter().zip(SELECTS) {
            spi.attach_selected(SpiPeer(Arc::clone(die)), select(wired));
        }
    }

    /// Produces every sample due until `now_ns`.
    pub(super) fn advance(&self, now_ns: u64) {
        lock(&self.imu).advance(now_ns);
        for die in &self.dies {
            lock(die).advance(now_ns);
        }
    }

    /// Level of every interrupt line, and when one of them may change next.
    pub(super) fn lines(&self) -> ([bool; SensorLine::ALL.len()], u64) {
        let imu = lock(&self.imu);
        let mut levels = [false; SensorLine::ALL.len()];
        levels[SensorLine::ImuReady as usize] = imu.interrupt();
        let mut next_ns = imu.next_event();
        for (die, line) in self.dies.iter().zip(SensorLine::OF_DIES) {
            let die = lock(die);
            levels[line as usize] = die.interrupt();
            next_ns = next_ns.min(die.next_event());
        }
        (levels, next_ns)
    }
}

/// A chip that panicked is reported by that panic, not by its lock.
fn lock<T: ?Sized>(chip: &Mutex<T>) -> MutexGuard<'_, T> {
    chip.lock().unwrap_or_else(PoisonError::into_inner)
}

struct SpiPeer(Arc<Mutex<dyn SpiChip>>);

impl fmt::Debug for SpiPeer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SpiPeer")
    }
}

impl Store for SpiPeer {}

impl spi::Peer for SpiPeer {
    fn transfer(&mut self, mosi: u32, bits: u8, context: &mut Timeline<'_, '_>) -> u32 {
        let mut chip = lock(&self.0);
        let now_ns = context.now().0;
        // A 16-bit frame is two bytes to the chip, the first one on top.
        (0..bits / 8).rev().fold(0, |miso, byte| {
            let mosi = (mosi >> (8 * byte)) as u8;
            miso << 8 | u32::from(chip.transfer(now_ns, mosi))
        })
    }

    fn select(&mut self, context: &mut Timeline<'_, '_>) {
        lock(&self.0).select(context.now().0);
    }

    fn deselect(&mut self, context: &mut Timeline<'_, '_>) {
        lock(&self.0).deselect(context.now().0);
    }
}
