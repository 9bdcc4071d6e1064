//! Magnetometer half: interrupt on the change since its offset was written.

use embedded_hal::spi::SpiDevice;

use super::{
    MAGNETOMETER_IDENTITY, MagCounts, MagInterrupt, MagOffset, MagPin, MagThreshold, Status,
    port::Port,
    register::{
        CFG_REG_A_M, CFG_REG_B_M, CFG_REG_C_M, INT_CTRL_REG_M, INT_SOURCE_REG_M, INT_THS_H_REG_M,
        INT_THS_L_REG_M, OFFSET_X_REG_L_M, OUTX_L_REG_M, STATUS_REG_M, WHO_AM_I_M,
    },
};
use crate::error::{Chip, Error, expect_identity, expect_register};

const I2C_DISABLE: u8 = 0x20;
/// COMP_TEMP_EN and OFF_CANC, of two registers.
const COMPENSATION: [(u8, u8); 2] = [(CFG_REG_A_M, 0x80), (CFG_REG_B_M, 0x02)];

/// The magnetometer on SPI.
///
/// The [module](super) says how it starts beside the crate `lsm303agr`.
#[derive(Debug)]
pub struct Magnetometer<SPI> {
    port: Port<SPI>,
}

impl<SPI: SpiDevice> Magnetometer<SPI> {
    /// Takes the bus; nothing is sent yet.
    pub const fn new(spi: SPI) -> Self {
        Self {
            port: Port::new(spi, Chip::Lsm303agrMagnetometer),
        }
    }

    /// Checks WHO_AM_I_M.
    ///
    /// # Errors
    /// The bus's; `WrongIdentity`.
    pub fn check_identity(&mut self) -> Result<(), Error<SPI::Error>> {
        let found = self.port.read(WHO_AM_I_M)?;
        expect_identity(self.port.chip(), MAGNETOMETER_IDENTITY, found)
    }

    /// Turns the I2C interface off.
    ///
    /// Traffic to the other half of the chip can then not look like I2C.
    ///
    /// # Errors
    /// The bus's; `ReadBack`.
    pub fn disable_i2c(&mut self) -> Result<(), Error<SPI::Error>> {
        self.port
            .change_checked(CFG_REG_C_M, I2C_DISABLE, I2C_DISABLE)
    }

    /// Has the chip correct its own errors: its drift with temperature, and its offset by a pulse of
    /// alternate sign before each measurement.
    ///
    /// # Errors
    /// The bus's; `ReadBack` naming the register.
    pub fn compensate(&mut self) -> Result<(), Error<SPI::Error>> {
        for (register, bit) in COMPENSATION {
            self.port.change_checked(register, bit, bit)?;
        }
        Ok(())
    }

    /// Checks by reading what [`Self::compensate`] wrote.
    ///
    /// # Errors
    /// The bus's; `ReadBack` naming the register.
    pub fn verify_compensation(&mut self) -> Result<(), Error<SPI::Error>> {
        for (register, bit) in COMPENSATION {
            self.port.expect(register, bit, bit)?;
        }
        Ok(())
    }

    /// Writes the whole threshold interrupt and checks it.
    ///
    /// What was pending is cleared.
    ///
    /// Bits of CFG_REG_B_M and CFG_REG_C_M that the crate `lsm303agr` set are kept.
    ///
    /// # Errors
    /// The bus's; `ReadBack` naming the register.
    pub fn configure_interrupt(
        &mut self,
        interrupt: MagInterrupt,
    ) -> Result<(), Error<SPI::Error>> {
        self.set_threshold(interrupt.threshold)?;
        let compare = interrupt.compare_bits();
        self.port
            .change_checked(CFG_REG_B_M, MagInterrupt::COMPARE_MASK, compare)?;
        self.port
            .write_checked(INT_CTRL_REG_M, interrupt.control())?;
        self.clear_request()?;
        self.set_pin(interrupt.pin)
    }

    /// Checks by reading what [`Self::configure_interrupt`] wrote.
    ///
    /// # Errors
    /// The bus's; `ReadBack` naming the first register that differs.
    pub fn verify_interrupt(&mut self, interrupt: MagInterrupt) -> Result<(), Error<SPI::Error>> {
        self.verify_threshold(interrupt.threshold)?;
        let compare = interrupt.compare_bits();
        self.port
            .expect(CFG_REG_B_M, MagInterrupt::COMPARE_MASK, compare)?;
        self.port
            .expect(INT_CTRL_REG_M, 0xFF, interrupt.control())?;
        self.port
            .expect(CFG_REG_C_M, MagPin::MASK, interrupt.pin.bits())
    }

    /// Chooses what drives INT_MAG, and checks it.
    ///
    /// # Errors
    /// The bus's; `ReadBack`.
    pub fn set_pin(&mut self, pin: MagPin) -> Result<(), Error<SPI::Error>> {
        self.port
            .change_checked(CFG_REG_C_M, MagPin::MASK, pin.bits())
    }

    /// Writes the threshold and checks it: two transactions of three bytes.
    ///
    /// # Errors
    /// The bus's; `ReadBack` naming the byte that differs.
    pub fn set_threshold(&mut self, threshold: MagThreshold) -> Result<(), Error<SPI::Error>> {
        self.port
            .write_pair(INT_THS_L_REG_M, threshold.code().to_le_bytes())?;
        self.verify_threshold(threshold)
    }

    fn verify_threshold(&mut self, threshold: MagThreshold) -> Result<(), Error<SPI::Error>> {
        let [low, high] = threshold.code().to_le_bytes();
        let [read_low, read_high] = self.port.read_pair(INT_THS_L_REG_M)?;
        expect_register(self.port.chip(), INT_THS_L_REG_M, low, read_low)?;
        expect_register(self.port.chip(), INT_THS_H_REG_M, high, read_high)
    }

    /// Makes `offset` the zero of output and comparator, and checks it.
    ///
    /// Two bursts of seven bytes.
    ///
    /// With `ChangeFromOffset`, writing the sample of a control run re-arms the interrupt. Samples
    /// read from then on need [`MagCounts::with_offset_restored`].
    ///
    /// # Errors
    /// The bus's; `ReadBack` naming the byte that differs.
    pub fn set_offset(&mut self, offset: MagOffset) -> Result<(), Error<SPI::Error>> {
        self.port.write_axes(OFFSET_X_REG_L_M, offset.0)?;
        let read = self.port.read_axes(OFFSET_X_REG_L_M)?;
        for ((axis, wrote), read) in (0..).zip(offset.0).zip(read) {
            let ([low, high], [read_low, read_high]) = (wrote.to_le_bytes(), read.to_le_bytes());
            let register = OFFSET_X_REG_L_M + 2 * axis;
            expect_register(self.port.chip(), register, low, read_low)?;
            expect_register(self.port.chip(), register + 1, high, read_high)?;
        }
        Ok(())
    }

    /// Clears a latched request, by reading what the comparator found.
    ///
    /// # Errors
    /// The bus's.
    pub fn clear_request(&mut self) -> Result<(), Error<SPI::Error>> {
        self.port.read(INT_SOURCE_REG_M).map(|_| ())
    }

    /// Reads the status bits.
    ///
    /// # Errors
    /// The bus's.
    pub fn status(&mut self) -> Result<Status, Error<SPI::Error>> {
        self.port.read(STATUS_REG_M).map(Status)
    }

    /// Reads the newest sample, less the offset: one burst of seven bytes.
    ///
    /// # Errors
    /// The bus's.
    pub fn read_sample(&mut self) -> Result<MagCounts, Error<SPI::Error>> {
        self.port.read_axes(OUTX_L_REG_M).map(MagCounts)
    }
}
