//! From the true specific force to accelerometer codes, on the die's own clock.

use std::sync::Arc;

use super::accelerometer_registers::{Mode, Setup};
use crate::filter::LowPass;
use crate::noise::{Noise, Stream};
use crate::options::ChipOptions;
use crate::oscillator::{self, Pace, Ticker};
use crate::stimulus::{STANDARD_GRAVITY, Sensor, StimulusSource};

/// Tolerance of the data rate. The datasheet gives none: typical of the family.
const TOLERANCE: f64 = 0.05;
/// 220 ug/sqrt(Hz), published for the same element (LIS2DH12, LIS3DH).
const NOISE_DENSITY: f64 = 220e-6;
/// Internal samples per output sample in high resolution.
const OVERSAMPLING: u64 = 8;
/// Output periods before the first valid sample in high resolution (table 15).
const HIGH_RESOLUTION_START: u64 = 7;

/// An output sample in left-justified codes, before any high-pass.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// When, in ns.
    pub at_ns: u64,
    /// X, Y, Z.
    pub codes: [i16; 3],
}

/// How often the front end converts.
fn internal_hz(rate_hz: f64, mode: Mode) -> f64 {
    rate_hz * oversampling(mode) as f64
}

/// The analogue front end, its clock and its anti-alias filter.
pub struct Sampler {
    source: Arc<dyn StimulusSource>,
    present: bool,
    pace: Pace,
    noise: Noise,
    clock: Option<Ticker>,
    programmed: Option<(f64, Mode)>,
    low_pass: LowPass,
    force: [f64; 3],
}

impl Sampler {
    /// A sampler in power-down.
    pub fn new(source: Arc<dyn StimulusSource>, options: &ChipOptions) -> Self {
        let present = options.present.accelerometer;
        let enabled = options.noise && present;
        let stream = Stream::Lsm303agrAccelerometerOscillator;
        Self {
            source,
            present,
            pace: Pace::new(oscillator::error(options, stream, TOLERANCE)),
            noise: Noise::new(options.seed, Stream::Lsm303agrAccelerometer, enabled),
            clock: None,
            programmed: None,
            low_pass: bandwidth(1.0),
            force: [0.0; 3],
        }
    }

    /// Takes over a configuration; a new rate or mode starts the clock anew.
    pub fn configure(&mut self, now_ns: u64, setup: &Setup) {
        let programmed = setup.rate_hz.map(|rate| (rate, setup.mode));
        if programmed == self.programmed {
            return;
        }
        self.programmed = programmed;
        self.clock = programmed.map(|(rate_hz, mode)| {
            self.low_pass = bandwidth(rate_hz);
            Ticker::start(now_ns, internal_hz(rate_hz, mode), self.pace.error())
        });
    }

    /// The clock is faster by a share from now on.
    pub fn hurry(&mut self, share: f64) {
        self.pace.hurry(share);
        if let (Some(clock), Some((rate_hz, mode))) = (&mut self.clock, self.programmed) {
            clock.retune(internal_hz(rate_hz, mode), self.pace.error());
        }
    }

    /// Takes the next output sample if it falls at or before `now_ns`.
    pub fn sample(&mut self, now_ns: u64, setup: &Setup) -> Option<Sample> {
        let per_output = oversampling(setup.mode);
        loop {
            let clock = self.clock.as_mut()?;
            let at_ns = clock.tick(now_ns)?;
            let ticks = clock.ticks();
            self.convert(at_ns, setup);
            let due = ticks.is_multiple_of(per_output) && ticks >= first(setup.mode);
            if due {
                return Some(Sample {
                    at_ns,
                    codes: self.codes(at_ns, setup),
                });
            }
        }
    }

    /// When the next output sample falls, in ns.
    pub fn next(&self, setup: &Setup) -> u64 {
        let per_output = oversampling(setup.mode);
        self.clock.as_ref().map_or(u64::MAX, |clock| {
            let next = (clock.ticks() / per_output + 1) * per_output;
            clock.instant(next.max(first(setup.mode)))
        })
    }

    /// Temperature of the die at `at_ns`, degrees Celsius.
    pub fn temperature(&self, at_ns: u64) -> f64 {
        self.source.temperature_c(at_ns)
    }

    fn convert(&mut self, at_ns: u64, setup: &Setup) {
        if !self.present {
            return;
        }
        let truth = self.source.specific_force(at_ns);
        let force = truth.map(|axis| axis / STANDARD_GRAVITY);
        self.force = match setup.mode {
            Mode::HighResolution => self.low_pass.step(force),
            Mode::Normal | Mode::LowPower => force,
        };
    }

    fn codes(&mut self, at_ns: u64, setup: &Setup) -> [i16; 3] {
        let rate_hz = setup.rate_hz.unwrap_or(0.0);
        let bandwidth = match setup.mode {
            Mode::HighResolution => rate_hz / 9.0,
            Mode::Normal | Mode::LowPower => rate_hz / 2.0,
        };
        let force = self.noise.add(self.force, NOISE_DENSITY * bandwidth.sqrt());
        let force = self.source.delivered(Sensor::Accelerometer, at_ns, force);
        let mut codes = [0; 3];
        for (axis, code) in codes.iter_mut().enumerate() {
            if setup.axes[axis] {
                *code = justify(force[axis] / setup.sensitivity, setup.mode);
            }
        }
        codes
    }
}

/// Rounds digits to the mode's resolution, clips and justifies them left.
pub fn justify(digits: f64, mode: Mode) -> i16 {
    let shift = mode.shift();
    let limit = f64::from(1_i32 << (15 - shift));
    let clipped = digits.round().clamp(-limit, limit - 1.0);
    (clipped as i16) << shift
}

fn oversampling(mode: Mode) -> u64 {
    match mode {
        Mode::HighResolution => OVERSAMPLING,
        Mode::Normal | Mode::LowPower => 1,
    }
}

/// The internal tick of the first valid output sample.
fn first(mode: Mode) -> u64 {
    match mode {
        Mode::HighResolution => HIGH_RESOLUTION_START * OVERSAMPLING,
        Mode::Normal | Mode::LowPower => 1,
    }
}

/// High resolution: bandwidth a ninth of the data rate (datasheet table 13).
fn bandwidth(rate_hz: f64) -> LowPass {
    LowPass::one_pole(rate_hz / 9.0, rate_hz * OVERSAMPLING as f64)
}
