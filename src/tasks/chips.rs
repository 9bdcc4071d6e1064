//! The chips that interrupt by themselves: what their owner brings to the autopilot.

use crate::app::{Autopilot, ChipOrder, ChipSetting, Next, OrderError, Recorder};
use crate::graph::ControlLogic;
use crate::sensors::{Cause, Input};
use crate::time::Instant;
use crate::units::{MagneticField, SpecificForce};

/// What a chip measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// Specific force.
    Accel(SpecificForce),
    /// Magnetic field.
    Mag(MagneticField),
}

/// A sample of a chip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// What was measured.
    pub reading: Reading,
    /// Why it was read.
    pub cause: Cause,
}

impl Sample {
    /// Hands it to the autopilot with its stamp.
    pub fn deliver<R: Recorder, L: ControlLogic>(
        self,
        autopilot: &mut Autopilot<R, L>,
        at: Instant,
    ) -> Next {
        match self.reading {
            Reading::Accel(force) => autopilot.on_chip_accel(at, force, self.cause),
            Reading::Mag(field) => autopilot.on_chip_mag(at, field, self.cause),
        }
    }
}

/// What a chip did for an order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obeyed {
    /// The sample that belongs to the order.
    pub sample: Option<Sample>,
    /// What the chip interrupts for from now on.
    pub setting: ChipSetting,
}

/// The chips of a board that interrupt by themselves.
pub trait Chips {
    /// Reads the sample of an input that an interrupt announced, and lets the pin fall.
    ///
    /// # Errors
    /// The bus's.
    fn fetch(&mut self, input: Input) -> Result<Sample, OrderError>;

    /// Carries out an order and checks it.
    ///
    /// # Errors
    /// The bus's, a register that does not hold what was written, a chip that is not there.
    fn execute(&mut self, order: ChipOrder) -> Result<Obeyed, OrderError>;
}
