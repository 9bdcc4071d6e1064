//! The MPU6050's motion detector beside the software, sample by sample.
//!
//! In HOLD the detector sees the acceleration less the sample held, and forgets
//! nothing. Three things differ from the comparison of register values. The
//! detector sees the filtered value before it is rounded to a count, so where
//! the registers show a change within one count of the threshold (0.5 mg at
//! +-16 g) either answer is right; and where they stand at their end, the
//! low-pass filter may have swung beyond it. And it interrupts once per crossing: its
//! counter must fall before it can rise again.
//!
//! Re-arming takes samples: a new ACCEL_HPF acts on the next 1 kHz value, so
//! Reset and the filter must be written on two sides of one. After Reset the
//! corners have the last value under Reset as their zero, HOLD its own first.

use std::sync::Arc;

use embedded_hal::i2c::I2c;
use reflex::math::Vec3;
use reflex::settings::Reference;
use reflex_drivers::mpu6050::{
    ADDRESS, BURST_LENGTH, BURST_START, ImuBurst, ImuConfig, InterruptSource, MotionDecrement,
    MotionDetector, MotionHighPass, MotionThreshold, Mpu6050 as Driver,
};

use super::comparison::{Comparison, Decision, Sample, Tally};
use super::ports::I2cPort;
use super::streams::{Dice, Kind, Stream};
use chip_models::bus::Chip;
use chip_models::stimulus::STANDARD_GRAVITY;
use chip_models::testing::real;
use chip_models::{ChipOptions, Mpu6050, StimulusSource};

/// Units per count of the data registers: samples and thresholds are whole.
pub const PER_COUNT: f32 = 125.0;
/// A count of MOT_THR: 32 mg are 65.536 counts at 2048 per g.
const PER_CODE: f32 = 65.536 * PER_COUNT;
/// One count in m/s2.
pub const COUNT: f64 = STANDARD_GRAVITY / 2048.0;
/// Internal samples until the detector is valid, and a few more.
const START: u64 = 10;
const PERIOD_NS: u64 = 1_000_000;

/// Filter, and when the chip is re-armed.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Filter before the comparison.
    pub high_pass: MotionHighPass,
    /// Which reference the software compares with.
    pub reference: Reference,
    /// Most samples between two re-armings; an interrupt is always followed by one.
    pub longest: u32,
}

impl Setting {
    /// Samples per time constant of the high-pass (RM-MPU-6000A, register 28).
    pub fn memory(&self) -> f64 {
        let corner_hz = match self.high_pass {
            MotionHighPass::Hz5 => 5.0,
            MotionHighPass::Hz2_5 => 2.5,
            MotionHighPass::Hz1_25 => 1.25,
            MotionHighPass::Hz0_63 => 0.63,
            MotionHighPass::Hold => 0.0,
            MotionHighPass::Reset => unreachable!("never detects anything"),
        };
        1000.0 / (std::f64::consts::TAU * corner_hz)
    }
}

/// Data-ready and motion on the pin, one sample per millisecond.
pub fn config(high_pass: MotionHighPass, code: u8) -> ImuConfig {
    ImuConfig {
        motion: Some(MotionDetector {
            high_pass,
            threshold: MotionThreshold::from_code(code).expect("codes start at 1"),
            duration_ms: 1,
            decrement: MotionDecrement::Reset,
        }),
        interrupt: InterruptSource::DataReadyAndMotion,
        ..ImuConfig::FLIGHT
    }
}

/// A chip on a stream, with the driver at its bus.
pub struct Rig {
    chip: Mpu6050,
    config: ImuConfig,
    now_ns: u64,
}

impl Rig {
    /// A specimen as bought, configured, on changes of about so many codes.
    pub fn new(config: ImuConfig, codes: f64, (kind, seed): (Kind, u64), samples: u32) -> Self {
        let size = codes * 0.032;
        let stream = Stream::new((kind, seed), (samples, PERIOD_NS), size, [0.0, 0.0, 1.0]);
        Self::on(stream.into_force(), real(seed), config)
    }

    /// The same on any signal.
    pub fn on(source: Arc<dyn StimulusSource>, options: ChipOptions, config: ImuConfig) -> Self {
        let mut rig = Self {
            chip: Mpu6050::new(source, options),
            config,
            now_ns: 0,
        };
        let configured = rig.driver().configure(&config);
        configured.expect("the chip holds what was written");
        while rig.chip.samples() < START {
            rig.next();
        }
        rig
    }

    pub fn driver(&mut self) -> Driver<I2cPort<'_>> {
        Driver::new(self.port(), ADDRESS)
    }

    fn port(&mut self) -> I2cPort<'_> {
        let (chip, now_ns) = (&mut self.chip, self.now_ns);
        I2cPort { chip, now_ns }
    }

    /// The newest sample's instant.
    pub fn now_ns(&self) -> u64 {
        self.now_ns
    }

    /// Waits for the next sample: its counts, and whether motion was detected.
    pub fn next(&mut self) -> ([i16; 3], bool) {
        let before = self.chip.samples();
        while self.chip.samples() == before {
            self.now_ns = self.chip.next_event();
            self.chip.advance(self.now_ns);
        }
        let mut bytes = [0; BURST_LENGTH];
        let read = self.port().write_read(ADDRESS, &[BURST_START], &mut bytes);
        read.expect("the bus works");
        let burst = ImuBurst::from_bytes(&bytes);
        (burst.accel, burst.interrupt_status.motion())
    }

    /// Re-arms the detector; the sample that it will compare with.
    pub fn rearm(&mut self) -> [i16; 3] {
        let config = self.config;
        let released = self.driver().release_motion_reference(&config);
        released.expect("the chip holds what was written");
        let (last, detected) = self.next();
        assert!(!detected, "nothing passes the filter under reset");
        let taken = self.driver().take_motion_reference(&config);
        taken.expect("the chip holds what was written");
        let holds = config
            .motion
            .is_some_and(|motion| motion.high_pass == MotionHighPass::Hold);
        if !holds {
            return last;
        }
        let (held, detected) = self.next();
        assert!(!detected, "the sample held differs from itself by nothing");
        held
    }
}

/// A sample as whole units.
pub fn whole(counts: [i16; 3]) -> Sample {
    let ends = |count: i16| count == i16::MAX || count == i16::MIN;
    let [x, y, z] = counts.map(|count| f32::from(count) * PER_COUNT);
    Sample {
        axes: Vec3::new(x, y, z),
        clipped: counts.into_iter().any(ends),
    }
}

/// The software's comparison, armed with a sample.
pub fn comparison(reference: Reference, code: u8, first: [i16; 3]) -> Comparison {
    let unit = COUNT / f64::from(PER_COUNT);
    Comparison::new(reference, f32::from(code) * PER_CODE, unit, whole(first))
}

/// Every decision of one stream under one threshold.
pub fn watch(
    setting: &Setting,
    code: u8,
    stream: (Kind, u64),
    samples: u32,
    judge: &mut dyn FnMut(&Decision),
) {
    let config = config(setting.high_pass, code);
    // Single samples of a smooth signal differ by less than it moves in all.
    let wide = if setting.reference == Reference::PreviousSample {
        8.0
    } else {
        1.0
    };
    let mut rig = Rig::new(config, f64::from(code) * wide, stream, samples);
    let mut dice = Dice::new(!stream.1);
    let first = rig.rearm();
    let mut comparison = comparison(setting.reference, code, first);
    let mut left = dice.count(1, setting.longest);
    while rig.chip.samples() < u64::from(samples) {
        let (counts, detected) = rig.next();
        let decision = comparison.decide(whole(counts), detected);
        judge(&decision);
        left -= 1;
        if left == 0 || decision.chip {
            comparison.rearm_at(whole(rig.rearm()));
            left = dice.count(1, setting.longest);
        }
    }
}

/// Decisions over a range of codes, all kinds of streams for each.
pub fn sweep(setting: &Setting, codes: impl IntoIterator<Item = u8>, samples: u32) -> Tally {
    let mut tally = Tally::default();
    for code in codes {
        for (n, kind) in (0..).zip(Kind::ALL) {
            let seed = u64::from(code) * 16 + n;
            watch(setting, code, (kind, seed), samples, &mut |decision| {
                tally.note(decision);
            });
        }
    }
    tally
}
