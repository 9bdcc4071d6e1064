//! Lends an embedded-hal 1.0 bus and delay to a crate that speaks 0.2.
//!
//! `mpu6050` 0.1 owns what it is given and has no `release()`. A [`Lent`] borrows instead, so the
//! crate can be dropped after start-up and the bus then be handed to its interrupt-driven owner.

use embedded_hal::{delay::DelayNs, i2c::I2c};
use embedded_hal_02::blocking::{delay::DelayMs, i2c};

/// A bus or a delay on loan, seen through the traits of embedded-hal 0.2.
#[derive(Debug)]
pub struct Lent<'a, T>(pub &'a mut T);

impl<T: I2c> i2c::Write for Lent<'_, T> {
    type Error = T::Error;

    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), T::Error> {
        self.0.write(address, bytes)
    }
}

impl<T: I2c> i2c::WriteRead for Lent<'_, T> {
    type Error = T::Error;

    fn write_read(&mut self, address: u8, bytes: &[u8], into: &mut [u8]) -> Result<(), T::Error> {
        self.0.write_read(address, bytes, into)
    }
}

impl<T: DelayNs> DelayMs<u8> for Lent<'_, T> {
    fn delay_ms(&mut self, ms: u8) {
        self.0.delay_ms(u32::from(ms));
    }
}
