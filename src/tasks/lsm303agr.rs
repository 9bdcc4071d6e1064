//! The LSM303AGR as accelerometer and magnetometer that compare.
//!
//! [`Halves`] of the drivers keeps the chip; this file says which half delivers which input.

use embedded_hal::spi::SpiDevice;
use reflex_drivers::lsm303agr::halves::{Half, Halves, Rates, Reading, Sample};
use reflex_drivers::quantity::Seconds;

use super::chips::{Chips, Obeyed};
use crate::app::{ChipOrder, OrderError};
use crate::config::{CHIP_ACCEL_RATE, CHIP_MAG_RATE};
use crate::math::Vec3;
use crate::sensors::{ChipSample, Input};
use crate::settings::Settings;
use crate::time::seconds;

/// Both halves of the chip, each behind its chip select.
#[derive(Debug)]
pub struct Lsm303agr<A, M>(Halves<A, M>);

impl<A: SpiDevice, M: SpiDevice<Error = A::Error>> Lsm303agr<A, M> {
    /// The rates that the configuration asks for, where the board has this chip.
    const RATES: Rates = match Rates::from_hz(CHIP_ACCEL_RATE, CHIP_MAG_RATE) {
        Some(rates) => rates,
        None => panic!("the LSM303AGR has no such rates"),
    };

    /// Takes the bus handles of accelerometer and magnetometer; nothing is sent yet.
    pub fn new(accel: A, mag: M, settings: &Settings) -> Self {
        // Every run re-arms the references, and the failsafe runs at the latest.
        let longest_hold = Seconds(seconds(settings.failsafe));
        Self(Halves::new(accel, mag, Self::RATES, longest_hold))
    }

    /// Sets the accelerometer up; one that fails is set up again at its next order.
    ///
    /// # Errors
    /// The bus's, a register that does not hold what was written, a chip that is not there.
    pub fn set_up_accel(&mut self) -> Result<(), OrderError> {
        self.0.set_up_accel()
    }

    /// Sets the magnetometer up; one that fails is set up again at its next order.
    ///
    /// # Errors
    /// As [`Self::set_up_accel`].
    pub fn set_up_mag(&mut self) -> Result<(), OrderError> {
        self.0.set_up_mag()
    }
}

impl<A: SpiDevice, M: SpiDevice<Error = A::Error>> Chips for Lsm303agr<A, M> {
    fn fetch(&mut self, input: Input) -> Result<ChipSample, OrderError> {
        self.0.fetch(half(input)?).map(translated)
    }

    fn execute(&mut self, order: ChipOrder) -> Result<Obeyed, OrderError> {
        let done = self.0.execute(half(order.input)?, order.action)?;
        Ok(Obeyed {
            sample: done.sample.map(translated),
            setting: done.setting,
        })
    }
}

/// The half that delivers an input.
fn half(input: Input) -> Result<Half, OrderError> {
    match input {
        Input::ChipAccel => Ok(Half::Accel),
        Input::ChipMag => Ok(Half::Mag),
        Input::Gyro | Input::Accel | Input::Turned | Input::Command | Input::Owed => {
            Err(OrderError::Identity)
        }
    }
}

fn translated(sample: Sample) -> ChipSample {
    let (input, axes) = match sample.reading {
        Reading::Accel(force) => (Input::ChipAccel, force.map(|axis| axis.0)),
        Reading::Mag(field) => (Input::ChipMag, field.map(|axis| axis.0)),
    };
    ChipSample {
        input,
        axes: Vec3::from_array(axes),
        cause: sample.cause,
    }
}
