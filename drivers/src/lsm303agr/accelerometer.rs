//! Accelerometer half: threshold interrupt on high-passed data, samples.

use embedded_hal::spi::SpiDevice;

use super::{
    ACCELEROMETER_IDENTITY, AccelCounts, AccelInterrupt, AccelOutput, AccelPin, AccelThreshold,
    Status,
    port::Port,
    register::{
        CTRL_REG3_A, INT1_SRC_A, INT1_THS_A, OUT_X_L_A, REFERENCE_A, STATUS_REG_A, WHO_AM_I_A,
    },
};
use crate::error::{Chip, Error, expect_identity};

/// The accelerometer on SPI.
///
/// The [module](super) says how it starts beside the crate `lsm303agr`.
#[derive(Debug)]
pub struct Accelerometer<SPI> {
    port: Port<SPI>,
}

impl<SPI: SpiDevice> Accelerometer<SPI> {
    /// Takes the bus; nothing is sent yet.
    pub const fn new(spi: SPI) -> Self {
        Self {
            port: Port::new(spi, Chip::Lsm303agrAccelerometer),
        }
    }

    /// Checks WHO_AM_I_A.
    ///
    /// # Errors
    /// The bus's; `WrongIdentity`.
    pub fn check_identity(&mut self) -> Result<(), Error<SPI::Error>> {
        let found = self.port.read(WHO_AM_I_A)?;
        expect_identity(self.port.chip(), ACCELEROMETER_IDENTITY, found)
    }

    /// Checks data rate, full scale and resolution by reading only.
    ///
    /// Block update and SPI must be enabled too.
    ///
    /// # Errors
    /// The bus's; `ReadBack` naming the register.
    pub fn verify_output(&mut self, output: AccelOutput) -> Result<(), Error<SPI::Error>> {
        self.verify_registers(output.registers())
    }

    /// Writes the whole threshold interrupt, checks it and re-arms it.
    ///
    /// What was pending is cleared.
    ///
    /// Also turns the FIFO off, which shares a register with the latch. 14 transactions.
    ///
    /// # Errors
    /// The bus's; `ReadBack` naming the register.
    pub fn configure_interrupt(
        &mut self,
        interrupt: AccelInterrupt,
    ) -> Result<(), Error<SPI::Error>> {
        for (address, value) in interrupt.registers() {
            self.port.write_checked(address, value)?;
        }
        self.rearm()?;
        self.clear_request()
    }

    /// Checks by reading what [`Self::configure_interrupt`] wrote.
    ///
    /// # Errors
    /// The bus's; `ReadBack` naming the first register that differs.
    pub fn verify_interrupt(&mut self, interrupt: AccelInterrupt) -> Result<(), Error<SPI::Error>> {
        self.verify_registers(interrupt.registers())
    }

    /// Chooses what drives INT_1_XL, and checks it.
    ///
    /// # Errors
    /// The bus's; `ReadBack`.
    pub fn set_pin(&mut self, pin: AccelPin) -> Result<(), Error<SPI::Error>> {
        self.port.write_checked(CTRL_REG3_A, pin.bits())
    }

    /// Writes the threshold and checks it: two transactions of two bytes.
    ///
    /// # Errors
    /// The bus's; `ReadBack`.
    pub fn set_threshold(&mut self, threshold: AccelThreshold) -> Result<(), Error<SPI::Error>> {
        self.port.write_checked(INT1_THS_A, threshold.code())
    }

    /// Snaps the high-pass filter (`ResetByReading`) to the present sample.
    ///
    /// From then on the interrupt means "changed by more than the threshold since this call".
    ///
    /// # Errors
    /// The bus's.
    pub fn rearm(&mut self) -> Result<(), Error<SPI::Error>> {
        self.port.read(REFERENCE_A).map(|_| ())
    }

    /// Clears a latched request, by reading what the generator found.
    ///
    /// # Errors
    /// The bus's.
    pub fn clear_request(&mut self) -> Result<(), Error<SPI::Error>> {
        self.port.read(INT1_SRC_A).map(|_| ())
    }

    /// Reads the status bits.
    ///
    /// # Errors
    /// The bus's.
    pub fn status(&mut self) -> Result<Status, Error<SPI::Error>> {
        self.port.read(STATUS_REG_A).map(Status)
    }

    /// Reads the newest sample, unfiltered: one burst of seven bytes.
    ///
    /// # Errors
    /// The bus's.
    pub fn read_sample(&mut self) -> Result<AccelCounts, Error<SPI::Error>> {
        self.port.read_axes(OUT_X_L_A).map(AccelCounts)
    }

    fn verify_registers<const N: usize>(
        &mut self,
        registers: [(u8, u8); N],
    ) -> Result<(), Error<SPI::Error>> {
        for (address, value) in registers {
            self.port.expect(address, 0xFF, value)?;
        }
        Ok(())
    }
}
