//! What a board sees of a chip: bus entries, an interrupt pin and a deadline.
//!
//! Faults (silence, stuck lines, wrong bytes) wrap a chip behind these traits.

/// A chip as seen beside its bus.
pub trait Chip: Send {
    /// Produces every sample and pin change due until `now_ns`.
    fn advance(&mut self, now_ns: u64);
    /// The next instant at which the interrupt pin can change, in ns.
    ///
    /// `u64::MAX` when nothing is due, for example in sleep.
    fn next_event(&self) -> u64;
    /// Level of the interrupt pin at the last instant the chip was advanced to.
    fn interrupt(&self) -> bool;
}

/// A chip on an I2C bus, seen byte by byte.
pub trait I2cChip: Chip {
    /// START or repeated START with an address; whether the chip acknowledges.
    fn start(&mut self, now_ns: u64, address: u8, read: bool) -> bool;
    /// A byte from the master; whether the chip acknowledges.
    fn write(&mut self, now_ns: u64, byte: u8) -> bool;
    /// A byte to the master, who answers NACK when it is the `last`.
    fn read(&mut self, now_ns: u64, last: bool) -> u8;
    /// STOP condition.
    fn stop(&mut self, now_ns: u64);
}

/// A chip on an SPI bus, seen byte by byte while its chip select is active.
pub trait SpiChip: Chip {
    /// Chip select becomes active: the next byte is a command.
    fn select(&mut self, now_ns: u64);
    /// Eight clocks: the byte on MOSI in, the byte seen on MISO out.
    fn transfer(&mut self, now_ns: u64, mosi: u8) -> u8;
    /// Chip select becomes inactive.
    fn deselect(&mut self, now_ns: u64);
}

impl<C: Chip + ?Sized> Chip for Box<C> {
    fn advance(&mut self, now_ns: u64) {
        (**self).advance(now_ns);
    }

    fn next_event(&self) -> u64 {
        (**self).next_event()
    }

    fn interrupt(&self) -> bool {
        (**self).interrupt()
    }
}

impl<C: SpiChip + ?Sized> SpiChip for Box<C> {
    fn select(&mut self, now_ns: u64) {
        (**self).select(now_ns);
    }

    fn transfer(&mut self, now_ns: u64, mosi: u8) -> u8 {
        (**self).transfer(now_ns, mosi)
    }

    fn deselect(&mut self, now_ns: u64) {
        (**self).deselect(now_ns);
    }
}
