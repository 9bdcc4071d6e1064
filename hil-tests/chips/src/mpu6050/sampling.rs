//! From the true motion to filtered samples, on the MPU6050's own clock.
//!
//! The gyroscope is sampled at 8 kHz, clipped, low-passed and then decimated;
//! the accelerometer at 1 kHz. Both rates and bandwidths are from RM-MPU-6000A
//! (registers 25 and 26), noise and clock tolerance from PS-MPU-6000A.
//!
//! The register map gives a bandwidth and a delay per DLPF_CFG but no filter.
//! The model keeps every bandwidth exactly, with two Butterworth poles at 98 Hz
//! and above and one pole below (its delay is the nearer one there), and adds
//! what the delay lacks as a pure delay. At 10 and 5 Hz one pole is already
//! slower than the map (15.9 for 13.4 ms, 31.8 for 18.6 ms).

use std::sync::Arc;

use super::registers::{ClockSource, Setup};
use crate::filter::LowPass;
use crate::noise::{Noise, Stream, symmetric_axes};
use crate::options::{ChipOptions, Present, ZeroRate};
use crate::oscillator::{self, Pace, Ticker};
use crate::stimulus::{STANDARD_GRAVITY, Sensor, StimulusSource};

/// Internal rate of the gyroscope's converter, Hz.
const GYRO_RATE: f64 = 8000.0;
/// Gyroscope ticks per accelerometer tick (1 kHz).
pub const TICKS_PER_ACCEL: u64 = 8;
/// Bandwidth in Hz and delay in s by DLPF_CFG, RM-MPU-6000A register 26.
const GYRO_FILTERS: [(f64, f64); 7] = [
    (256.0, 0.98e-3),
    (188.0, 1.9e-3),
    (98.0, 2.8e-3),
    (42.0, 4.8e-3),
    (20.0, 8.3e-3),
    (10.0, 13.4e-3),
    (5.0, 18.6e-3),
];
const ACCEL_FILTERS: [(f64, f64); 7] = [
    (260.0, 0.0),
    (184.0, 2.0e-3),
    (94.0, 3.0e-3),
    (44.0, 4.9e-3),
    (21.0, 8.5e-3),
    (10.0, 13.8e-3),
    (5.0, 19.0e-3),
];
/// Rate noise density 0.005 deg/s/sqrt(Hz), PS-MPU-6000A 6.1.
const GYRO_NOISE_DENSITY: f64 = 0.005;
/// Acceleration noise density 400 ug/sqrt(Hz), PS-MPU-6000A 6.2.
const ACCEL_NOISE_DENSITY: f64 = 400e-6;
/// Relaxation oscillator: initial tolerance 5 %, PS-MPU-6000A 6.6.
const RELAXATION_TOLERANCE: f64 = 0.05;
/// Gyroscope clock: 1 % initially and 1 % over temperature, same section.
const GYRO_CLOCK_TOLERANCE: f64 = 0.02;
/// Most that the zero-rate output moves, deg/s per degree Celsius: 20 deg/s up to 85 degrees,
/// PS-MPU-6000A 6.1.
const ZERO_RATE_PER_DEGREE: f64 = 20.0 / 60.0;
/// Time constant of the die's warming up, s.
const WARMING_S: f64 = 60.0;
const FULL_SCALE_COUNTS: f64 = 32_768.0;

/// A low-pass and the pure delay that goes with it.
#[derive(Clone, Copy, Debug)]
struct Channel {
    filter: LowPass,
    delay_ns: u64,
}

impl Channel {
    fn design((corner_hz, delay_s): (f64, f64), rate_hz: f64) -> Self {
        let one_pole = LowPass::one_pole(corner_hz, rate_hz);
        let butterworth = LowPass::butterworth(corner_hz, rate_hz);
        let filter = if butterworth.delay() / rate_hz <= delay_s {
            butterworth
        } else {
            one_pole
        };
        let missing = delay_s - filter.delay() / rate_hz;
        Self {
            filter,
            delay_ns: (missing.max(0.0) * 1e9).round() as u64,
        }
    }
}

/// What one internal tick brought.
#[derive(Clone, Copy, Debug)]
pub struct Tick {
    /// When, in ns.
    pub at_ns: u64,
    /// A new 1 kHz accelerometer value was made.
    pub accel: bool,
    /// The sample-rate divider ran out: an output sample is due.
    pub output: bool,
}

/// The analogue front ends, their clock and their filters.
pub struct Sampler {
    source: Arc<dyn StimulusSource>,
    present: Present,
    relaxation: Pace,
    gyro_clock: Pace,
    zero_rate: ZeroRate,
    /// Each axis' share of the most at turn-on, and of that of the temperature.
    zero_rate_shares: [[f64; 3]; 2],
    gyro_noise: Noise,
    accel_noise: Noise,
    gyro_channel: Channel,
    accel_channel: Channel,
    clock: Option<Ticker>,
    clock_source: ClockSource,
    low_pass: u8,
    /// Filtered rate in deg/s.
    pub gyro: [f64; 3],
    /// Filtered specific force in g.
    pub accel: [f64; 3],
}

impl Sampler {
    /// A sampler that sleeps until it is configured awake.
    pub fn new(source: Arc<dyn StimulusSource>, options: &ChipOptions) -> Self {
        let noise = |stream, present| Noise::new(options.seed, stream, options.noise && present);
        let pace = |stream, tolerance| Pace::new(oscillator::error(options, stream, tolerance));
        Self {
            source,
            present: options.present,
            relaxation: pace(Stream::Mpu6050RelaxationOscillator, RELAXATION_TOLERANCE),
            gyro_clock: pace(Stream::Mpu6050GyroClock, GYRO_CLOCK_TOLERANCE),
            zero_rate: options.zero_rate,
            zero_rate_shares: [Stream::Mpu6050TurnOn, Stream::Mpu6050Temperature]
                .map(|stream| symmetric_axes(options.seed, stream)),
            gyro_noise: noise(Stream::Mpu6050Gyro, options.present.gyro),
            accel_noise: noise(Stream::Mpu6050Accelerometer, options.present.accelerometer),
            gyro_channel: Channel::design(GYRO_FILTERS[0], GYRO_RATE),
            accel_channel: Channel::design(ACCEL_FILTERS[0], 1000.0),
            clock: None,
            clock_source: ClockSource::Stopped,
            low_pass: 0,
            gyro: [0.0; 3],
            accel: [0.0; 3],
        }
    }

    /// Takes over a configuration written at `now_ns`.
    pub fn configure(&mut self, now_ns: u64, setup: &Setup) {
        if setup.low_pass != self.low_pass {
            self.low_pass = setup.low_pass;
            let index = usize::from(setup.low_pass);
            self.gyro_channel = Channel::design(GYRO_FILTERS[index], GYRO_RATE);
            self.accel_channel = Channel::design(ACCEL_FILTERS[index], 1000.0);
        }
        if !setup.awake || setup.clock == ClockSource::Stopped {
            self.clock = None;
            return;
        }
        let error = self.clock_error(setup.clock);
        match &mut self.clock {
            None => {
                self.reset();
                self.clock = Some(Ticker::start(now_ns, GYRO_RATE, error));
            }
            Some(clock) if setup.clock != self.clock_source => clock.retune(GYRO_RATE, error),
            Some(_) => {}
        }
        self.clock_source = setup.clock;
    }

    /// All clocks are faster by a share from now on.
    pub fn hurry(&mut self, share: f64) {
        self.relaxation.hurry(share);
        self.gyro_clock.hurry(share);
        let error = self.clock_error(self.clock_source);
        if let Some(clock) = &mut self.clock {
            clock.retune(GYRO_RATE, error);
        }
    }

    fn clock_error(&self, source: ClockSource) -> f64 {
        match source {
            ClockSource::Gyro => self.gyro_clock.error(),
            _ => self.relaxation.error(),
        }
    }

    /// Clears the signal paths: the filters settle on what comes next.
    pub fn reset(&mut self) {
        self.gyro_channel.filter.reset();
        self.accel_channel.filter.reset();
    }

    /// Takes the next internal tick if it falls at or before `now_ns`.
    pub fn tick(&mut self, now_ns: u64, setup: &Setup) -> Option<Tick> {
        let clock = self.clock.as_mut()?;
        let at_ns = clock.tick(now_ns)?;
        let ticks = clock.ticks();
        let accel = ticks.is_multiple_of(TICKS_PER_ACCEL);
        self.sample_gyro(at_ns, setup);
        if accel {
            self.sample_accel(at_ns, setup);
        }
        Some(Tick {
            at_ns,
            accel,
            output: ticks.is_multiple_of(setup.divider),
        })
    }

    fn sample_gyro(&mut self, at_ns: u64, setup: &Setup) {
        if !self.present.gyro {
            return;
        }
        let truth = self
            .source
            .gyro(at_ns.saturating_sub(self.gyro_channel.delay_ns));
        let limit = FULL_SCALE_COUNTS / setup.gyro_counts;
        let at_rest = self.at_rest(at_ns);
        let rate: [f64; 3] = std::array::from_fn(|axis| truth[axis].to_degrees() + at_rest[axis]);
        let sigma = GYRO_NOISE_DENSITY * (GYRO_RATE / 2.0).sqrt();
        let rate = self.gyro_noise.add(rate, sigma);
        let rate = rate.map(|axis| axis.clamp(-limit, limit));
        let rate = self.gyro_channel.filter.step(rate);
        self.gyro = self.source.delivered(Sensor::Gyroscope, at_ns, rate);
    }

    /// What the gyroscope shows at rest, deg/s.
    fn at_rest(&self, at_ns: u64) -> [f64; 3] {
        if self.zero_rate == ZeroRate::default() {
            return [0.0; 3];
        }
        let [turn_on, per_degree] = self.zero_rate_shares;
        let warmed = self.warmed_up(at_ns) * ZERO_RATE_PER_DEGREE;
        std::array::from_fn(|axis| {
            turn_on[axis] * self.zero_rate.turn_on_deg_s + per_degree[axis] * warmed
        })
    }

    /// By how much the die is warmer than at the start, degrees Celsius.
    fn warmed_up(&self, at_ns: u64) -> f64 {
        self.zero_rate.warm_up_c * -(at_ns as f64 * (-1e-9 / WARMING_S)).exp_m1()
    }

    fn sample_accel(&mut self, at_ns: u64, setup: &Setup) {
        if !self.present.accelerometer {
            return;
        }
        let truth = self
            .source
            .specific_force(at_ns.saturating_sub(self.accel_channel.delay_ns));
        let limit = FULL_SCALE_COUNTS / setup.accel_counts;
        let force = truth.map(|axis| axis / STANDARD_GRAVITY);
        let sigma = ACCEL_NOISE_DENSITY * 500.0_f64.sqrt();
        let force = self.accel_noise.add(force, sigma);
        let force = force.map(|axis| axis.clamp(-limit, limit));
        let force = self.accel_channel.filter.step(force);
        self.accel = (self.source).delivered(Sensor::ImuAccelerometer, at_ns, force);
    }

    /// Temperature of the die at `at_ns`, degrees Celsius.
    pub fn temperature(&self, at_ns: u64) -> f64 {
        self.source.temperature_c(at_ns) + self.warmed_up(at_ns)
    }

    /// When the next tick that is a multiple of `every` falls, in ns.
    pub fn next(&self, every: u64) -> u64 {
        self.clock.as_ref().map_or(u64::MAX, |clock| {
            clock.instant((clock.ticks() / every + 1) * every)
        })
    }
}
