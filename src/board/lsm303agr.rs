//! The LSM303AGR's owner: sample fetches and the autopilot's orders over SPI1.
//!
//! [`Halves`] of `reflex-drivers` keeps the chip; this file gives it the bus and translates
//! between its words and the autopilot's. Both halves sit behind their own chip select on one
//! bus, which only the owner's task uses: `Busy` cannot happen.

use embedded_hal_bus::spi::AtomicDevice;
use embedded_hal_bus::util::AtomicCell;
use reflex::app::{Autopilot, ChipOrder, Next, OrderError, Recorder};
use reflex::config::{CHIP_ACCEL_RATE, CHIP_MAG_RATE};
use reflex::sensors::Cause;
use reflex::time::Instant;
use reflex_drivers::lsm303agr::halves::{self, Action, Half, Halves, Rates};
use stm32f4xx_hal::gpio::{Output, PA4, PC4};

use crate::board::clock::Delay;
use crate::board::spi::Spi1;

type Device<CS> = AtomicDevice<'static, Spi1, CS, Delay>;

/// The rates that the configuration asks for.
const RATES: Rates = match Rates::from_hz(CHIP_ACCEL_RATE, CHIP_MAG_RATE) {
    Some(rates) => rates,
    None => panic!("the LSM303AGR has no such rates"),
};

/// Interrupts whose sample is still to be fetched: the latest of each half.
///
/// One place per half is a bounded queue that cannot overflow: a second interrupt before the
/// fetch is about the sample that the same fetch reads.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fetches {
    /// Stamp of the accelerometer's interrupt.
    pub accel: Option<Instant>,
    /// Stamp of the magnetometer's interrupt.
    pub mag: Option<Instant>,
}

impl Fetches {
    /// Takes the next one: which half, and its stamp.
    pub fn next(&mut self) -> Option<(Half, Instant)> {
        let accel = self.accel.take().map(|at| (Half::Accel, at));
        accel.or_else(|| self.mag.take().map(|at| (Half::Mag, at)))
    }
}

/// Raw counts of one half, for the autopilot.
#[derive(Clone, Copy, Debug)]
pub struct Sample(halves::Sample);

impl Sample {
    /// Hands it to the autopilot with its stamp.
    pub fn deliver<R: Recorder>(self, autopilot: &mut Autopilot<R>, at: Instant) -> Next {
        let cause = match self.0.cause {
            halves::Cause::DataReady => Cause::DataReady,
            halves::Cause::Threshold => Cause::Threshold,
            halves::Cause::Heartbeat => Cause::Heartbeat,
            halves::Cause::Rearm => Cause::Rearm,
        };
        match self.0.half {
            Half::Accel => autopilot.on_chip_accel(at, self.0.counts, cause),
            Half::Mag => autopilot.on_chip_mag(at, self.0.counts, cause),
        }
    }
}

/// Both halves of the chip.
pub struct Chips(Halves<Device<PA4<Output>>, Device<PC4<Output>>>);

impl Chips {
    /// Takes the bus and the chip selects, and sets both halves up.
    ///
    /// A half that does not answer is named in the log and tried again at every order.
    pub fn start(bus: &'static AtomicCell<Spi1>, (accel, mag): (PA4<Output>, PC4<Output>)) -> Self {
        let Ok(accel) = AtomicDevice::new(bus, accel, Delay);
        let Ok(mag) = AtomicDevice::new(bus, mag, Delay);
        let mut halves = Halves::new(accel, mag, RATES);
        if let Err(error) = halves.set_up_accel() {
            defmt::error!("LSM303AGR accelerometer is not used: {}", error);
        }
        if let Err(error) = halves.set_up_mag() {
            defmt::error!("LSM303AGR magnetometer is not used: {}", error);
        }
        Self(halves)
    }

    /// Reads the sample that an interrupt announced, and lets the pin fall.
    ///
    /// # Errors
    /// The bus's.
    pub fn fetch(&mut self, half: Half) -> Result<Sample, OrderError> {
        self.0.fetch(half).map(Sample).map_err(failure)
    }

    /// Carries out an order and checks it; returns the sample that belongs to it.
    ///
    /// # Errors
    /// The bus's, a register that does not hold what was written, a chip that is not there.
    pub fn execute(&mut self, order: ChipOrder) -> Result<Option<Sample>, OrderError> {
        let (half, action) = words_of(order);
        let sample = self.0.execute(half, action).map_err(failure)?;
        Ok(sample.map(Sample))
    }
}

/// An order in the driver's words.
fn words_of(order: ChipOrder) -> (Half, Action) {
    match order {
        ChipOrder::AccelDataReady => (Half::Accel, Action::DataReady),
        ChipOrder::AccelThreshold(code) => (Half::Accel, Action::Threshold(code.into())),
        ChipOrder::AccelRearm => (Half::Accel, Action::Rearm),
        ChipOrder::AccelHeartbeat => (Half::Accel, Action::Heartbeat),
        ChipOrder::MagDataReady => (Half::Mag, Action::DataReady),
        ChipOrder::MagThreshold(code) => (Half::Mag, Action::Threshold(code)),
        ChipOrder::MagRearm => (Half::Mag, Action::Rearm),
        ChipOrder::MagHeartbeat => (Half::Mag, Action::Heartbeat),
    }
}

fn failure(error: halves::OrderError) -> OrderError {
    match error {
        halves::OrderError::Bus => OrderError::Bus,
        halves::OrderError::Identity => OrderError::Identity,
        halves::OrderError::ReadBack {
            register,
            wrote,
            read,
        } => OrderError::ReadBack {
            register,
            wrote,
            read,
        },
    }
}
