//! The LSM303AGR's owner: sample fetches and the autopilot's orders over SPI1.
//!
//! The crate `lsm303agr` sets rates, ranges and modes; the register layer of `reflex-drivers` does
//! thresholds, latches, re-arming and every read-back. Both halves sit behind their own chip
//! select on one bus, which only the owner's task uses: `Busy` cannot happen.
//!
//! [`upkeep`] sets the halves up, checks them, and sets up again what was lost.

mod upkeep;

use embedded_hal_bus::spi::{AtomicDevice, AtomicError, DeviceError};
use embedded_hal_bus::util::AtomicCell;
use reflex::app::{Autopilot, ChipOrder, Next, OrderError, Recorder};
use reflex::sensors::Cause;
use reflex::time::Instant;
use reflex_drivers::Error;
use reflex_drivers::lsm303agr::register::INT1_THS_A;
use reflex_drivers::lsm303agr::{
    AccelPin, AccelThreshold, Accelerometer, MagOffset, MagPin, MagThreshold, Magnetometer,
};
use stm32f4xx_hal::gpio::{Output, PA4, PC4};

use crate::board::clock::Delay;
use crate::board::spi::{Spi1, Timeout};
use upkeep::{accel_interrupt, mag_interrupt};

type Device<CS> = AtomicDevice<'static, Spi1, CS, Delay>;
type SpiError = AtomicError<DeviceError<Timeout, core::convert::Infallible>>;

/// Interrupts whose sample is still to be fetched: the latest of each half.
///
/// One place per half is a bounded queue that cannot overflow: a second interrupt before the
/// fetch is about the sample that the same fetch reads.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fetches {
    /// Stamp of the accelerometer's interrupt.
    pub accel: Option<Instant>,
    /// Stamp of the magnetometer's interrupt.
    pub mag: Option<Instant>,
}

impl Fetches {
    /// Takes the next one: which half, and its stamp.
    pub fn next(&mut self) -> Option<(Half, Instant)> {
        let accel = self.accel.take().map(|at| (Half::Accel, at));
        accel.or_else(|| self.mag.take().map(|at| (Half::Mag, at)))
    }
}

/// What drives a half's interrupt pin.
#[derive(Clone, Copy)]
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
#[derive(Clone, Copy)]
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

/// Raw counts of one half, the magnetometer's with its offset restored.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The half that was read.
    pub half: Half,
    /// Counts along the chip's axes.
    pub counts: [i16; 3],
    /// Why it was read.
    pub cause: Cause,
}

impl Sample {
    /// Hands it to the autopilot with its stamp.
    pub fn deliver<R: Recorder>(self, autopilot: &mut Autopilot<R>, at: Instant) -> Next {
        match self.half {
            Half::Accel => autopilot.on_chip_accel(at, self.counts, self.cause),
            Half::Mag => autopilot.on_chip_mag(at, self.counts, self.cause),
        }
    }
}

/// The chip's two halves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// Accelerometer.
    Accel,
    /// Magnetometer.
    Mag,
}

/// Both halves of the chip.
pub struct Chips {
    accel: Device<PA4<Output>>,
    mag: Device<PC4<Output>>,
    accel_state: State<AccelThreshold>,
    mag_state: State<MagThreshold>,
    /// What the OFFSET registers hold.
    offset: MagOffset,
    /// The offset that the output registers' sample was taken under.
    output_offset: MagOffset,
}

impl Chips {
    /// Takes the bus and the chip selects, and sets both halves up.
    ///
    /// A half that does not answer is named in the log and tried again at every order.
    pub fn start(bus: &'static AtomicCell<Spi1>, (accel, mag): (PA4<Output>, PC4<Output>)) -> Self {
        let Ok(accel) = AtomicDevice::new(bus, accel, Delay);
        let Ok(mag) = AtomicDevice::new(bus, mag, Delay);
        let mut chips = Self {
            accel,
            mag,
            accel_state: State::UNKNOWN,
            mag_state: State::UNKNOWN,
            offset: MagOffset::default(),
            output_offset: MagOffset::default(),
        };
        if let Err(error) = chips.revive_accel() {
            defmt::error!("LSM303AGR accelerometer is not used: {}", error);
        }
        if let Err(error) = chips.revive_mag() {
            defmt::error!("LSM303AGR magnetometer is not used: {}", error);
        }
        chips
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
    /// # Errors
    /// The bus's, a register that does not hold what was written, a chip that is not there.
    pub fn execute(&mut self, order: ChipOrder) -> Result<Option<Sample>, OrderError> {
        let half = half_of(order);
        let result = self.revive_lost(half).and_then(|()| self.obey(order));
        match half {
            Half::Accel => self.accel_state.answers = result.is_ok(),
            Half::Mag => self.mag_state.answers = result.is_ok(),
        }
        result
    }

    fn obey(&mut self, order: ChipOrder) -> Result<Option<Sample>, OrderError> {
        match order {
            ChipOrder::AccelDataReady => self.route_accel(Routing::DataReady)?,
            ChipOrder::AccelThreshold(code) => {
                let threshold = AccelThreshold::from_code(code).map_err(|_| refused(code))?;
                self.route_accel(Routing::Threshold(threshold))?;
            }
            ChipOrder::MagDataReady => self.route_mag(Routing::DataReady)?,
            ChipOrder::MagThreshold(code) => {
                let threshold = MagThreshold::from_code(code).map_err(|_| refused(0))?;
                self.route_mag(Routing::Threshold(threshold))?;
            }
            ChipOrder::AccelRearm => return self.rearm_accel().map(Some),
            ChipOrder::MagRearm => return self.rearm_mag().map(Some),
            ChipOrder::AccelHeartbeat => return self.accel_heartbeat().map(Some),
            ChipOrder::MagHeartbeat => return self.mag_heartbeat().map(Some),
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

/// The half that an order is for.
fn half_of(order: ChipOrder) -> Half {
    match order {
        ChipOrder::AccelDataReady
        | ChipOrder::AccelThreshold(_)
        | ChipOrder::AccelRearm
        | ChipOrder::AccelHeartbeat => Half::Accel,
        ChipOrder::MagDataReady
        | ChipOrder::MagThreshold(_)
        | ChipOrder::MagRearm
        | ChipOrder::MagHeartbeat => Half::Mag,
    }
}

fn failure(error: Error<SpiError>) -> OrderError {
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

/// A code that no register takes: the autopilot's rounding is at fault, nothing was written.
fn refused(code: u8) -> OrderError {
    OrderError::ReadBack {
        register: INT1_THS_A,
        wrote: code,
        read: 0,
    }
}
