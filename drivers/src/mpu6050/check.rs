//! Register checks that are short enough to be read behind a burst.
//!
//! A supply dip or a disturbed write leaves a chip that samples, but not as configured. Reading
//! everything back takes longer than a sample, so the registers that decide about samples are
//! read a few neighbours at a time.

use super::register::{INT_PIN_CFG, PWR_MGMT_1, SMPLRT_DIV, WHO_AM_I};
use super::{IDENTITY, ImuConfig};

/// The longest check in bytes.
pub const LONGEST_CHECK: usize = 4;

/// Neighbouring registers that are read at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Check {
    /// The first register.
    pub register: u8,
    /// How many, 1 to [`LONGEST_CHECK`].
    pub length: u8,
}

/// All checks, to be taken in turn.
pub const CHECKS: [Check; 4] = [
    Check {
        register: WHO_AM_I,
        length: 1,
    },
    Check {
        register: SMPLRT_DIV,
        length: 4,
    },
    Check {
        register: INT_PIN_CFG,
        length: 2,
    },
    Check {
        register: PWR_MGMT_1,
        length: 2,
    },
];

/// A register that does not hold what it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Its address.
    pub register: u8,
    /// What it holds.
    pub held: u8,
    /// What it should hold.
    pub expected: u8,
}

impl Check {
    /// The first of the registers read that does not hold what the configuration says.
    #[must_use]
    pub fn difference(self, config: &ImuConfig, held: [u8; LONGEST_CHECK]) -> Option<Difference> {
        let registers = (self.register..).zip(held).take(usize::from(self.length));
        registers
            .map(|(register, held)| Difference {
                register,
                held,
                expected: expected(config, register),
            })
            .find(|register| register.held != register.expected)
    }
}

fn expected(config: &ImuConfig, register: u8) -> u8 {
    let mut registers = config.registers().into_iter();
    registers
        .find(|(address, _)| *address == register)
        .map_or(IDENTITY, |(_, value)| value)
}
