//! The arrival stage: what is done to every sample, run or no run.
//!
//! Each sample is low-pass filtered and summed into delta-angle, delta-velocity and delta-t.
//! The estimator consumes the sums when control runs, so that skipped runs lose no rotation
//! and alias no vibration; the rate law and the triggers see the filtered sample. The angular
//! acceleration is derived here too: between rare runs there is no derivative to take.

use crate::config::{ACCEL_CUTOFF, GYRO_CUTOFF};
use crate::math::Vec3;
use crate::sensors::{GRAVITY, ImuSample};
use crate::time::{Instant, seconds, span};
use crate::units::{BodyRates, SpecificForce};
use core::f32::consts::TAU;

/// Motion between two runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Increment {
    /// Angle turned, in rad, body axes.
    pub angle: Vec3,
    /// What turns about a changing axis add to that angle, in rad (Bortz 1971): rotations do not
    /// commute.
    pub coning: Vec3,
    /// That angle integrated over the time, in rad s: what a demand that falls with the angle
    /// has lost between the runs.
    pub swept: Vec3,
    /// Specific force integrated, in m/s, body axes.
    pub velocity: Vec3,
    /// Direction of down as the specific force shows it, integrated over the time that it can be
    /// trusted, in s, in the body axes that the sums began with.
    ///
    /// Trust falls to zero as a sample's force leaves 1 g: in a manoeuvre it does not show the
    /// vertical. Judged by the mean force between two runs, vibration would pass for rest.
    pub down: Vec3,
    /// Time covered, in seconds; zero where no sample arrived.
    pub dt: f32,
}

/// How the body turns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rotation {
    /// Filtered rates.
    pub rates: BodyRates,
    /// Filtered angular acceleration, in rad/s2.
    pub acceleration: Vec3,
}

impl Increment {
    /// The part of the motion behind an earlier sum of the same run.
    #[must_use]
    pub fn since(&self, earlier: &Self) -> Self {
        Self {
            angle: self.angle - earlier.angle,
            coning: self.coning - earlier.coning,
            swept: self.swept - earlier.swept,
            velocity: self.velocity - earlier.velocity,
            down: self.down - earlier.down,
            dt: self.dt - earlier.dt,
        }
    }
}

/// Everything that a run takes from the arrival stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Sums since the last run.
    pub sums: Increment,
    /// The newest rotation.
    pub rotation: Rotation,
}

/// The longest time between samples that is integrated over, in seconds.
///
/// Ten periods of the slowest gating rate in use; after a longer silence the sums would be
/// invention.
const LONGEST_STEP: f32 = 0.02;

/// Filter states and sums of one inertial sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Arrival {
    last: Option<Instant>,
    rates: TwoPole,
    force: TwoPole,
    acceleration: Vec3,
    sum: Increment,
}

impl Arrival {
    /// Filters and sums a sample, its gyroscope bias already removed.
    ///
    /// False where the stamp went back or stood still, or came over 20 ms behind the one before:
    /// then the filters start anew at this sample, and the time between is not integrated.
    /// `derivative_cutoff` is the corner (Hz) of the filter behind the angular acceleration.
    #[must_use]
    pub fn take(&mut self, sample: &ImuSample, derivative_cutoff: f32) -> bool {
        let step = self.last.map(|last| seconds(span(last, sample.at)));
        self.last = Some(sample.at);
        match step {
            Some(dt) if dt > 0.0 && dt <= LONGEST_STEP => {
                self.advance(sample, dt, TAU * derivative_cutoff);
            }
            _ => self.restart(sample),
        }
        step.is_none_or(|dt| dt > 0.0 && dt <= LONGEST_STEP)
    }

    fn restart(&mut self, sample: &ImuSample) {
        self.rates = TwoPole::at(sample.rates.0);
        self.force = TwoPole::at(sample.force.0);
        self.acceleration = Vec3::ZERO;
    }

    fn advance(&mut self, sample: &ImuSample, dt: f32, corner: f32) {
        let before = self.rates.second;
        self.rates.step(sample.rates.0, dt, GYRO_CUTOFF);
        self.derive(before, dt, corner);
        self.force.step(sample.force.0, dt, ACCEL_CUTOFF);
        let turned = self.rates.second * dt;
        self.sum.swept += (self.sum.angle + turned * 0.5) * dt;
        self.sum.coning += self.sum.angle.cross(turned) * 0.5;
        self.sum.angle += turned;
        self.sum.velocity += self.force.second * dt;
        let down = trusted_down(self.force.second) * dt;
        // To second order: between two runs an aerobatic body turns by a third of a radian.
        let back = down + self.sum.angle.cross(down) * 0.5;
        self.sum.down += down + self.sum.angle.cross(back);
        self.sum.dt += dt;
    }

    /// One pole behind the difference quotient, which is never formed: `dt` cancels out.
    fn derive(&mut self, before: Vec3, dt: f32, corner: f32) {
        let share = 1.0 / (1.0 + corner * dt);
        self.acceleration += (self.rates.second - before) * corner;
        self.acceleration = self.acceleration * share;
    }

    /// What a run would take now.
    #[must_use]
    pub fn motion(&self) -> Motion {
        Motion {
            sums: self.sum,
            rotation: Rotation {
                rates: self.rates(),
                acceleration: self.acceleration,
            },
        }
    }

    /// What a run takes; the sums begin anew.
    pub fn take_motion(&mut self) -> Motion {
        let motion = self.motion();
        self.sum = Increment::default();
        motion
    }

    /// The newest sample's stamp, and the filtered rates behind it.
    #[must_use]
    pub fn newest(&self) -> Option<(Instant, BodyRates)> {
        self.last.map(|at| (at, self.rates()))
    }

    /// The filtered rates.
    #[must_use]
    pub fn rates(&self) -> BodyRates {
        BodyRates(self.rates.second)
    }

    /// The filtered specific force.
    #[must_use]
    pub fn force(&self) -> SpecificForce {
        SpecificForce(self.force.second)
    }
}

/// The direction of down that a specific force (m/s2) shows, as long as it is trusted, 0 to 1.
pub fn trusted_down(force: Vec3) -> Vec3 {
    let size = force.norm();
    let trust = 1.0 - (size - GRAVITY).abs() * (2.0 / GRAVITY);
    if trust > 0.0 {
        force * (-trust / size)
    } else {
        Vec3::ZERO
    }
}

/// Two equal first-order low-passes in a row, at the measured `dt`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct TwoPole {
    first: Vec3,
    second: Vec3,
}

impl TwoPole {
    fn at(value: Vec3) -> Self {
        Self {
            first: value,
            second: value,
        }
    }

    fn step(&mut self, input: Vec3, dt: f32, cutoff: f32) {
        // -3 dB of two equal poles lies at 0.644 of each one's own corner.
        let rate = TAU / 0.6436 * cutoff;
        let gain = rate * dt / (1.0 + rate * dt);
        self.first += (input - self.first) * gain;
        self.second += (self.first - self.second) * gain;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;

    const CUTOFF: f32 = 20.0;

    fn sample(at: u64, rate: f32) -> ImuSample {
        ImuSample {
            at: at_micros(at),
            rates: BodyRates(Vec3::new(rate, 0.0, 0.0)),
            force: SpecificForce(Vec3::new(0.0, 0.0, -9.8)),
        }
    }

    #[test]
    fn sums_cover_the_time_between_samples_whatever_their_spacing() {
        let mut arrival = Arrival::default();
        for at in [0, 900, 2_100, 3_000, 10_000] {
            assert!(arrival.take(&sample(at, 2.0), CUTOFF));
        }
        let sum = arrival.take_motion().sums;
        assert!((sum.dt - 0.01).abs() < 1e-8);
        assert!((sum.angle.x - 0.02).abs() < 1e-6);
        assert!((sum.swept.x - 0.5 * 0.02 * 0.01).abs() < 1e-8);
        assert_eq!(arrival.motion().sums, Increment::default());
    }

    #[test]
    fn down_is_seen_from_where_the_sums_began_however_far_the_body_turned() {
        let (mut arrival, rate, dt) = (Arrival::default(), 20.0, 0.02);
        for at in (0..=20_000).step_by(100) {
            assert!(arrival.take(&sample(at, rate), CUTOFF));
        }
        let sum = arrival.take_motion().sums;
        let (sin, cos) = f32::sin_cos(rate * dt);
        let seen = Vec3::new(0.0, (cos - 1.0) / rate, sin / rate);
        let trust = trusted_down(Vec3::new(0.0, 0.0, -9.8)).norm();
        let off = (sum.down * (1.0 / trust) - seen).max_norm();
        assert!(off < 0.005 * dt, "{off}");
    }

    #[test]
    fn a_steady_angular_acceleration_is_found_whatever_the_spacing() {
        let mut arrival = Arrival::default();
        for step in 0..1000u64 {
            let at = step * 700 + step % 3 * 100;
            assert!(arrival.take(&sample(at, at as f32 * 5e-6), CUTOFF));
        }
        let found = arrival.motion().rotation.acceleration.x;
        assert!((found - 5.0).abs() < 0.3, "{found}");
    }

    #[test]
    fn a_jump_in_time_is_counted_and_not_integrated() {
        let mut arrival = Arrival::default();
        let good = [0, 1_000, 500_000, 499_000].map(|at| arrival.take(&sample(at, 2.0), CUTOFF));
        assert_eq!(good, [true, true, false, false]);
        assert!((arrival.take_motion().sums.dt - 0.001).abs() < 1e-8);
    }

    #[test]
    fn a_sine_at_the_cutoff_passes_with_minus_three_decibels() {
        let mut arrival = Arrival::default();
        let (mut peak, dt) = (0.0f32, 0.000_1);
        for step in 0..20_000u64 {
            let angle = f64::from(TAU) * f64::from(GYRO_CUTOFF) * step as f64 * dt;
            assert!(arrival.take(&sample(step * 100, angle.sin() as f32), CUTOFF));
            if step > 10_000 {
                peak = peak.max(arrival.rates().0.x);
            }
        }
        assert!((peak - 0.707).abs() < 0.02, "{peak}");
    }
}
