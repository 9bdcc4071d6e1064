//! The LSM303AGR's owner: sample fetches and the autopilot's orders over SPI1.
//!
//! Both halves sit behind their own chip select on one bus, which only the owner's task uses:
//! `Busy` cannot happen.

use embedded_hal_bus::spi::AtomicDevice;
use embedded_hal_bus::util::AtomicCell;
use reflex::settings::Settings;
use reflex::tasks::lsm303agr::Lsm303agr;
use stm32f4xx_hal::gpio::{Output, PA4, PC4};

use super::spi::Spi1;
use crate::board::clock::Delay;

type Device<CS> = AtomicDevice<'static, Spi1, CS, Delay>;

/// Both halves of the chip.
pub type Chips = Lsm303agr<Device<PA4<Output>>, Device<PC4<Output>>>;

/// Takes the bus and the chip selects, and sets both halves up.
///
/// A half that does not answer is named in the log and tried again at every order.
pub fn start(
    bus: &'static AtomicCell<Spi1>,
    (accel, mag): (PA4<Output>, PC4<Output>),
    settings: &Settings,
) -> Chips {
    let Ok(accel) = AtomicDevice::new(bus, accel, Delay);
    let Ok(mag) = AtomicDevice::new(bus, mag, Delay);
    let mut chips = Lsm303agr::new(accel, mag, settings);
    if let Err(error) = chips.set_up_accel() {
        defmt::error!("LSM303AGR accelerometer is not used: {}", error);
    }
    if let Err(error) = chips.set_up_mag() {
        defmt::error!("LSM303AGR magnetometer is not used: {}", error);
    }
    chips
}
