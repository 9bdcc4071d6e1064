//! Both halves of the chip as one owner keeps them: set up, routed, read, checked.
//!
//! The crate `lsm303agr` sets rates, ranges and modes; the register layer beside this module does
//! thresholds, latches, re-arming and every read-back. Both halves sit behind their own chip
//! select on one bus, which only the owner uses.
//!
//! The owner says what each half shall do with an [`Action`], and fetches a [`Sample`] whenever
//! its pin rose. What an interrupt leads to is the owner's affair: nothing here knows of control.
//!
//! `upkeep` sets the halves up, checks them, and sets up again what was lost.

mod upkeep;

use embedded_hal::spi::SpiDevice;

use super::register::INT1_THS_A;
use super::{
    AccelPin, AccelThreshold, Accelerometer, MagOffset, MagPin, MagThreshold, Magnetometer,
};
use crate::error::Error;
pub use upkeep::Rates;
use upkeep::{accel_interrupt, mag_interrupt};

/// The chip's two halves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// Accelerometer.
    Accel,
    /// Magnetometer.
    Mag,
}

/// What a half shall do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Interrupt at every sample.
    DataReady,
    /// Interrupt past this threshold code; read back and check.
    Threshold(u16),
    /// Make the present sample the reference, and deliver it.
    Rearm,
    /// Deliver a sample and check what is programmed.
    Heartbeat,
}

/// Why a sample was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Its data-ready interrupt.
    DataReady,
    /// Its threshold interrupt.
    Threshold,
    /// A heartbeat, independent of its interrupts.
    Heartbeat,
    /// The half's reference was set to this very sample.
    Rearm,
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

/// Raw counts of one half, the magnetometer's with its offset restored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The half that was read.
    pub half: Half,
    /// Counts along the chip's axes.
    pub counts: [i16; 3],
    /// Why it was read.
    pub cause: Cause,
}

/// What drives a half's interrupt pin.
#[derive(Clone, Copy, Debug)]
enum Routing<T> {
    DataReady,
    Threshold(T),
}

impl<T> Routing<T> {
    fn cause(&self) -> Cause {
        match self {
            Self::DataReady => Cause::DataReady,
            Self::Threshold(_) => Cause::Threshold,
        }
    }
}

/// What is known about a half.
#[derive(Clone, Copy, Debug)]
struct State<T> {
    routing: Routing<T>,
    /// Its last order succeeded.
    answers: bool,
    /// Its pin was heard since its last heartbeat.
    heard: bool,
}

impl<T> State<T> {
    const UNKNOWN: Self = Self {
        routing: Routing::DataReady,
        answers: false,
        heard: true,
    };

    /// True where every sample should have been heard, and none was.
    fn is_silent(&self) -> bool {
        matches!(self.routing, Routing::DataReady) && !self.heard
    }
}

/// Both halves of the chip, each behind its chip select.
#[derive(Debug)]
pub struct Halves<A, M> {
    accel: A,
    mag: M,
    rates: Rates,
    accel_state: State<AccelThreshold>,
    mag_state: State<MagThreshold>,
    /// What the OFFSET registers hold.
    offset: MagOffset,
    /// The offset that the output registers' sample was taken under.
    output_offset: MagOffset,
}

impl<A: SpiDevice, M: SpiDevice<Error = A::Error>> Halves<A, M> {
    /// Takes the bus handles; nothing is sent until [`Self::set_up_accel`] and
    /// [`Self::set_up_mag`].
    pub const fn new(accel: A, mag: M, rates: Rates) -> Self {
        Self {
            accel,
            mag,
            rates,
            accel_state: State::UNKNOWN,
            mag_state: State::UNKNOWN,
            offset: MagOffset([0; 3]),
            output_offset: MagOffset([0; 3]),
        }
    }

    /// Reads the sample that an interrupt announced, and lets the pin fall.
    ///
    /// # Errors
    /// The bus's.
    pub fn fetch(&mut self, half: Half) -> Result<Sample, OrderError> {
        match half {
            Half::Accel => {
                self.accel_state.heard = true;
                self.fetch_accel()
            }
            Half::Mag => {
                self.mag_state.heard = true;
                self.fetch_mag()
            }
        }
    }

    fn fetch_accel(&mut self) -> Result<Sample, OrderError> {
        let mut chip = Accelerometer::new(&mut self.accel);
        let counts = chip.read_sample().map_err(failure)?.0;
        if let Routing::Threshold(_) = self.accel_state.routing {
            chip.read_source().map_err(failure)?;
        }
        Ok(Sample {
            half: Half::Accel,
            counts,
            cause: self.accel_state.routing.cause(),
        })
    }

    fn fetch_mag(&mut self) -> Result<Sample, OrderError> {
        let counts = self.read_mag()?;
        if let Routing::Threshold(_) = self.mag_state.routing {
            Magnetometer::new(&mut self.mag)
                .read_source()
                .map_err(failure)?;
        }
        Ok(Sample {
            half: Half::Mag,
            counts,
            cause: self.mag_state.routing.cause(),
        })
    }

    /// Reads the magnetometer and adds back the offset that its sample was taken under.
    fn read_mag(&mut self) -> Result<[i16; 3], OrderError> {
        let mut chip = Magnetometer::new(&mut self.mag);
        if self.output_offset != self.offset && chip.status().map_err(failure)?.new_sample() {
            self.output_offset = self.offset;
        }
        let sample = chip.read_sample().map_err(failure)?;
        Ok(sample.with_offset_restored(self.output_offset).0)
    }

    /// Carries out an order and checks it; returns the sample that belongs to it.
    ///
    /// A half whose last order failed is set up again first.
    ///
    /// # Errors
    /// The bus's, a register that does not hold what was written, a chip that is not there, a
    /// code that no register takes.
    pub fn execute(&mut self, half: Half, action: Action) -> Result<Option<Sample>, OrderError> {
        let result = self
            .revive_lost(half)
            .and_then(|()| self.obey(half, action));
        match half {
            Half::Accel => self.accel_state.answers = result.is_ok(),
            Half::Mag => self.mag_state.answers = result.is_ok(),
        }
        result
    }

    fn obey(&mut self, half: Half, action: Action) -> Result<Option<Sample>, OrderError> {
        match (half, action) {
            (Half::Accel, Action::DataReady) => self.route_accel(Routing::DataReady)?,
            (Half::Accel, Action::Threshold(code)) => {
                let low = code as u8;
                let known = u16::from(low) == code;
                let threshold = AccelThreshold::from_code(if known { low } else { 0 })
                    .map_err(|_| refused(low))?;
                self.route_accel(Routing::Threshold(threshold))?;
            }
            (Half::Mag, Action::DataReady) => self.route_mag(Routing::DataReady)?,
            (Half::Mag, Action::Threshold(code)) => {
                let threshold = MagThreshold::from_code(code).map_err(|_| refused(0))?;
                self.route_mag(Routing::Threshold(threshold))?;
            }
            (Half::Accel, Action::Rearm) => return self.rearm_accel().map(Some),
            (Half::Mag, Action::Rearm) => return self.rearm_mag().map(Some),
            (Half::Accel, Action::Heartbeat) => return self.accel_heartbeat().map(Some),
            (Half::Mag, Action::Heartbeat) => return self.mag_heartbeat().map(Some),
        }
        Ok(None)
    }

    fn rearm_accel(&mut self) -> Result<Sample, OrderError> {
        let mut chip = Accelerometer::new(&mut self.accel);
        chip.rearm().map_err(failure)?;
        let counts = chip.read_sample().map_err(failure)?.0;
        Ok(Sample {
            half: Half::Accel,
            counts,
            cause: Cause::Rearm,
        })
    }

    /// The sample read becomes the zero; one that comes later is under the new offset.
    fn rearm_mag(&mut self) -> Result<Sample, OrderError> {
        let counts = self.read_mag()?;
        let offset = MagOffset(counts);
        Magnetometer::new(&mut self.mag)
            .set_offset(offset)
            .map_err(failure)?;
        self.offset = offset;
        Ok(Sample {
            half: Half::Mag,
            counts,
            cause: Cause::Rearm,
        })
    }

    fn route_accel(&mut self, routing: Routing<AccelThreshold>) -> Result<(), OrderError> {
        let mut chip = Accelerometer::new(&mut self.accel);
        match (routing, self.accel_state.routing) {
            (Routing::Threshold(threshold), Routing::Threshold(_)) => {
                chip.set_threshold(threshold).map_err(failure)?;
            }
            (Routing::Threshold(threshold), Routing::DataReady) => {
                chip.configure_interrupt(accel_interrupt(threshold))
                    .map_err(failure)?;
            }
            (Routing::DataReady, _) => {
                chip.set_pin(AccelPin::DataReady).map_err(failure)?;
                // A sample that waits already holds the pin high: no edge would ever come.
                chip.read_sample().map_err(failure)?;
            }
        }
        self.accel_state.routing = routing;
        Ok(())
    }

    fn route_mag(&mut self, routing: Routing<MagThreshold>) -> Result<(), OrderError> {
        let mut chip = Magnetometer::new(&mut self.mag);
        match (routing, self.mag_state.routing) {
            (Routing::Threshold(threshold), Routing::Threshold(_)) => {
                chip.set_threshold(threshold).map_err(failure)?;
            }
            (Routing::Threshold(threshold), Routing::DataReady) => {
                chip.configure_interrupt(mag_interrupt(threshold))
                    .map_err(failure)?;
            }
            (Routing::DataReady, _) => {
                chip.set_pin(MagPin::DataReady).map_err(failure)?;
                chip.read_sample().map_err(failure)?;
            }
        }
        self.mag_state.routing = routing;
        Ok(())
    }
}

fn failure<E>(error: Error<E>) -> OrderError {
    match error {
        Error::Bus(_) => OrderError::Bus,
        Error::WrongIdentity { .. } => OrderError::Identity,
        Error::ReadBack {
            register,
            wrote,
            read,
            ..
        } => OrderError::ReadBack {
            register,
            wrote,
            read,
        },
    }
}

/// A code that no register takes: the caller's rounding is at fault, nothing was written.
fn refused(code: u8) -> OrderError {
    OrderError::ReadBack {
        register: INT1_THS_A,
        wrote: code,
        read: 0,
    }
}
