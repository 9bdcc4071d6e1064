//! Three-wire SPI behind a full-duplex master.
//!
//! Both dies have one bidirectional data pin. On this board MOSI reaches it
//! through a resistor and MISO directly, so MISO shows what the master sends
//! until the chip drives the pin, in the data bytes of a read.
//!
//! The accelerometer die wakes in four-wire mode: it accepts writes, but its
//! answers go to an output that has no pin in this package. Only SPI_ENABLE
//! (CTRL_REG4_A bit 0) turns the data pin round, and until then a read returns
//! the master's own bytes. ST's own three-wire code sets that bit before it
//! reads anything. The magnetometer die has three wires from the start.

/// What the byte now being clocked is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Byte {
    /// The command: address and direction.
    Command,
    /// Data to this register.
    Write(u8),
    /// Data from this register.
    Read(u8),
}

/// How the command byte gives the address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Addressing {
    /// Accelerometer: bit 6 asks for auto-increment, bits 5..0 are the address.
    IncrementOnRequest,
    /// Magnetometer: bits 6..0 are the address, which always increments.
    IncrementAlways,
}

/// State of the transaction between select and deselect.
#[derive(Clone, Copy, Debug)]
pub struct Transaction {
    addressing: Addressing,
    selected: bool,
    command: Option<Command>,
}

#[derive(Clone, Copy, Debug)]
struct Command {
    read: bool,
    increment: bool,
    address: u8,
}

impl Transaction {
    /// An unselected port.
    pub fn new(addressing: Addressing) -> Self {
        Self {
            addressing,
            selected: false,
            command: None,
        }
    }

    /// The next byte is a command.
    pub fn select(&mut self) {
        self.selected = true;
        self.command = None;
    }

    /// Ends the transaction.
    pub fn deselect(&mut self) {
        self.selected = false;
        self.command = None;
    }

    /// What eight more clocks mean; `None` when the chip is not selected.
    pub fn clock(&mut self, mosi: u8) -> Option<Byte> {
        if !self.selected {
            return None;
        }
        let Some(command) = &mut self.command else {
            self.command = Some(self.addressing.decode(mosi));
            return Some(Byte::Command);
        };
        let address = command.address;
        if command.increment {
            command.address = (address + 1) & self.addressing.mask();
        }
        Some(match command.read {
            true => Byte::Read(address),
            false => Byte::Write(address),
        })
    }
}

impl Addressing {
    fn mask(self) -> u8 {
        match self {
            Self::IncrementOnRequest => 0x3F,
            Self::IncrementAlways => 0x7F,
        }
    }

    fn decode(self, byte: u8) -> Command {
        Command {
            read: byte & 0x80 != 0,
            increment: self == Self::IncrementAlways || byte & 0x40 != 0,
            address: byte & self.mask(),
        }
    }
}
