//! The LSM303AGR's accelerometer beside the software, sample by sample.
//!
//! Generator 1 sees the sample less the high-pass filter's zero. Reading
//! REFERENCE_A makes the present sample the zero, exactly; from then on the
//! zero follows the signal with the filter's time constant. After n samples it
//! has moved by at most `(1 - exp(-(n - 1) / (rate tau)))` of the largest
//! change between, and decisions can differ only where the change is no
//! further from the threshold than that.

use std::sync::Arc;

use reflex::math::Vec3;
use reflex::settings::Reference;
use reflex_drivers::lsm303agr::register::{CTRL_REG1_A, CTRL_REG4_A};
use reflex_drivers::lsm303agr::{
    AccelCounts, AccelDataRate, AccelFullScale, AccelInterrupt, AccelMode, AccelOutput, AccelPin,
    AccelThreshold, Accelerometer as Driver, Axes, HighPass, HighPassCorner, HighPassMode,
    ThresholdDuration,
};

use super::comparison::{Comparison, Decision, Sample, Tally};
use super::ports::SpiPort;
use super::streams::{Dice, Kind, Stream};
use chip_models::bus::Chip;
use chip_models::lsm303agr::Accelerometer;
use chip_models::stimulus::STANDARD_GRAVITY;
use chip_models::testing::{real, write_spi};
use chip_models::{ChipOptions, StimulusSource};

/// The unit in which samples and thresholds are whole: 10 micro-g.
const UNIT: f64 = 1e-5 * STANDARD_GRAVITY;
/// A count of INT1_THS_A at +-2 g, 16 mg.
const CODE: f32 = 1600.0;

/// When the chip is re-armed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Runs {
    /// After every sample: the chip compares with the previous one.
    EverySample,
    /// After every interrupt, as control does, and after 1 to this many samples.
    AfterInterrupts(u32),
    /// After 1 to this many samples, whatever the chip says.
    Blind(u32),
}

/// A data rate and when the chip is re-armed; always at the lowest corner.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The data rate.
    pub rate: AccelDataRate,
    /// When the chip is re-armed.
    pub runs: Runs,
}

impl Setting {
    /// Samples per time constant of the high-pass: `rate / (2 pi corner)`.
    pub fn memory(&self) -> f64 {
        self.rate_hz() / (std::f64::consts::TAU * self.corner_hz())
    }

    pub fn rate_hz(&self) -> f64 {
        f64::from(self.rate.nominal().0)
    }

    /// The lowest corner as AN4825 tables it.
    fn corner_hz(&self) -> f64 {
        match self.rate {
            AccelDataRate::Hz10 => 0.02,
            AccelDataRate::Hz25 => 0.05,
            AccelDataRate::Hz50 => 0.1,
            AccelDataRate::Hz100 => 0.2,
            AccelDataRate::Hz200 => 0.5,
            AccelDataRate::Hz400 => 1.0,
            AccelDataRate::Hz1 | AccelDataRate::Hz1344 => unreachable!("not used by the board"),
        }
    }

    fn reference(&self) -> Reference {
        match self.runs {
            Runs::EverySample => Reference::PreviousSample,
            Runs::AfterInterrupts(_) | Runs::Blind(_) => Reference::LastRun,
        }
    }
}

/// As the firmware sets the generator up (`accel_interrupt`), with a mode.
fn interrupt(code: u8, mode: HighPassMode) -> AccelInterrupt {
    AccelInterrupt {
        high_pass: Some(HighPass {
            mode,
            corner: HighPassCorner::FourHundredth,
        }),
        axes: Axes::ALL,
        threshold: AccelThreshold::from_code(code).expect("codes start at 1"),
        duration: ThresholdDuration::IMMEDIATE,
        latch: true,
        pin: AccelPin::Threshold,
    }
}

fn driver(chip: &mut Accelerometer, now_ns: u64) -> Driver<SpiPort<'_>> {
    Driver::new(SpiPort { chip, now_ns })
}

/// A sample as whole units: 0.98 mg per digit of 12 bits, 3.9 mg per digit of 10.
///
/// The comparator sees what the registers show, so none counts as clipped.
fn whole(AccelCounts(counts): AccelCounts, mode: HighPassMode) -> Sample {
    let (zeros, digit) = match resolution(mode) {
        AccelMode::HighResolution => (4, 98.0),
        AccelMode::Normal | AccelMode::LowPower => (6, 390.0),
    };
    let [x, y, z] = counts.map(|count| f32::from(count >> zeros) * digit);
    let (axes, clipped) = (Vec3::new(x, y, z), false);
    Sample { axes, clipped }
}

/// ST forbids `ResetAtInterrupt` with the high resolution.
fn resolution(mode: HighPassMode) -> AccelMode {
    match mode {
        HighPassMode::ResetAtInterrupt => AccelMode::Normal,
        _ => AccelMode::HighResolution,
    }
}

/// A chip on a stream, sampling, with its first sample as the zero.
pub struct Rig {
    chip: Accelerometer,
    comparison: Comparison,
    mode: HighPassMode,
    now_ns: u64,
}

impl Rig {
    /// On a seeded stream whose changes are about the threshold.
    pub fn new(
        setting: &Setting,
        code: u8,
        (kind, seed): (Kind, u64),
        (samples, mode): (u32, HighPassMode),
    ) -> Self {
        let period_ns = (1e9 / setting.rate_hz()) as u64;
        // Single samples of a smooth signal differ by less than it moves in all.
        let wide = match setting.runs {
            Runs::EverySample => 6.0,
            Runs::AfterInterrupts(_) | Runs::Blind(_) => 1.0,
        };
        let size = f64::from(code) * 0.016 * wide;
        let span = (samples + 8, period_ns);
        let stream = Stream::new((kind, seed), span, size, [0.0, 0.0, 1.0]);
        Self::on(setting, code, mode, (stream.into_force(), real(seed)))
    }

    /// On any signal: configured, sampling and re-armed with its first sample.
    pub fn on(
        setting: &Setting,
        code: u8,
        mode: HighPassMode,
        (source, options): (Arc<dyn StimulusSource>, ChipOptions),
    ) -> Self {
        let mut chip = Accelerometer::new(source, options);
        let output = AccelOutput {
            data_rate: setting.rate,
            full_scale: AccelFullScale::G2,
            mode: resolution(mode),
        };
        let high = u8::from(output.mode == AccelMode::HighResolution) << 3;
        let rate = odr(setting.rate) << 4 | 0x07;
        write_spi(
            &mut chip,
            0,
            &[(CTRL_REG4_A, 0x81 | high), (CTRL_REG1_A, rate)],
        );
        let mut port = driver(&mut chip, 0);
        port.verify_output(output).expect("it was just written");
        let interrupt = interrupt(code, mode);
        port.configure_interrupt(interrupt).expect("the bus works");
        let now_ns = chip.next_event();
        chip.advance(now_ns);
        let mut port = driver(&mut chip, now_ns);
        port.rearm().expect("the bus works");
        port.clear_request().expect("the bus works");
        let first = whole(port.read_sample().expect("the bus works"), mode);
        let threshold = f32::from(code) * CODE;
        Self {
            chip,
            comparison: Comparison::new(setting.reference(), threshold, UNIT, first),
            mode,
            now_ns,
        }
    }

    /// The next sample's decisions; releases the latch.
    pub fn next(&mut self) -> Decision {
        let at_ns = self.chip.next_event();
        self.chip.advance(at_ns);
        self.now_ns = at_ns;
        let fired = self.chip.interrupt();
        let mut port = driver(&mut self.chip, at_ns);
        let sample = port.read_sample().expect("the bus works");
        port.clear_request().expect("the bus works");
        self.comparison.decide(whole(sample, self.mode), fired)
    }

    /// A run at a random instant between this sample and the next.
    pub fn run(&mut self, dice: &mut Dice) {
        let gap_ns = self.chip.next_event() - self.now_ns;
        let at_ns = self.now_ns + (gap_ns as f64 * dice.within(0.0, 0.9)) as u64;
        let mut port = driver(&mut self.chip, at_ns);
        port.rearm().expect("the bus works");
        self.comparison.rearm();
    }

    /// A run for which the chip has re-armed itself.
    pub fn run_without_the_bus(&mut self) {
        self.comparison.rearm();
    }
}

fn odr(rate: AccelDataRate) -> u8 {
    match rate {
        AccelDataRate::Hz10 => 2,
        AccelDataRate::Hz25 => 3,
        AccelDataRate::Hz50 => 4,
        AccelDataRate::Hz100 => 5,
        AccelDataRate::Hz200 => 6,
        AccelDataRate::Hz400 => 7,
        AccelDataRate::Hz1 | AccelDataRate::Hz1344 => unreachable!("not used by the board"),
    }
}

/// Every decision of one stream under one threshold.
pub fn watch(
    setting: &Setting,
    code: u8,
    stream: (Kind, u64),
    samples: u32,
    judge: &mut dyn FnMut(&Decision),
) {
    let mut rig = Rig::new(
        setting,
        code,
        stream,
        (samples, HighPassMode::ResetByReading),
    );
    let mut dice = Dice::new(!stream.1);
    let mut left = 1;
    for _ in 0..samples {
        let decision = rig.next();
        judge(&decision);
        left -= 1;
        let (longest, follows) = match setting.runs {
            Runs::EverySample => (1, true),
            Runs::AfterInterrupts(longest) => (longest, decision.chip),
            Runs::Blind(longest) => (longest, false),
        };
        if left == 0 || follows {
            rig.run(&mut dice);
            left = dice.count(1, longest);
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

/// The same for wanted thresholds of half-way codes, each lowered as the
/// firmware lowers it where a failsafe run may come after `age` samples.
pub fn lowered_sweep(
    setting: &Setting,
    wanted: impl IntoIterator<Item = u8>,
    (age, samples): (u32, u32),
) -> Tally {
    let mut tally = Tally::default();
    for wanted in wanted {
        let threshold = (f64::from(wanted) + 0.5) * 0.016 * STANDARD_GRAVITY;
        let Some(code) = lowered(wanted, f64::from(age) / setting.memory()) else {
            continue;
        };
        for (n, kind) in (0..).zip(Kind::ALL) {
            let seed = u64::from(wanted) * 16 + n;
            watch(setting, code, (kind, seed), samples, &mut |decision| {
                tally.note(&Decision {
                    threshold,
                    software: decision.change > threshold,
                    ..*decision
                });
            });
        }
    }
    tally
}

/// The code for half a step above `wanted` after a decay of `age` time constants.
pub fn lowered(wanted: u8, age: f64) -> Option<u8> {
    let code = ((f64::from(wanted) + 0.5) * (-age).exp()).floor() as u8;
    (code >= 1).then_some(code)
}
