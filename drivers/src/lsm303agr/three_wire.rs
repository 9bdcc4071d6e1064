//! Keeps the accelerometer answering on SPI while another driver writes to it.
//!
//! The chip's SPI has three wires. Until bit 0 of CTRL_REG4_A (`SPI_ENABLE`) is set, the
//! accelerometer takes writes and drives nothing on a read; ST's own SPI examples set it before
//! the first read. The crate `lsm303agr` writes that register from a copy whose bit 0 is zero.

use embedded_hal::spi::{ErrorType, Operation, SpiDevice};

use super::register::CTRL_REG4_A;

const SPI_ENABLE: u8 = 0x01;
const INCREMENT: u8 = 0x40;
/// Longest write, address included, in which CTRL_REG4_A is looked for.
const LONGEST_WRITE: usize = 8;

/// A `SpiDevice` that sets `SPI_ENABLE` in each write to CTRL_REG4_A.
///
/// It looks into transactions that consist of one `write` of up to 8 bytes or of one
/// `transfer_in_place`: all that `lsm303agr` and this crate send. Others pass as they are.
#[derive(Debug)]
pub struct ThreeWire<SPI> {
    spi: SPI,
}

impl<SPI: SpiDevice> ThreeWire<SPI> {
    /// Sets `SPI_ENABLE`, all other bits of CTRL_REG4_A to 0 as at power-up.
    ///
    /// To be called before the first read. That the chip answers is shown by its identity later.
    ///
    /// # Errors
    /// The bus's error.
    pub fn enable(mut spi: SPI) -> Result<Self, SPI::Error> {
        spi.write(&[CTRL_REG4_A, SPI_ENABLE])?;
        Ok(Self { spi })
    }
}

impl<SPI: SpiDevice> ErrorType for ThreeWire<SPI> {
    type Error = SPI::Error;
}

impl<SPI: SpiDevice> SpiDevice for ThreeWire<SPI> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), SPI::Error> {
        match operations {
            [Operation::Write(bytes)] => {
                let mut copy = [0; LONGEST_WRITE];
                let Some(frame) = copy.get_mut(..bytes.len()) else {
                    return self.spi.transaction(operations);
                };
                frame.copy_from_slice(bytes);
                set_spi_enable(frame);
                self.spi.write(frame)
            }
            [Operation::TransferInPlace(frame)] => {
                set_spi_enable(frame);
                self.spi.transaction(operations)
            }
            _ => self.spi.transaction(operations),
        }
    }
}

/// Sets bit 0 of the byte that lands in CTRL_REG4_A, if one does.
fn set_spi_enable(frame: &mut [u8]) {
    let Some((&mut command, values)) = frame.split_first_mut() else {
        return;
    };
    // A read has bit 7 set, so it seems to start behind the register and is left alone.
    let first = command & !INCREMENT;
    let Some(distance) = CTRL_REG4_A.checked_sub(first) else {
        return;
    };
    if distance > 0 && command & INCREMENT == 0 {
        return;
    }
    if let Some(value) = values.get_mut(usize::from(distance)) {
        *value |= SPI_ENABLE;
    }
}
