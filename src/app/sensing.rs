//! What the sensors say, and which of them is believed.
//!
//! | wrong is | then |
//! |---|---|
//! | the gyroscope, or the flow of samples | no motion is known: [`Taken::Lost`] |
//! | the accelerometer | gravity as the gyroscope turns it stands for it |
//! | one against the other | told: two cannot say which; see [`Health::contradicted`] |
//! | the accelerometers of two chips, against each other | the one that is further from 1 g |
//! | the field | the heading is free |

mod accels;
mod flow;
mod heading;
mod repeats;
mod signal;

use super::door::Fault;
use super::notice;
use crate::config::CALIBRATION_LENGTH;
use crate::estimate::{Arrival, Calibrating, GyroCalibration, Iron, Motion, Vertical};
use crate::link::Notice;
use crate::math::{Quaternion, Vec3};
use crate::sensors::{GRAVITY, ImuReading, ImuSample};
use crate::settings::{LARGEST_TRIM, Settings};
use crate::time::{Duration, Instant, micros, seconds, span};
use crate::units::{BodyRates, SpecificForce};
use accels::Accels;
use flow::Flow;
use heading::Heading;
pub use signal::Condition;
use signal::{Judged, Range, Signal};

/// Of rates, in rad/s: the range ends at 2000 deg/s; a body that spins up reaches 500 rad/s2.
const RATES: Range = Range {
    rail: 34.7,
    step: 4.0,
    drift: 500.0,
    rough: 0.5,
};
/// Of forces, in m/s2: the range ends at 16 g.
const FORCES: Range = Range {
    rail: 155.0,
    step: 60.0,
    drift: 2_000.0,
    rough: 15.0,
};
/// Behind a longer gap (s) the time between is not summed.
const GAP: f32 = 0.02;
/// The longest gap that rates at its ends say something about.
const LONGEST_BRIDGE: Duration = micros(5_000_000);
/// Force (m/s2) and rates (rad/s) of a drone at rest stay this near to their means.
const AT_REST: f32 = 0.2;
/// Cosine of the tilt beyond which a chip is mounted another way, rather than the drone set askew.
const UPRIGHT: f32 = 0.7;
/// Tilt (sine) between estimate and gravity at rest beyond which they disagree: 6 degrees.
const LEVEL: f32 = 0.1;

/// The way of samples before they reach the control logic.
#[derive(Debug)]
pub(super) struct Sensing {
    calibration: GyroCalibration,
    bias: Option<BodyRates>,
    /// What the accelerometer shows beyond gravity, of a drone that stands level.
    trim: Vec3,
    /// When the drone last ended a stretch of rest, and the mean force of that.
    rested: Option<(Instant, Vec3)>,
    gyro: Signal,
    accel: Signal,
    flow: Flow,
    arrival: Arrival,
    vertical: Vertical,
    accels: Accels,
    iron: Iron,
    heading: Heading,
    /// The newest sample was not believed.
    lost: bool,
    /// Motion was bridged over a gap, and the field did not show yet what became of the attitude.
    bridged: bool,
    /// How long the gating sensor may be silent.
    patience: Duration,
}

/// How the sensors do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Health {
    /// The gyroscope, by itself.
    pub gyro: Condition,
    /// The gating accelerometer, by itself.
    pub accel: Condition,
    /// Samples come, and often enough.
    pub flows: bool,
    /// Gyroscope and accelerometer contradict each other; two cannot say which is wrong.
    pub contradicted: bool,
    /// The accelerometers of both chips contradict each other.
    pub apart: bool,
    /// A bent field is not followed.
    pub heading_free: bool,
    /// Tilt of the estimate and of the force felt differ: at rest, one of them is wrong.
    pub level_disagrees: bool,
}

/// What became of a sample of the inertial sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Taken {
    /// The drone has not stood still for long enough yet.
    Calibrating,
    /// What passed for a bias is turning: the drone is not at rest.
    Turning,
    /// No motion is known.
    Lost,
    /// Filtered and summed.
    Filtered {
        /// The stamp went back, or came late: the time between is not integrated.
        jumped: bool,
        /// The first behind a gap: how far the body turned meanwhile, rad in body axes.
        turned: Option<Vec3>,
        /// The bias was measured; the mean specific force at rest, in m/s2.
        rest: Option<Vec3>,
    },
}

impl Health {
    /// True where every sensor of motion is believed, and none contradicts another.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let alive = [self.gyro, self.accel].map(|condition| condition == Condition::Alive);
        alive == [true; 2] && self.flows && !self.contradicted && !self.apart
    }
}

impl Sensing {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            calibration: GyroCalibration::default(),
            bias: None,
            trim: Vec3::from_array(settings.accel_trim),
            rested: None,
            gyro: Signal::default(),
            accel: Signal::default(),
            flow: Flow::default(),
            arrival: Arrival::default(),
            vertical: Vertical::default(),
            accels: Accels::default(),
            iron: Iron::of(settings),
            heading: Heading::default(),
            lost: false,
            bridged: false,
            patience: settings.failsafe,
        }
    }

    /// Judges a sample, then calibrates with it, or filters and sums it; tells what it noticed.
    ///
    /// While the drone is not `armed` its bias is measured anew whenever it stands still.
    /// `derivative_cutoff` is the corner (Hz) of the filter behind the angular acceleration.
    pub(super) fn take(
        &mut self,
        at: Instant,
        reading: &ImuReading,
        armed: bool,
        derivative_cutoff: f32,
        tell: &mut impl FnMut(Fault),
    ) -> Taken {
        let heard = self.flow.take(at, self.patience);
        let gyro = self.gyro.take(reading.rates.0, heard.dt, &RATES);
        let accel = self.accel.take(reading.force.0, heard.dt, &FORCES);
        if heard.starved || gyro.is_news() || accel.is_news() {
            tell_news(heard.starved, &gyro, &accel, tell);
        }
        if !self.flow.flows() || self.gyro.condition() != Condition::Alive {
            self.lost = true;
            self.calibration = GyroCalibration::default();
            return Taken::Lost;
        }
        let force = SpecificForce(self.believed(accel.value - self.trim));
        let raw = ImuSample {
            at,
            rates: BodyRates(gyro.value),
            force,
        };
        let mut rest = None;
        if !armed {
            match self.calibrate(&raw) {
                Calibrating::Found(found) => rest = Some(found.force),
                Calibrating::Turning => return Taken::Turning,
                Calibrating::Waiting => {}
            }
        }
        let Some(bias) = self.bias else {
            return Taken::Calibrating;
        };
        let rates = BodyRates(gyro.value - bias.0 - self.vertical.drift());
        let before = (self.lost || heard.dt > GAP).then(|| self.arrival.newest());
        let sample = ImuSample { at, rates, force };
        let jumped = !self.arrival.take(&sample, derivative_cutoff);
        let turned = before.flatten().map(|before| self.bridge(before, at));
        Taken::Filtered {
            jumped,
            turned,
            rest,
        }
    }

    /// The force that is believed: that of gravity, where the accelerometer is not.
    fn believed(&self, force: Vec3) -> Vec3 {
        if self.trusts_force() {
            force
        } else {
            self.vertical.down() * -GRAVITY
        }
    }

    fn trusts_force(&self) -> bool {
        self.accel.condition() == Condition::Alive && self.accels.trusts_first()
    }

    /// How far the body turned over a gap, in rad: no torque changes its rates but evenly.
    #[inline(never)] // Rare.
    fn bridge(&mut self, (since, before): (Instant, BodyRates), at: Instant) -> Vec3 {
        self.lost = false;
        self.bridged = true;
        let gap = seconds(span(since, at).min(LONGEST_BRIDGE));
        let turned = (before.0 + self.arrival.rates().0) * (0.5 * gap);
        self.vertical = self.vertical.turned_by(turned);
        self.heading.allow_jump();
        turned
    }

    #[inline(never)] // On the ground only.
    fn calibrate(&mut self, sample: &ImuSample) -> Calibrating {
        let calibrating = self.calibration.take(sample);
        match calibrating {
            Calibrating::Found(found) => {
                self.bias = Some(found.bias);
                self.rested = Some((sample.at, found.force));
                self.vertical = self.vertical.at_rest(found.force);
            }
            Calibrating::Turning => self.bias = None,
            Calibrating::Waiting => {}
        }
        calibrating
    }

    /// The mean force of a drone that is at rest, and has been for the length of a calibration.
    ///
    /// # Errors
    /// It is not.
    pub(super) fn rest(&self, now: Instant) -> Result<Vec3, Notice> {
        let fresh = |(at, force): (Instant, Vec3)| {
            let moved = (self.force().0 - force).max_norm();
            let turns = self.motion().rotation.rates.0.max_norm();
            let still = moved <= AT_REST && turns <= AT_REST && self.trusts_force();
            (still && span(at, now) <= CALIBRATION_LENGTH * 2).then_some(force)
        };
        let rest = self.rested.and_then(fresh);
        rest.ok_or(notice::CALIBRATE_MOVING)
    }

    /// Takes the way that a drone at rest stands for level.
    ///
    /// # Errors
    /// It is not at rest, or stands too far from level.
    pub(super) fn level(&mut self, now: Instant) -> Result<(), Notice> {
        let beyond = self.rest(now)? + Vec3::new(0.0, 0.0, GRAVITY);
        let trim = self.trim + beyond;
        if trim.max_norm() > LARGEST_TRIM {
            return Err(notice::CALIBRATE_SLANTED);
        }
        self.trim = trim;
        self.rested = None;
        Ok(())
    }

    /// What the accelerometer shows beyond gravity, of a drone that stands level.
    pub(super) fn trim(&self) -> Vec3 {
        self.trim
    }

    /// The next samples calibrate anew, from the start.
    pub(super) fn forget_calibration(&mut self) {
        self.bias = None;
        self.rested = None;
        self.calibration = GyroCalibration::default();
    }

    /// How the sensors do, beside the attitude that is estimated from them.
    pub(super) fn health(&self, attitude: Quaternion) -> Health {
        Health {
            gyro: self.gyro.condition(),
            accel: self.accel.condition(),
            flows: self.flow.flows(),
            contradicted: self.vertical.is_contradicted(),
            apart: self.accels.are_apart(),
            heading_free: self.heading.is_free(),
            level_disagrees: self.level_disagrees(attitude),
        }
    }

    fn level_disagrees(&self, attitude: Quaternion) -> bool {
        let (up, down) = (self.arrival.force().0, attitude.down_in_body());
        let wrong_way = up.dot(down) > 0.0;
        wrong_way || up.cross(down).norm() > LEVEL * up.norm()
    }

    /// True once per silence of the inertial sensor.
    pub(super) fn notice_silence(&mut self, now: Instant) -> bool {
        let noticed = self.flow.notice(now, self.patience);
        self.lost |= noticed;
        noticed
    }

    /// When a silence of the inertial sensor is to be noticed; `None` while one lasts.
    pub(super) fn silence_deadline(&self) -> Option<Instant> {
        self.flow.deadline(self.patience)
    }

    /// True where the inertial sensor has been silent for so long that a run must have noticed,
    /// and none did.
    pub(super) fn overlooks_silence(&self, now: Instant) -> bool {
        let due = self.flow.deadline(self.patience * 2);
        due.is_some_and(|due| now > due)
    }

    /// What a run would take now.
    pub(super) fn motion(&self) -> Motion {
        self.arrival.motion()
    }

    /// What a run takes; the sums begin anew. Tells of a contradiction that it shows.
    pub(super) fn take_motion(&mut self, now: Instant, tell: &mut impl FnMut(Fault)) -> Motion {
        let motion = self.arrival.take_motion();
        let before = self.vertical.is_contradicted();
        self.vertical = self.vertical.after(&motion.sums, self.heading.error(now));
        if self.vertical.is_contradicted() && !before {
            tell(Fault::Implausible);
        }
        motion
    }

    /// How fast the body sinks, in m/s, where the accelerometer is believed.
    pub(super) fn sinking(&self) -> Option<f32> {
        self.trusts_force().then(|| self.vertical.sinking())
    }

    /// The filtered specific force.
    pub(super) fn force(&self) -> SpecificForce {
        self.arrival.force()
    }

    /// True where gravity is felt from below, if a drone at rest is not set on its side.
    pub(super) fn stands_upright(&self) -> bool {
        let force = self.force().0;
        force.z < -UPRIGHT * force.norm()
    }

    /// True where the other chip feels gravity from elsewhere.
    pub(super) fn chip_is_aslant(&self) -> bool {
        self.accels.is_second_aslant()
    }

    /// Takes a force (m/s2) that the other accelerometer felt.
    pub(super) fn take_other_force(
        &mut self,
        at: Instant,
        force: Vec3,
        armed: bool,
        tell: &mut impl FnMut(Fault),
    ) {
        if !armed {
            self.accels.compare(self.accel.newest(), force);
        }
        if self.accels.take(at, self.accel.newest(), force) {
            tell(Fault::AccelsApart);
        }
    }

    /// Takes the magnetic field (gauss, body axes), with the attitude of the last run. The board's
    /// iron is taken off here: thresholds are about changes, which hard iron leaves alone.
    ///
    /// Behind a gap, how far that attitude is to be turned: rates at its ends say less than the
    /// field, which in a steady fall through the air is the only one to see a tilt.
    pub(super) fn take_field(
        &mut self,
        at: Instant,
        field: Vec3,
        attitude: Quaternion,
        tell: &mut impl FnMut(Fault),
    ) -> Option<Vec3> {
        let field = self.iron.removed(field);
        self.calibration.take_field(field);
        self.bias?;
        // While motion is lost the estimate stands still: the field would follow it astray.
        if self.lost {
            return None;
        }
        // Where the body is now, not where it was at the last run.
        let turned = self.arrival.motion().sums.angle;
        let attitude = attitude.turned_by(turned);
        if self.bridged {
            self.bridged = false;
            let turn = self.heading.turn_to_field(attitude, field)?;
            self.vertical = self.vertical.turned_by(turn);
            return Some(turn);
        }
        if self.heading.take_field(at, attitude.to_earth(field)) {
            tell(Fault::FieldBent);
        }
        None
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

/// Tells what a sample showed for the first time.
#[cold]
#[inline(never)]
fn tell_news(starved: bool, gyro: &Judged, accel: &Judged, tell: &mut impl FnMut(Fault)) {
    if starved {
        tell(Fault::ImuStarved);
    }
    for (judged, [frozen, rail, jumping]) in [
        (
            gyro,
            [Fault::GyroFrozen, Fault::GyroRail, Fault::GyroJumping],
        ),
        (
            accel,
            [Fault::AccelFrozen, Fault::AccelRail, Fault::AccelJumping],
        ),
    ] {
        match judged.changed {
            Some(Condition::Frozen) => tell(frozen),
            Some(Condition::AtRail) => tell(rail),
            Some(Condition::Jumping) => tell(jumping),
            Some(Condition::Alive) | None => {}
        }
        if judged.spike {
            tell(Fault::ImuSpike);
        }
    }
}
