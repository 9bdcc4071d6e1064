//! The drivers' buses with a chip model at the other end.
//!
//! Virtual time stands still during a transaction: which sample a transaction
//! meets is what matters here, not how long its bytes take.

use std::convert::Infallible;

use embedded_hal::i2c;
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};

use chip_models::bus::{I2cChip, SpiChip};

/// A chip's SPI port at one instant.
pub struct SpiPort<'a> {
    /// The chip.
    pub chip: &'a mut dyn SpiChip,
    /// The instant.
    pub now_ns: u64,
}

impl ErrorType for SpiPort<'_> {
    type Error = Infallible;
}

impl SpiDevice for SpiPort<'_> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        let now_ns = self.now_ns;
        self.chip.select(now_ns);
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    for byte in bytes.iter() {
                        self.chip.transfer(now_ns, *byte);
                    }
                }
                Operation::TransferInPlace(bytes) => {
                    for byte in bytes.iter_mut() {
                        *byte = self.chip.transfer(now_ns, *byte);
                    }
                }
                other => unreachable!("the drivers do not use {other:?}"),
            }
        }
        self.chip.deselect(now_ns);
        Ok(())
    }
}

/// A chip's I2C port at one instant.
pub struct I2cPort<'a> {
    /// The chip.
    pub chip: &'a mut dyn I2cChip,
    /// The instant.
    pub now_ns: u64,
}

impl i2c::ErrorType for I2cPort<'_> {
    type Error = Infallible;
}

impl i2c::I2c for I2cPort<'_> {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [i2c::Operation<'_>],
    ) -> Result<(), Infallible> {
        let now_ns = self.now_ns;
        for operation in operations {
            match operation {
                i2c::Operation::Write(bytes) => {
                    assert!(self.chip.start(now_ns, address, false));
                    for byte in bytes.iter() {
                        assert!(self.chip.write(now_ns, *byte));
                    }
                }
                i2c::Operation::Read(bytes) => {
                    assert!(self.chip.start(now_ns, address, true));
                    let last = bytes.len().saturating_sub(1);
                    for (n, byte) in bytes.iter_mut().enumerate() {
                        *byte = self.chip.read(now_ns, n == last);
                    }
                }
            }
        }
        self.chip.stop(now_ns);
        Ok(())
    }
}
