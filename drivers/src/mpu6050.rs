//! MPU6050: configuration with read-back, motion detector, 15-byte burst.
//!
//! The crate `mpu6050` wakes the chip and checks its identity (it waits 100 ms for that). It has no
//! filter, rate, data-ready or status calls, and its `setup_motion_detection()` drops the PLL,
//! resets the accelerometer's range and turns data-ready off. So [`Mpu6050::configure`] here writes
//! every register that matters, after the crate or instead of it, and reads all of them back.
//!
//! The board reads samples without a trait, by interrupts: [`BURST_START`] and [`BURST_LENGTH`] say
//! what to read, [`ImuBurst::from_bytes`] decodes it.
//!
//! Registers follow RM-MPU-6000A; ACCEL_HPF and the motion detector, hidden since its revision 4,
//! follow revision 3.2.

mod burst;
mod check;
mod motion;
mod setup;

use embedded_hal::i2c::I2c;

pub use burst::{BURST_LENGTH, BURST_START, ImuBurst, InterruptStatus};
pub use check::{CHECKS, Check, Difference, LONGEST_CHECK};
pub use motion::{
    MotionDecrement, MotionDetector, MotionHighPass, MotionThreshold, NOMINAL_MOTION_STEP,
};
pub use setup::{AccelRange, GyroRange, ImuConfig, InterruptPin, InterruptSource, LowPass};

use crate::error::{Chip, Error, expect_identity, expect_register};
pub use crate::registers::mpu6050 as register;
use register::{ACCEL_CONFIG, PWR_MGMT_1, SIGNAL_PATH_RESET, WHO_AM_I};

/// Address on the bus with the pin AD0 low.
pub const ADDRESS: u8 = 0x68;
/// WHO_AM_I, whatever the address.
pub const IDENTITY: u8 = 0x68;

/// A reset in two steps, each with a wait behind it in us: the whole chip, then its signal paths
/// (RM-MPU-6000A, registers 104 and 107).
const RESETS: [(u8, u8); RESET_STEPS as usize] = [(PWR_MGMT_1, 0x80), (SIGNAL_PATH_RESET, 0x07)];
/// Steps of [`Mpu6050::reset`].
pub const RESET_STEPS: u8 = 2;
/// To wait behind each step, in us.
pub const RESET_WAIT_US: u64 = 100_000;

/// The MPU6050 on I2C.
#[derive(Debug)]
pub struct Mpu6050<I2C> {
    i2c: I2C,
    address: u8,
}

impl<I2C: I2c> Mpu6050<I2C> {
    /// Takes the bus; nothing is sent yet.
    pub const fn new(i2c: I2C, address: u8) -> Self {
        Self { i2c, address }
    }

    /// Checks WHO_AM_I.
    ///
    /// # Errors
    /// The bus's; `WrongIdentity`, for instance 0x70 from an MPU6500.
    pub fn check_identity(&mut self) -> Result<(), Error<I2C::Error>> {
        let found = self.read(WHO_AM_I)?;
        expect_identity(Chip::Mpu6050, IDENTITY, found)
    }

    /// A step of a reset, 0 to [`RESET_STEPS`] less one; [`RESET_WAIT_US`] is to pass behind it. The
    /// chip then sleeps until [`Self::configure`].
    ///
    /// # Errors
    /// The bus's.
    pub fn reset(&mut self, step: u8) -> Result<(), Error<I2C::Error>> {
        match RESETS.get(usize::from(step)) {
            Some(&(register, value)) => self.write(register, value),
            None => Ok(()),
        }
    }

    /// Wakes the chip, writes the whole configuration, then checks all of it.
    ///
    /// The gyro needs another 30 ms (typical) after waking until its samples are right.
    ///
    /// # Errors
    /// The bus's; `ReadBack` naming the first register that differs.
    pub fn configure(&mut self, config: &ImuConfig) -> Result<(), Error<I2C::Error>> {
        for (register, value) in config.registers() {
            self.write(register, value)?;
        }
        self.verify(config)
    }

    /// Checks every register that [`Self::configure`] wrote, by reading only.
    ///
    /// # Errors
    /// The bus's; `ReadBack` naming the first register that differs.
    pub fn verify(&mut self, config: &ImuConfig) -> Result<(), Error<I2C::Error>> {
        for (register, value) in config.registers() {
            self.expect(register, value)?;
        }
        Ok(())
    }

    /// Lets go of the motion detector's reference: nothing is detected until
    /// [`Self::take_motion_reference`].
    ///
    /// The filter's mode acts on the next value of the 1 kHz accelerometer, so one must pass between
    /// the two calls: with both writes in one period the chip never sees the reset, and the old
    /// reference stays. The next data-ready interrupt is the time for the second call.
    ///
    /// # Errors
    /// The bus's; `ReadBack`.
    pub fn release_motion_reference(
        &mut self,
        config: &ImuConfig,
    ) -> Result<(), Error<I2C::Error>> {
        let reset = config.accel_range.bits();
        self.write(ACCEL_CONFIG, reset)?;
        self.expect(ACCEL_CONFIG, reset)
    }

    /// Gives the motion detector a new reference, after [`Self::release_motion_reference`].
    ///
    /// [`MotionHighPass::Hold`] takes the first value after this call, the corners have the last one
    /// before it.
    ///
    /// # Errors
    /// The bus's; `ReadBack`.
    pub fn take_motion_reference(&mut self, config: &ImuConfig) -> Result<(), Error<I2C::Error>> {
        self.write(ACCEL_CONFIG, config.accel_config())?;
        self.expect(ACCEL_CONFIG, config.accel_config())
    }

    fn read(&mut self, register: u8) -> Result<u8, Error<I2C::Error>> {
        let mut value = [0];
        self.i2c
            .write_read(self.address, &[register], &mut value)
            .map_err(Error::Bus)?;
        let [value] = value;
        Ok(value)
    }

    fn write(&mut self, register: u8, value: u8) -> Result<(), Error<I2C::Error>> {
        self.i2c
            .write(self.address, &[register, value])
            .map_err(Error::Bus)
    }

    fn expect(&mut self, register: u8, value: u8) -> Result<(), Error<I2C::Error>> {
        let read = self.read(register)?;
        expect_register(Chip::Mpu6050, register, value, read)
    }
}
