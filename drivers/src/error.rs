//! What can go wrong between a driver and its chip, and in which register.

use core::fmt;

use crate::registers::{lsm303agr, mpu6050};

/// The part of a package that a driver talks to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Chip {
    /// Accelerometer half of the LSM303AGR.
    Lsm303agrAccelerometer,
    /// Magnetometer half of the LSM303AGR.
    Lsm303agrMagnetometer,
    /// MPU6050.
    Mpu6050,
}

impl Chip {
    /// The part's name as its datasheet spells it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lsm303agrAccelerometer => "LSM303AGR accelerometer",
            Self::Lsm303agrMagnetometer => "LSM303AGR magnetometer",
            Self::Mpu6050 => "MPU6050",
        }
    }

    /// Name of a register that this crate writes; `?` for any other.
    #[must_use]
    pub const fn register_name(self, address: u8) -> &'static str {
        match self {
            Self::Lsm303agrAccelerometer => lsm303agr::accelerometer_name(address),
            Self::Lsm303agrMagnetometer => lsm303agr::magnetometer_name(address),
            Self::Mpu6050 => mpu6050::name(address),
        }
    }
}

/// Failure of one driver call; `E` is the bus's own error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Error<E> {
    /// The bus failed; nothing is known about the chip's registers.
    Bus(E),
    /// Another chip, or none, answered at this address.
    WrongIdentity {
        /// The chip that was asked.
        chip: Chip,
        /// Its WHO_AM_I by the datasheet.
        expected: u8,
        /// What was read.
        found: u8,
    },
    /// A register does not hold what was written.
    ReadBack {
        /// The chip that was asked.
        chip: Chip,
        /// Address of the register.
        register: u8,
        /// What it should hold.
        wrote: u8,
        /// What it holds.
        read: u8,
    },
}

impl<E: fmt::Debug> fmt::Display for Error<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "bus error {error:?}: recover the bus, then retry"),
            Self::WrongIdentity {
                chip,
                expected,
                found,
            } => write!(
                f,
                "{}: WHO_AM_I is {found:#04x}, expected {expected:#04x}: check wiring and part",
                chip.name()
            ),
            Self::ReadBack {
                chip,
                register,
                wrote,
                read,
            } => write!(
                f,
                "{}: register {register:#04x} ({}) holds {read:#04x}, expected {wrote:#04x}: \
                 configure the chip again",
                chip.name(),
                chip.register_name(*register)
            ),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for Error<E> {}

/// `Ok` where a register holds what it should, else the error that names it.
pub(crate) fn expect_register<E>(
    chip: Chip,
    register: u8,
    wrote: u8,
    read: u8,
) -> Result<(), Error<E>> {
    if wrote == read {
        Ok(())
    } else {
        Err(Error::ReadBack {
            chip,
            register,
            wrote,
            read,
        })
    }
}

/// `Ok` where a chip identifies itself as it should.
pub(crate) fn expect_identity<E>(chip: Chip, expected: u8, found: u8) -> Result<(), Error<E>> {
    if expected == found {
        Ok(())
    } else {
        Err(Error::WrongIdentity {
            chip,
            expected,
            found,
        })
    }
}
