//! Orders to a chip that compares its own samples, and its answers.
//!
//! They name no chip, so that the drivers of all such chips and the code that gives the orders share
//! them. Samples and thresholds are in the SI unit of what the chip measures, or in gauss.

use crate::error::Error;

/// A sensor with a clock and an interrupt pin of its own, which compares its samples itself.
pub trait ComparingSensor {
    /// Sets the sensor up, should it be there; one that fails is set up again at its next order.
    ///
    /// # Errors
    /// The bus's, a register that does not hold what was written, a chip that is not there.
    fn set_up(&mut self) -> Result<(), OrderError>;

    /// Reads the sample that an interrupt announced, and lets the pin fall.
    ///
    /// # Errors
    /// The bus's.
    fn fetch(&mut self) -> Result<Sample, OrderError>;

    /// Carries out an order and checks it.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    fn execute(&mut self, action: ChipAction) -> Result<Obeyed, OrderError>;
}

/// What a sensor measured along the chip's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// What it measured.
    pub axes: [f32; 3],
    /// Why it was read.
    pub cause: Cause,
}

/// What a sensor did for an order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obeyed {
    /// The sample that belongs to the order.
    pub sample: Option<Sample>,
    /// What the sensor interrupts for from now on.
    pub setting: ChipSetting,
}

/// What a chip can be ordered to do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum ChipAction {
    /// Interrupt at every sample.
    DataReady,
    /// Interrupt past this change since the reference, on any axis; read back and check. The
    /// driver rounds it down, but not below the finest threshold that the chip holds.
    Threshold(f32),
    /// Make the present sample the reference, and deliver it.
    Rearm,
    /// Deliver the present sample; the chip compares with the reference that it has.
    Read,
    /// Deliver a sample and check what is programmed.
    Heartbeat,
}

/// What a chip interrupts for: its answer to an order.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum ChipSetting {
    /// Every sample.
    EverySample,
    /// A change past `level`, which serves every threshold from `from` to below `next`.
    PastThreshold {
        /// The threshold that was programmed.
        level: f32,
        /// The same; infinitely low for the finest that the chip holds.
        from: f32,
        /// The next one that the chip holds; infinite behind its largest.
        next: f32,
    },
}

impl ChipSetting {
    /// True where the chip compares.
    #[must_use]
    pub fn compares(self) -> bool {
        matches!(self, Self::PastThreshold { .. })
    }

    /// True where the chip holds the largest threshold that it can.
    #[must_use]
    pub fn is_closed(self) -> bool {
        matches!(self, Self::PastThreshold { next, .. } if next == f32::INFINITY)
    }

    /// True where this setting is also the one for another threshold.
    #[must_use]
    pub fn serves(self, threshold: f32) -> bool {
        match self {
            Self::EverySample => false,
            Self::PastThreshold { from, next, .. } => (from..next).contains(&threshold),
        }
    }
}

/// Why a sample was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[repr(u8)]
pub enum Cause {
    /// Its data-ready interrupt: every sample arrives.
    DataReady = 0,
    /// Its threshold interrupt: the chip compared, the change was past the threshold.
    Threshold = 1,
    /// A heartbeat, independent of its interrupts.
    Heartbeat = 2,
    /// Changes are measured against this very sample: the chip's own, or, where the chip compares with
    /// an older one, those that its owner takes.
    Rearm = 3,
}

impl Cause {
    /// The cause of a number, `None` past the last.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        [
            Self::DataReady,
            Self::Threshold,
            Self::Heartbeat,
            Self::Rearm,
        ]
        .get(usize::from(number))
        .copied()
    }
}

/// Why an order failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum OrderError {
    /// The bus reported an error.
    Bus,
    /// A register does not hold what was written.
    ReadBack {
        /// Its address.
        register: u8,
        /// What was written.
        wrote: u8,
        /// What it holds.
        read: u8,
    },
    /// The chip is not the one expected.
    Identity,
}

impl<E> From<Error<E>> for OrderError {
    fn from(error: Error<E>) -> Self {
        match error {
            Error::Bus(_) => Self::Bus,
            Error::WrongIdentity { .. } => Self::Identity,
            Error::ReadBack {
                register,
                wrote,
                read,
                ..
            } => Self::ReadBack {
                register,
                wrote,
                read,
            },
        }
    }
}
