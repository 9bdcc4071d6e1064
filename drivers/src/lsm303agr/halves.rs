//! Both halves of the chip as one owner keeps them: set up, routed, read, checked.
//!
//! The crate `lsm303agr` sets rates, ranges and modes; the register layer beside this module does
//! thresholds, latches, re-arming and every read-back. Both halves sit behind their own chip
//! select on one bus, which only the owner uses.
//!
//! To its owner each half is a [`ComparingSensor`]. What an interrupt leads to is the owner's
//! affair: nothing here knows of control.
//!
//! `upkeep` sets the halves up, checks them, and sets up again what was lost; `comparator` rounds
//! thresholds.

mod comparator;
mod upkeep;

use embedded_hal::spi::SpiDevice;

use super::{
    AccelCounts, AccelPin, AccelThreshold, Accelerometer, MagCounts, MagOffset, MagPin,
    MagThreshold, Magnetometer,
};
use crate::orders::{Cause, ChipAction, ChipSetting, ComparingSensor, Obeyed, OrderError, Sample};
use crate::quantity::Seconds;
use comparator::Comparator;
pub use upkeep::Rates;
use upkeep::{FULL_SCALE, accel_interrupt, mag_interrupt};

/// The chip's two halves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// Accelerometer.
    Accel,
    /// Magnetometer.
    Mag,
}

/// One half, and the chip that it belongs to.
#[derive(Debug)]
pub struct HalfOf<'c, A, M> {
    chip: &'c mut Halves<A, M>,
    half: Half,
}

fn accel_sample(counts: AccelCounts, cause: Cause) -> Sample {
    let axes = counts.specific_force(FULL_SCALE).map(|axis| axis.0);
    Sample { axes, cause }
}

/// The OFFSET registers are added back to the counts.
fn mag_sample(counts: MagCounts, cause: Cause) -> Sample {
    let axes = counts.field().map(|axis| axis.0);
    Sample { axes, cause }
}

/// What drives a half's interrupt pin.
#[derive(Clone, Copy, Debug)]
enum Routing<T> {
    DataReady,
    Threshold(T),
}

impl<T: Copy> Routing<T> {
    fn cause(&self) -> Cause {
        match self {
            Self::DataReady => Cause::DataReady,
            Self::Threshold(_) => Cause::Threshold,
        }
    }

    /// The comparator's code; 0 where it is not used.
    fn code<C: Default>(&self, of: impl Fn(T) -> C) -> C {
        match self {
            Self::DataReady => C::default(),
            Self::Threshold(threshold) => of(*threshold),
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
    longest_hold: Seconds,
    accel_state: State<AccelThreshold>,
    mag_state: State<MagThreshold>,
    /// What the OFFSET registers hold.
    offset: MagOffset,
    /// The offset that the output registers' sample was taken under.
    output_offset: MagOffset,
}

impl<A: SpiDevice, M: SpiDevice<Error = A::Error>> Halves<A, M> {
    /// Takes the bus handles; nothing is sent until a half is set up.
    ///
    /// `longest_hold` is the longest time between two orders to re-arm: the accelerometer's
    /// thresholds are lowered where its reference decays in that time.
    pub const fn new(accel: A, mag: M, rates: Rates, longest_hold: Seconds) -> Self {
        Self {
            accel,
            mag,
            rates,
            longest_hold,
            accel_state: State::UNKNOWN,
            mag_state: State::UNKNOWN,
            offset: MagOffset([0; 3]),
            output_offset: MagOffset([0; 3]),
        }
    }

    /// One half, to be worked with.
    pub const fn half(&mut self, half: Half) -> HalfOf<'_, A, M> {
        HalfOf { chip: self, half }
    }

    fn fetch_accel(&mut self) -> Result<Sample, OrderError> {
        let mut chip = Accelerometer::new(&mut self.accel);
        let counts = chip.read_sample()?;
        if let Routing::Threshold(_) = self.accel_state.routing {
            chip.clear_request()?;
        }
        Ok(accel_sample(counts, self.accel_state.routing.cause()))
    }

    fn fetch_mag(&mut self) -> Result<Sample, OrderError> {
        let counts = self.read_mag()?;
        if let Routing::Threshold(_) = self.mag_state.routing {
            Magnetometer::new(&mut self.mag).clear_request()?;
        }
        Ok(mag_sample(counts, self.mag_state.routing.cause()))
    }

    /// Reads the magnetometer and adds back the offset that its sample was taken under.
    fn read_mag(&mut self) -> Result<MagCounts, OrderError> {
        let mut chip = Magnetometer::new(&mut self.mag);
        if self.output_offset != self.offset && chip.status()?.new_sample() {
            self.output_offset = self.offset;
        }
        let sample = chip.read_sample()?;
        Ok(sample.with_offset_restored(self.output_offset))
    }

    fn setting(&self, half: Half) -> ChipSetting {
        match half {
            Half::Accel => {
                let code = self.accel_state.routing.code(AccelThreshold::code);
                self.accel_comparator().setting(u16::from(code))
            }
            Half::Mag => {
                let code = self.mag_state.routing.code(MagThreshold::code);
                Comparator::MAG.setting(code)
            }
        }
    }

    fn accel_comparator(&self) -> Comparator {
        Comparator::accel(self.rates.accel(), self.longest_hold)
    }

    fn obey(&mut self, half: Half, action: ChipAction) -> Result<Option<Sample>, OrderError> {
        match (half, action) {
            (Half::Accel, ChipAction::DataReady) => self.route_accel(Routing::DataReady)?,
            (Half::Accel, ChipAction::Threshold(change)) => {
                let code = self.accel_comparator().code(change);
                let threshold = AccelThreshold::from_code(code as u8);
                self.route_accel(threshold.map_or(Routing::DataReady, Routing::Threshold))?;
            }
            (Half::Mag, ChipAction::DataReady) => self.route_mag(Routing::DataReady)?,
            (Half::Mag, ChipAction::Threshold(change)) => {
                let threshold = MagThreshold::from_code(Comparator::MAG.code(change));
                self.route_mag(threshold.map_or(Routing::DataReady, Routing::Threshold))?;
            }
            (Half::Accel, ChipAction::Rearm) => return self.rearm_accel().map(Some),
            (Half::Mag, ChipAction::Rearm) => return self.rearm_mag().map(Some),
            (Half::Accel, ChipAction::Read) => {
                let counts = Accelerometer::new(&mut self.accel).read_sample()?;
                return Ok(Some(accel_sample(counts, Cause::Rearm)));
            }
            (Half::Mag, ChipAction::Read) => {
                return Ok(Some(mag_sample(self.read_mag()?, Cause::Rearm)));
            }
            (Half::Accel, ChipAction::Heartbeat) => return self.accel_heartbeat().map(Some),
            (Half::Mag, ChipAction::Heartbeat) => return self.mag_heartbeat().map(Some),
        }
        Ok(None)
    }

    fn rearm_accel(&mut self) -> Result<Sample, OrderError> {
        let mut chip = Accelerometer::new(&mut self.accel);
        chip.rearm()?;
        let counts = chip.read_sample()?;
        Ok(accel_sample(counts, Cause::Rearm))
    }

    /// The sample read becomes the zero; one that comes later is under the new offset.
    fn rearm_mag(&mut self) -> Result<Sample, OrderError> {
        let counts = self.read_mag()?;
        let offset = MagOffset::at(counts);
        Magnetometer::new(&mut self.mag).set_offset(offset)?;
        self.offset = offset;
        Ok(mag_sample(counts, Cause::Rearm))
    }

    fn route_accel(&mut self, routing: Routing<AccelThreshold>) -> Result<(), OrderError> {
        let mut chip = Accelerometer::new(&mut self.accel);
        match (routing, self.accel_state.routing) {
            (Routing::Threshold(threshold), Routing::Threshold(_)) => {
                chip.set_threshold(threshold)?;
            }
            (Routing::Threshold(threshold), Routing::DataReady) => {
                chip.configure_interrupt(accel_interrupt(threshold))?;
            }
            (Routing::DataReady, _) => {
                chip.set_pin(AccelPin::DataReady)?;
                // A sample that waits already holds the pin high: no edge would ever come.
                chip.read_sample()?;
            }
        }
        self.accel_state.routing = routing;
        Ok(())
    }

    fn route_mag(&mut self, routing: Routing<MagThreshold>) -> Result<(), OrderError> {
        let mut chip = Magnetometer::new(&mut self.mag);
        match (routing, self.mag_state.routing) {
            (Routing::Threshold(threshold), Routing::Threshold(_)) => {
                chip.set_threshold(threshold)?;
            }
            (Routing::Threshold(threshold), Routing::DataReady) => {
                chip.configure_interrupt(mag_interrupt(threshold))?;
            }
            (Routing::DataReady, _) => {
                chip.set_pin(MagPin::DataReady)?;
                chip.read_sample()?;
            }
        }
        self.mag_state.routing = routing;
        Ok(())
    }
}

impl<A: SpiDevice, M: SpiDevice<Error = A::Error>> ComparingSensor for HalfOf<'_, A, M> {
    fn set_up(&mut self) -> Result<(), OrderError> {
        match self.half {
            Half::Accel => self.chip.set_up_accel(),
            Half::Mag => self.chip.set_up_mag(),
        }
    }

    fn fetch(&mut self) -> Result<Sample, OrderError> {
        match self.half {
            Half::Accel => {
                self.chip.accel_state.heard = true;
                self.chip.fetch_accel()
            }
            Half::Mag => {
                self.chip.mag_state.heard = true;
                self.chip.fetch_mag()
            }
        }
    }

    /// A half whose last order failed is set up again first.
    fn execute(&mut self, action: ChipAction) -> Result<Obeyed, OrderError> {
        let Self { chip, half } = self;
        let result = chip
            .revive_lost(*half)
            .and_then(|()| chip.obey(*half, action));
        match half {
            Half::Accel => chip.accel_state.answers = result.is_ok(),
            Half::Mag => chip.mag_state.answers = result.is_ok(),
        }
        let (sample, setting) = (result?, chip.setting(*half));
        Ok(Obeyed { sample, setting })
    }
}
