//! Bytes on the SPI bus: one register or one burst per transaction.

use embedded_hal::spi::SpiDevice;

use crate::error::{Chip, Error, expect_register};

const READ: u8 = 0x80;
/// Address increments in a burst; every magnetometer address has this bit.
const INCREMENT: u8 = 0x40;

/// One half of the chip behind its chip select.
#[derive(Debug)]
pub(super) struct Port<SPI> {
    spi: SPI,
    chip: Chip,
}

impl<SPI: SpiDevice> Port<SPI> {
    pub(super) const fn new(spi: SPI, chip: Chip) -> Self {
        Self { spi, chip }
    }

    pub(super) fn chip(&self) -> Chip {
        self.chip
    }

    pub(super) fn read(&mut self, address: u8) -> Result<u8, Error<SPI::Error>> {
        let mut frame = [READ | address, 0];
        self.spi.transfer_in_place(&mut frame).map_err(Error::Bus)?;
        let [_, value] = frame;
        Ok(value)
    }

    pub(super) fn read_pair(&mut self, first: u8) -> Result<[u8; 2], Error<SPI::Error>> {
        let mut frame = [READ | INCREMENT | first, 0, 0];
        self.spi.transfer_in_place(&mut frame).map_err(Error::Bus)?;
        let [_, low, high] = frame;
        Ok([low, high])
    }

    /// Three 16-bit values, low byte first: one burst, so all of one sample.
    pub(super) fn read_axes(&mut self, first: u8) -> Result<[i16; 3], Error<SPI::Error>> {
        let mut frame = [READ | INCREMENT | first, 0, 0, 0, 0, 0, 0];
        self.spi.transfer_in_place(&mut frame).map_err(Error::Bus)?;
        let [_, xl, xh, yl, yh, zl, zh] = frame;
        Ok([[xl, xh], [yl, yh], [zl, zh]].map(i16::from_le_bytes))
    }

    pub(super) fn write(&mut self, address: u8, value: u8) -> Result<(), Error<SPI::Error>> {
        self.spi.write(&[address, value]).map_err(Error::Bus)
    }

    pub(super) fn write_pair(
        &mut self,
        first: u8,
        [low, high]: [u8; 2],
    ) -> Result<(), Error<SPI::Error>> {
        self.spi
            .write(&[INCREMENT | first, low, high])
            .map_err(Error::Bus)
    }

    pub(super) fn write_axes(
        &mut self,
        first: u8,
        axes: [i16; 3],
    ) -> Result<(), Error<SPI::Error>> {
        let [[xl, xh], [yl, yh], [zl, zh]] = axes.map(i16::to_le_bytes);
        self.spi
            .write(&[INCREMENT | first, xl, xh, yl, yh, zl, zh])
            .map_err(Error::Bus)
    }

    /// The register must hold `expected` in the bits of `mask`.
    pub(super) fn expect(
        &mut self,
        address: u8,
        mask: u8,
        expected: u8,
    ) -> Result<(), Error<SPI::Error>> {
        let read = self.read(address)?;
        expect_register(self.chip, address, (read & !mask) | (expected & mask), read)
    }

    pub(super) fn write_checked(
        &mut self,
        address: u8,
        value: u8,
    ) -> Result<(), Error<SPI::Error>> {
        self.write(address, value)?;
        self.expect(address, 0xFF, value)
    }

    /// Sets the bits of `mask` to `bits`; the others keep what the chip holds.
    pub(super) fn change_checked(
        &mut self,
        address: u8,
        mask: u8,
        bits: u8,
    ) -> Result<(), Error<SPI::Error>> {
        let held = self.read(address)?;
        self.write_checked(address, (held & !mask) | (bits & mask))
    }
}
