//! The owner of the sensors on SPI1: sample fetches and the autopilot's orders.
//!
//! Each sits behind its own chip select on one bus, which only the owner's task uses: `Busy`
//! cannot happen.

use embedded_hal_bus::spi::AtomicDevice;
use embedded_hal_bus::util::AtomicCell;
use reflex::sensors::Input;
use reflex::settings::Settings;
use reflex::tasks::drivers::Drivers;
use stm32f4xx_hal::gpio::{AnyPin, Output};

use super::spi::Spi1;
use crate::board::clock::Delay;

/// The chips with clocks of their own.
pub type Chips = Drivers<AtomicDevice<'static, Spi1, AnyPin<Output>, Delay>>;

/// Takes the bus and a chip select for each input, in their order, and sets the sensors up.
///
/// One that does not answer is named in the log and tried again at every order.
pub fn start(
    bus: &'static AtomicCell<Spi1>,
    selects: [AnyPin<Output>; Input::OF_CHIPS.len()],
    settings: &Settings,
) -> Chips {
    let devices = selects.map(|select| {
        let Ok(device) = AtomicDevice::new(bus, select, Delay);
        device
    });
    let mut chips = Chips::new(devices, settings);
    for input in Input::OF_CHIPS {
        if let Err(error) = chips.set_up(input) {
            defmt::error!("{=str} is not used: {}", input.name(), error);
        }
    }
    chips
}
