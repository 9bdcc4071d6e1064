//! Start-up, heartbeats and repair of both halves.
//!
//! A half that fails an order, or whose samples stop coming, is set up again at the next one, as
//! it was programmed last. A half that is not there at all is only asked for its name, so that
//! the other one is left in peace.

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiDevice;
use lsm303agr::{AccelOutputDataRate, AccelScale, Lsm303agr, MagMode, MagOutputDataRate};

use super::super::{
    AccelDataRate, AccelFullScale, AccelInterrupt, AccelMode, AccelOutput, AccelPin,
    AccelThreshold, Accelerometer, Axes, HighPass, HighPassCorner, HighPassMode, MagCompare,
    MagInterrupt, MagPin, MagThreshold, Magnetometer, ThreeWire, ThresholdDuration,
};
use super::{Half, Halves, Routing};
use crate::error::Error;
use crate::orders::{Cause, OrderError, Sample};

/// The accelerometer's full scale: the finest, because its threshold has the finest step.
pub(super) const FULL_SCALE: AccelFullScale = AccelFullScale::G2;

/// The corner of the filter before the accelerometer's comparator: the one that forgets slowest.
pub(super) const CORNER: HighPassCorner = HighPassCorner::FourHundredth;

/// The data rates that both halves are set to.
#[derive(Clone, Copy, Debug)]
pub struct Rates {
    /// The accelerometer's, as the crate and as the register layer name it.
    accel: (AccelOutputDataRate, AccelDataRate),
    mag: MagOutputDataRate,
}

impl Rates {
    /// The rates in Hz: 400, 200, 100, 50, 25 or 10, and 100, 50, 20 or 10; `None` for others.
    #[must_use]
    pub const fn from_hz(accel: u32, mag: u32) -> Option<Self> {
        let accel = match accel {
            400 => (AccelOutputDataRate::Hz400, AccelDataRate::Hz400),
            200 => (AccelOutputDataRate::Hz200, AccelDataRate::Hz200),
            100 => (AccelOutputDataRate::Hz100, AccelDataRate::Hz100),
            50 => (AccelOutputDataRate::Hz50, AccelDataRate::Hz50),
            25 => (AccelOutputDataRate::Hz25, AccelDataRate::Hz25),
            10 => (AccelOutputDataRate::Hz10, AccelDataRate::Hz10),
            _ => return None,
        };
        let mag = match mag {
            100 => MagOutputDataRate::Hz100,
            50 => MagOutputDataRate::Hz50,
            20 => MagOutputDataRate::Hz20,
            10 => MagOutputDataRate::Hz10,
            _ => return None,
        };
        Some(Self { accel, mag })
    }

    pub(super) const fn accel(self) -> AccelDataRate {
        self.accel.1
    }

    /// What the crate is told to set, checked against the chip.
    const fn output(self) -> AccelOutput {
        AccelOutput {
            data_rate: self.accel(),
            full_scale: FULL_SCALE,
            mode: AccelMode::HighResolution,
        }
    }
}

/// "Changed by more than the threshold on any axis since REFERENCE_A was read", latched.
pub(super) const fn accel_interrupt(threshold: AccelThreshold) -> AccelInterrupt {
    AccelInterrupt {
        high_pass: Some(HighPass {
            mode: HighPassMode::ResetByReading,
            corner: CORNER,
        }),
        axes: Axes::ALL,
        threshold,
        duration: ThresholdDuration::IMMEDIATE,
        latch: true,
        pin: AccelPin::Threshold,
    }
}

/// "Changed by more than the threshold on any axis since OFFSET was written", latched.
pub(super) const fn mag_interrupt(threshold: MagThreshold) -> MagInterrupt {
    MagInterrupt {
        compare: MagCompare::ChangeFromOffset,
        axes: Axes::ALL,
        threshold,
        latch: true,
        pin: MagPin::Threshold,
    }
}

/// The crate waits for the first sample after a change; samples are awaited by interrupt here.
struct NoWait;

impl DelayNs for NoWait {
    fn delay_ns(&mut self, _: u32) {}
}

impl<A: SpiDevice, M: SpiDevice<Error = A::Error>> Halves<A, M> {
    /// Sets a half up again whose last order failed.
    pub(super) fn revive_lost(&mut self, half: Half) -> Result<(), OrderError> {
        match half {
            Half::Accel if !self.accel_state.answers => self.set_up_accel(),
            Half::Mag if !self.mag_state.answers => self.set_up_mag(),
            _ => Ok(()),
        }
    }

    /// Checks the accelerometer and reads it: also lets a pin fall whose edge was missed, since
    /// a latch that is not cleared stays silent.
    pub(super) fn accel_heartbeat(&mut self) -> Result<Sample, OrderError> {
        if self.accel_state.is_silent() {
            self.set_up_accel()?;
        }
        self.accel_state.heard = false;
        self.check_accel()?;
        let sample = self.fetch_accel()?;
        Ok(Sample {
            cause: Cause::Heartbeat,
            ..sample
        })
    }

    /// As [`Self::accel_heartbeat`].
    pub(super) fn mag_heartbeat(&mut self) -> Result<Sample, OrderError> {
        if self.mag_state.is_silent() {
            self.set_up_mag()?;
        }
        self.mag_state.heard = false;
        self.check_mag()?;
        let sample = self.fetch_mag()?;
        Ok(Sample {
            cause: Cause::Heartbeat,
            ..sample
        })
    }

    fn check_accel(&mut self) -> Result<(), Error<A::Error>> {
        let mut chip = Accelerometer::new(&mut self.accel);
        chip.check_identity()?;
        chip.verify_output(self.rates.output())?;
        if let Routing::Threshold(threshold) = self.accel_state.routing {
            chip.verify_interrupt(accel_interrupt(threshold))?;
        }
        Ok(())
    }

    fn check_mag(&mut self) -> Result<(), Error<A::Error>> {
        let mut chip = Magnetometer::new(&mut self.mag);
        chip.check_identity()?;
        chip.verify_compensation()?;
        if let Routing::Threshold(threshold) = self.mag_state.routing {
            chip.verify_interrupt(mag_interrupt(threshold))?;
        }
        Ok(())
    }

    /// Sets the accelerometer up, should it be there.
    pub(super) fn set_up_accel(&mut self) -> Result<(), OrderError> {
        ThreeWire::enable(&mut self.accel).map_err(|_| OrderError::Bus)?;
        let mut chip = Accelerometer::new(&mut self.accel);
        chip.check_identity()?;
        self.set_up()?;
        // The crate's writes took the other half's pin away as well; should it not come back, its
        // own heartbeat notices.
        let _ = self.restore_mag();
        self.restore_accel()
    }

    /// As [`Self::set_up_accel`].
    pub(super) fn set_up_mag(&mut self) -> Result<(), OrderError> {
        let mut chip = Magnetometer::new(&mut self.mag);
        chip.check_identity()?;
        self.set_up()?;
        let _ = self.restore_accel();
        self.restore_mag()
    }

    /// Rate, range and mode of both halves by the crate, which holds both at once.
    fn set_up(&mut self) -> Result<(), OrderError> {
        let mut set_up = || -> Result<(), lsm303agr::Error<A::Error>> {
            let accel = ThreeWire::enable(&mut self.accel).map_err(lsm303agr::Error::Comm)?;
            let mut chip = Lsm303agr::new_with_spi(accel, &mut self.mag);
            chip.init()?;
            let mode = lsm303agr::AccelMode::HighResolution;
            chip.set_accel_mode_and_odr(&mut NoWait, mode, self.rates.accel.0)?;
            chip.set_accel_scale(AccelScale::G2)?;
            let mode = MagMode::HighResolution;
            chip.set_mag_mode_and_odr(&mut NoWait, mode, self.rates.mag)?;
            let chip = chip.into_mag_continuous();
            chip.map(|_| ()).map_err(|failed| failed.error)
        };
        set_up().map_err(|_| OrderError::Bus)
    }

    /// Routes the pin as it was, from the state that power-up leaves.
    fn restore_accel(&mut self) -> Result<(), OrderError> {
        let wanted = self.accel_state.routing;
        self.accel_state.routing = Routing::DataReady;
        let result = self.route_accel(wanted);
        // Not to be forgotten where it failed: the next order tries again.
        self.accel_state.routing = wanted;
        self.accel_state.answers = result.is_ok();
        result
    }

    /// As [`Self::restore_accel`], with the offset, and the corrections that the crate leaves off.
    fn restore_mag(&mut self) -> Result<(), OrderError> {
        let mut chip = Magnetometer::new(&mut self.mag);
        chip.disable_i2c()?;
        chip.compensate()?;
        chip.set_offset(self.offset)?;
        let wanted = self.mag_state.routing;
        self.mag_state.routing = Routing::DataReady;
        let result = self.route_mag(wanted);
        self.mag_state.routing = wanted;
        self.mag_state.answers = result.is_ok();
        result
    }
}
