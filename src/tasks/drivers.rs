//! Which driver delivers which input of the chips with clocks of their own.

use embedded_hal::spi::SpiDevice;
use reflex_drivers::lsm303agr::halves::{Half, Halves, Rates};
use reflex_drivers::orders::{ComparingSensor, Obeyed, Sample};
use reflex_drivers::quantity::Seconds;

use super::chips::Chips;
use crate::app::{ChipOrder, OrderError};
use crate::config::{CHIP_ACCEL_RATE, CHIP_MAG_RATE, CHIP_MOUNTING};
use crate::sensors::Input;
use crate::settings::Settings;
use crate::time::seconds;

/// The rates that the configuration asks for.
const LSM303AGR_RATES: Rates = match Rates::from_hz(CHIP_ACCEL_RATE, CHIP_MAG_RATE) {
    Some(rates) => rates,
    None => panic!("the LSM303AGR has no such rates"),
};

/// The chips' drivers; each sensor is behind a chip select.
#[derive(Debug)]
pub struct Drivers<D> {
    lsm303agr: Halves<D, D>,
}

impl<D: SpiDevice> Drivers<D> {
    /// Takes the bus handle of each input, in the order of [`Input::OF_CHIPS`]; nothing is sent yet.
    pub fn new([accel, mag]: [D; Input::OF_CHIPS.len()], settings: &Settings) -> Self {
        // Every run re-arms the references, and the failsafe runs at the latest.
        let longest_hold = Seconds(seconds(settings.failsafe));
        Self {
            lsm303agr: Halves::new(accel, mag, LSM303AGR_RATES, longest_hold),
        }
    }

    /// Sets the sensor of an input up; one that fails is set up again at its next order.
    ///
    /// # Errors
    /// The bus's, a register that does not hold what was written, a chip that is not there.
    pub fn set_up(&mut self, input: Input) -> Result<(), OrderError> {
        self.with(input, |sensor| sensor.set_up())
    }

    /// Has the sensor of an input do something.
    fn with<T>(
        &mut self,
        input: Input,
        work: impl FnOnce(&mut dyn ComparingSensor) -> Result<T, OrderError>,
    ) -> Result<T, OrderError> {
        match input {
            Input::ChipAccel => work(&mut self.lsm303agr.half(Half::Accel)),
            Input::ChipMag => work(&mut self.lsm303agr.half(Half::Mag)),
            Input::Gyro | Input::Accel | Input::Turned | Input::Command | Input::Owed => {
                Err(OrderError::Identity)
            }
        }
    }
}

impl<D: SpiDevice> Chips for Drivers<D> {
    fn fetch(&mut self, input: Input) -> Result<Sample, OrderError> {
        self.with(input, |sensor| sensor.fetch()).map(in_body)
    }

    fn execute(&mut self, order: ChipOrder) -> Result<Obeyed, OrderError> {
        let obeyed = self.with(order.input, |sensor| sensor.execute(order.action))?;
        let sample = obeyed.sample.map(in_body);
        Ok(Obeyed { sample, ..obeyed })
    }
}

/// Along the body's axes.
fn in_body(sample: Sample) -> Sample {
    let axes = CHIP_MOUNTING.turned(sample.axes);
    Sample { axes, ..sample }
}
