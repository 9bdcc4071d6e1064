//! What the sensors say: bias, motion since the last run, heading, signs of life.

mod heading;
mod liveness;

use crate::estimate::{Arrival, GyroCalibration, Motion};
use crate::math::{Quaternion, Vec3};
use crate::sensors::{ImuReading, ImuSample};
use crate::settings::Settings;
use crate::time::{Duration, Instant};
use crate::units::{BodyRates, SpecificForce};
use heading::Heading;
use liveness::{Liveness, Sign, Silence};

/// The way of samples before they reach the control logic.
#[derive(Debug)]
pub(super) struct Sensing {
    calibration: GyroCalibration,
    bias: Option<BodyRates>,
    arrival: Arrival,
    heading: Heading,
    liveness: Liveness,
    silence: Silence,
    /// How long the gyroscope may be silent or repeat itself.
    patience: Duration,
}

/// What became of a sample of the inertial sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Taken {
    /// The drone has not stood still for long enough yet.
    Calibrating,
    /// The bias is known now; the mean specific force at rest, in m/s2.
    Calibrated(Vec3),
    /// While armed the sensor repeats itself; noticed `now`, or earlier.
    Stuck {
        /// It was noticed with this sample.
        now: bool,
    },
    /// Filtered and summed.
    Filtered {
        /// The stamp went back, or came late: the time between is not integrated.
        jumped: bool,
    },
}

impl Sensing {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            calibration: GyroCalibration::default(),
            bias: None,
            arrival: Arrival::default(),
            heading: Heading::default(),
            liveness: Liveness::default(),
            silence: Silence::default(),
            patience: settings.failsafe * 2,
        }
    }

    /// Calibrates with a sample, or filters and sums it.
    ///
    /// A sensor that repeats itself is an emergency only while `armed`. `derivative_cutoff` is the
    /// corner (Hz) of the filter behind the angular acceleration.
    pub(super) fn take(
        &mut self,
        at: Instant,
        reading: &ImuReading,
        armed: bool,
        derivative_cutoff: f32,
    ) -> Taken {
        self.silence.end(at);
        let &ImuReading { rates, force, .. } = reading;
        let Some(bias) = self.bias else {
            return self.calibrate(&ImuSample { at, rates, force });
        };
        let sign = self.liveness.take(at, reading, self.patience);
        if armed && sign != Sign::Alive {
            return Taken::Stuck {
                now: sign == Sign::Stuck,
            };
        }
        let rates = BodyRates(rates.0 - bias.0);
        let sample = ImuSample { at, rates, force };
        let jumped = !self.arrival.take(&sample, derivative_cutoff);
        Taken::Filtered { jumped }
    }

    #[inline(never)] // On the ground only.
    fn calibrate(&mut self, sample: &ImuSample) -> Taken {
        let Some(found) = self.calibration.take(sample) else {
            return Taken::Calibrating;
        };
        self.bias = Some(found.bias);
        Taken::Calibrated(found.force)
    }

    /// The next samples calibrate anew, from the start.
    pub(super) fn forget_calibration(&mut self) {
        self.bias = None;
        self.calibration = GyroCalibration::default();
    }

    /// True once per silence of the inertial sensor.
    pub(super) fn notice_silence(&mut self, now: Instant) -> bool {
        self.silence.notice(now, self.patience)
    }

    /// True where the inertial sensor has been silent for so long that a run must have noticed,
    /// and none did.
    pub(super) fn overlooks_silence(&self, now: Instant) -> bool {
        self.silence.is_overlooked(now, self.patience * 2)
    }

    /// True while the inertial sensor is silent.
    pub(super) fn is_silent(&self) -> bool {
        self.silence.lasts()
    }

    /// What a run would take now.
    pub(super) fn motion(&self) -> Motion {
        self.arrival.motion()
    }

    /// What a run takes; the sums begin anew.
    pub(super) fn take_motion(&mut self) -> Motion {
        self.arrival.take_motion()
    }

    /// The filtered specific force.
    pub(super) fn force(&self) -> SpecificForce {
        self.arrival.force()
    }

    /// Takes the magnetic field (gauss, body axes), with the attitude of the last run.
    pub(super) fn take_field(&mut self, at: Instant, field: Vec3, attitude: Quaternion) {
        if self.bias.is_some() {
            // Where the body is now, not where it was at the last run.
            let turned = self.arrival.motion().sums.angle;
            let earth = attitude.turned_by(turned).to_earth(field);
            self.heading.take_field(at, earth);
        }
    }

    /// Takes the error (rad) that an external pose shows; it leads before the magnetometer.
    pub(super) fn take_pose_error(&mut self, at: Instant, error: f32) {
        self.heading.take_pose_error(at, error);
    }

    /// The error of the heading (rad), while it is fresh.
    pub(super) fn heading_error(&self, now: Instant) -> Option<f32> {
        self.heading.error(now)
    }
}
