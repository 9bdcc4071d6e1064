//! Two open-drain wires, on them a chip cut off in the middle of a transfer.

use std::{cell::RefCell, convert::Infallible, rc::Rc};

use embedded_hal::{
    delay::DelayNs,
    digital::{ErrorType, InputPin, OutputPin},
};

/// What the chip was doing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Doing {
    Idle,
    /// Bits of `byte` sent so far, 8 being the master's acknowledge bit.
    Sending {
        byte: u8,
        bits: u8,
    },
    /// Bits received so far of the present byte.
    Receiving {
        bits: u8,
    },
    /// It holds SDA low to acknowledge a byte.
    Acknowledging,
    /// SDA is shorted to ground.
    Shorted,
}

/// A chip that was cut off with SCL high.
#[derive(Clone, Copy, Debug)]
pub struct Chip(Doing);

impl Chip {
    /// `bits` of `byte` are done and the next one is on the wire.
    pub fn sending(byte: u8, bits: u8) -> Self {
        Self(Doing::Sending { byte, bits })
    }

    /// `bits` of a byte have been taken.
    pub fn receiving(bits: u8) -> Self {
        Self(Doing::Receiving { bits })
    }

    /// A byte was taken; its acknowledge bit is on the wire.
    pub fn acknowledging() -> Self {
        Self(Doing::Acknowledging)
    }

    /// SDA is low for ever.
    pub fn shorted() -> Self {
        Self(Doing::Shorted)
    }
}

#[derive(Debug)]
struct State {
    clock: bool,
    master_data: bool,
    chip: Doing,
    starts: u32,
    bytes_taken: u32,
}

impl State {
    fn data(&self) -> bool {
        self.master_data && !self.chip_pulls_low()
    }

    fn chip_pulls_low(&self) -> bool {
        match self.chip {
            Doing::Idle | Doing::Receiving { .. } => false,
            Doing::Sending { byte, bits } => bits < 8 && byte << bits & 0x80 == 0,
            Doing::Acknowledging | Doing::Shorted => true,
        }
    }

    fn set_clock(&mut self, high: bool) {
        if high == self.clock {
            return;
        }
        self.clock = high;
        let data = self.data();
        self.chip = match self.chip {
            // The next bit goes out when SCL falls; after an acknowledged byte comes another.
            Doing::Sending { byte, bits } if !high => Doing::Sending {
                byte,
                bits: if bits == 8 { 0 } else { bits + 1 },
            },
            Doing::Sending { bits: 8, .. } if data => Doing::Idle,
            Doing::Receiving { bits: 8 } if !high => {
                self.bytes_taken += 1;
                Doing::Acknowledging
            }
            Doing::Receiving { bits } if high => Doing::Receiving { bits: bits + 1 },
            Doing::Acknowledging if !high => Doing::Receiving { bits: 0 },
            other => other,
        };
    }

    fn set_data(&mut self, high: bool) {
        let before = self.data();
        self.master_data = high;
        let after = self.data();
        if !self.clock || before == after {
            return;
        }
        if after {
            self.chip = Doing::Idle;
        } else {
            self.starts += 1;
        }
    }
}

/// Which of the two.
#[derive(Clone, Copy, Debug)]
pub enum Line {
    Clock,
    Data,
}

/// The wires, with the chip on them.
#[derive(Clone, Debug)]
pub struct Wires(Rc<RefCell<State>>);

impl Wires {
    pub fn new(Chip(chip): Chip) -> Self {
        let state = State {
            clock: true,
            master_data: true,
            chip,
            starts: 0,
            bytes_taken: 0,
        };
        Self(Rc::new(RefCell::new(state)))
    }

    pub fn pin(&self, line: Line) -> Pin {
        Pin {
            wires: self.clone(),
            line,
        }
    }

    pub fn chip_is_idle(&self) -> bool {
        self.0.borrow().chip == Doing::Idle
    }

    pub fn is_released(&self) -> bool {
        let state = self.0.borrow();
        state.clock && state.master_data
    }

    pub fn starts(&self) -> u32 {
        self.0.borrow().starts
    }

    pub fn bytes_taken(&self) -> u32 {
        self.0.borrow().bytes_taken
    }
}

/// The master's open-drain pin on one wire.
#[derive(Debug)]
pub struct Pin {
    wires: Wires,
    line: Line,
}

impl Pin {
    fn set(&mut self, high: bool) {
        let mut state = self.wires.0.borrow_mut();
        match self.line {
            Line::Clock => state.set_clock(high),
            Line::Data => state.set_data(high),
        }
    }
}

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set(true);
        Ok(())
    }
}

impl InputPin for Pin {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        let state = self.wires.0.borrow();
        Ok(match self.line {
            Line::Clock => state.clock,
            Line::Data => state.data(),
        })
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}

/// A delay that adds up what was waited.
#[derive(Debug, Default)]
pub struct Counted {
    nanoseconds: u64,
}

impl Counted {
    pub fn microseconds(&self) -> u32 {
        u32::try_from(self.nanoseconds / 1000).unwrap()
    }
}

impl DelayNs for Counted {
    fn delay_ns(&mut self, nanoseconds: u32) {
        self.nanoseconds += u64::from(nanoseconds);
    }
}
