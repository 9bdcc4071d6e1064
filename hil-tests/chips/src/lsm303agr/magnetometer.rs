//! The magnetometer die: sampling, offsets, interrupt, bus.
//!
//! Output = field - OFFSET, always; the threshold sees the difference too when
//! INT_on_DataOFF is set. A noisy specimen has an offset unless OFF_CANC is
//! set, and drifts with temperature unless COMP_TEMP_EN is; what else these
//! do, to noise and bandwidth, is not modelled. Low power changes nothing but
//! the single-shot time. Self-test is not modelled.
//!
//! CFG_REG_C_M bit 2 is reserved here and is the four-wire bit of the
//! stand-alone die (LIS2MDL): set, the data pin no longer answers.

use std::sync::Arc;

use super::magnetometer_registers::{self as map, Mode, Registers};
use super::magnetometer_threshold::Threshold;
use super::output::Outputs;
use super::spi::{Addressing, Byte, Transaction};
use crate::bus::{Chip, SpiChip};
use crate::filter::HighPass;
use crate::noise::{Noise, Stream, symmetric_axes};
use crate::options::ChipOptions;
use crate::oscillator::{self, Pace, Ticker};
use crate::own_clock::OwnClock;
use crate::stimulus::{Sensor, StimulusSource, mounted};

/// Tolerance of the data rate. The datasheet gives none: typical of the family.
const TOLERANCE: f64 = 0.05;
/// RMS noise in gauss, high resolution.
const NOISE_GAUSS: f64 = 3e-3;
/// Most offset in gauss on an axis without OFF_CANC, typical of the family.
const OFFSET_GAUSS: f64 = 0.06;
/// Most drift without COMP_TEMP_EN in gauss for each degree from 25, typical of the family.
const DRIFT_GAUSS: f64 = 3e-4;
/// Rates of a single measurement: 9.4 ms, or 6.4 ms in low power.
const SINGLE_RATE: [f64; 2] = [1e3 / 9.4, 1e3 / 6.4];
const TEMPERATURE_COMPENSATION: u8 = 0x80;
const LOW_POWER: u8 = 0x10;
const OFFSET_CANCELLATION: u8 = 0x02;
const LOW_PASS: u8 = 0x01;
const INTERRUPT_ON_DIFFERENCE: u8 = 0x08;
const DATA_READY_ON_PIN: u8 = 0x01;
const FOUR_WIRES: u8 = 0x04;
const BIG_ENDIAN: u8 = 0x08;
const BLOCK_DATA_UPDATE: u8 = 0x10;
const INTERRUPT_ON_PIN: u8 = 0x40;

/// The magnetometer of an LSM303AGR.
pub struct Magnetometer {
    source: Arc<dyn StimulusSource>,
    present: bool,
    pace: Pace,
    noise: Noise,
    /// What it shows in no field at 25 degrees, and by how much more a degree above, in gauss.
    own: [[f64; 3]; 2],
    registers: Registers,
    mode: Mode,
    clock: Option<Ticker>,
    smoothed: Option<[f64; 3]>,
    outputs: Outputs,
    threshold: Threshold,
    spi: Transaction,
    samples: u64,
    triggers: u64,
    now_ns: u64,
}

impl Magnetometer {
    /// A die just powered: idle.
    pub fn new(source: Arc<dyn StimulusSource>, options: ChipOptions) -> Self {
        let [_, axes] = options.mountings;
        let source = mounted(source, axes);
        let present = options.present.magnetometer;
        let noisy = options.noise && present;
        let stream = Stream::Lsm303agrMagnetometerOscillator;
        Self {
            source,
            present,
            pace: Pace::new(oscillator::error(&options, stream, TOLERANCE)),
            noise: Noise::new(options.seed, Stream::Lsm303agrMagnetometer, noisy),
            own: [
                (Stream::Lsm303agrMagnetometerOffset, OFFSET_GAUSS),
                (Stream::Lsm303agrMagnetometerTemperature, DRIFT_GAUSS),
            ]
            .map(|(stream, most)| {
                let most = if noisy { most } else { 0.0 };
                symmetric_axes(options.seed, stream).map(|share| share * most)
            }),
            registers: Registers::at_reset(),
            mode: Mode::Idle,
            clock: None,
            smoothed: None,
            outputs: Outputs::default(),
            threshold: Threshold::default(),
            spi: Transaction::new(Addressing::IncrementAlways),
            samples: 0,
            triggers: 0,
            now_ns: 0,
        }
    }

    /// A register's value without the side effects of reading it on the bus.
    pub fn register(&self, address: u8) -> u8 {
        match address & 0x7F {
            map::INT_SOURCE_REG_M => self.threshold.source(&self.registers),
            map::STATUS_REG_M => self.outputs.status(),
            address @ map::OUTX_L_REG_M..=map::OUTZ_H_REG_M => {
                let swap = self.registers.has(map::CFG_REG_C_M, BIG_ENDIAN);
                self.outputs.peek(address - map::OUTX_L_REG_M, swap)
            }
            address => self.registers.get(address),
        }
    }

    /// Threshold interrupts begun so far.
    pub fn triggers(&self) -> u64 {
        self.triggers
    }

    /// Threshold in gauss.
    pub fn threshold(&self) -> f64 {
        f64::from(self.registers.threshold()) * map::GAUSS_PER_COUNT
    }

    /// Hard-iron offsets in gauss.
    pub fn offsets(&self) -> [f64; 3] {
        self.registers
            .offsets()
            .map(|code| f64::from(code) * map::GAUSS_PER_COUNT)
    }

    fn reset(&mut self) {
        self.registers = Registers::at_reset();
        self.outputs = Outputs::default();
        self.threshold = Threshold::default();
        self.configure();
    }

    /// Starts the clock anew when the mode changed; every Single is a start.
    fn configure(&mut self) {
        let mode = map::mode(&self.registers);
        if mode == self.mode && mode != Mode::Single {
            return;
        }
        self.mode = mode;
        self.smoothed = None;
        let start = |rate_hz| Ticker::start(self.now_ns, rate_hz, self.pace.error());
        self.clock = self.clock_hz().map(start);
    }

    fn clock_hz(&self) -> Option<f64> {
        match self.mode {
            Mode::Idle => None,
            Mode::Single => {
                let low_power = self.registers.has(map::CFG_REG_A_M, LOW_POWER);
                Some(SINGLE_RATE[usize::from(low_power)])
            }
            Mode::Continuous(rate_hz) => Some(rate_hz),
        }
    }

    fn measure(&mut self, at_ns: u64) {
        let field = match self.present {
            true => self.source.at(at_ns).magnetic_field,
            false => [0.0; 3],
        };
        let field = self.smooth(self.with_own(field, at_ns));
        let field = self.noise.add(field, NOISE_GAUSS);
        let field = self.source.delivered(Sensor::Magnetometer, at_ns, field);
        let counts = field.map(|axis| (axis / map::GAUSS_PER_COUNT).round());
        let range_exceeded = counts.iter().any(|count| count.abs() > f64::from(i16::MAX));
        // A float-to-integer cast saturates: that is the converter's clipping.
        let raw = counts.map(|count| count as i16);
        let offsets = self.registers.offsets().map(i32::from);
        let mut difference = raw.map(i32::from);
        for (value, offset) in difference.iter_mut().zip(offsets) {
            *value -= offset;
        }
        let clip = |value: i32| value.clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16;
        let hold = self.registers.has(map::CFG_REG_C_M, BLOCK_DATA_UPDATE);
        self.outputs.store(difference.map(clip), hold);
        self.samples += 1;
        let compared = match self
            .registers
            .has(map::CFG_REG_B_M, INTERRUPT_ON_DIFFERENCE)
        {
            true => difference,
            false => raw.map(i32::from),
        };
        let began = self
            .threshold
            .step(compared, range_exceeded, &self.registers);
        self.triggers += u64::from(began);
        if self.mode == Mode::Single {
            self.registers.fall_idle();
            self.configure();
        }
    }

    /// The field, and of the die's own what it is not told to correct.
    fn with_own(&self, mut field: [f64; 3], at_ns: u64) -> [f64; 3] {
        let [offset, drift] = self.own;
        let cancelled = self.registers.has(map::CFG_REG_B_M, OFFSET_CANCELLATION);
        let compensated = self
            .registers
            .has(map::CFG_REG_A_M, TEMPERATURE_COMPENSATION);
        for axis in 0..3 {
            if !cancelled {
                field[axis] += offset[axis];
            }
            if !compensated {
                field[axis] += drift[axis] * (self.source.temperature_c(at_ns) - 25.0);
            }
        }
        field
    }

    /// CFG_REG_B_M LPF: bandwidth a quarter of the rate instead of half.
    fn smooth(&mut self, field: [f64; 3]) -> [f64; 3] {
        let blend = match self.registers.has(map::CFG_REG_B_M, LOW_PASS) {
            true => HighPass::blend(0.25, 1.0),
            false => 1.0,
        };
        let smoothed = self.smoothed.get_or_insert(field);
        for (smoothed, field) in smoothed.iter_mut().zip(field) {
            *smoothed += blend * (field - *smoothed);
        }
        *smoothed
    }

    fn store(&mut self, address: u8, value: u8) {
        if address == map::CFG_REG_A_M && value & map::SOFT_RESET != 0 {
            self.reset();
            return;
        }
        self.registers.write(address, value);
        if address == map::CFG_REG_A_M {
            self.configure();
        }
    }

    fn load(&mut self, address: u8) -> u8 {
        let value = self.register(address);
        match address {
            map::INT_SOURCE_REG_M => self.threshold.after_read(&self.registers),
            map::OUTX_L_REG_M..=map::OUTZ_H_REG_M => {
                let swap = self.registers.has(map::CFG_REG_C_M, BIG_ENDIAN);
                self.outputs.read(address - map::OUTX_L_REG_M, swap);
            }
            _ => {}
        }
        value
    }
}

impl OwnClock for Magnetometer {
    fn samples(&self) -> u64 {
        self.samples
    }

    /// The threshold code in force on INT_MAG; `None` where CFG_REG_C_M does not route its
    /// interrupt there.
    fn pin_threshold(&self) -> Option<u32> {
        const INT_MAG_PIN: u8 = 0x40;
        let routed = self.registers.has(map::CFG_REG_C_M, INT_MAG_PIN);
        routed.then(|| u32::from(self.registers.threshold()))
    }

    /// Nominal data rate in Hz; `None` unless measuring continuously.
    fn rate_hz(&self) -> Option<f64> {
        match self.mode {
            Mode::Continuous(rate_hz) => Some(rate_hz),
            Mode::Idle | Mode::Single => None,
        }
    }

    fn flip_threshold_bit(&mut self, now_ns: u64, bit: u8) {
        self.advance(now_ns);
        let value = self.registers.get(map::INT_THS_L_REG_M) ^ (1 << bit);
        self.registers.write(map::INT_THS_L_REG_M, value);
    }

    fn hurry(&mut self, now_ns: u64, share: f64) {
        self.advance(now_ns);
        self.pace.hurry(share);
        if let (Some(rate_hz), Some(clock)) = (self.clock_hz(), &mut self.clock) {
            clock.retune(rate_hz, self.pace.error());
        }
    }

    fn brown_out(&mut self, now_ns: u64) {
        self.advance(now_ns);
        self.reset();
        self.spi.deselect();
    }
}

impl Chip for Magnetometer {
    fn advance(&mut self, now_ns: u64) {
        while let Some(at_ns) = self.clock.as_mut().and_then(|clock| clock.tick(now_ns)) {
            self.measure(at_ns);
        }
        self.now_ns = self.now_ns.max(now_ns);
    }

    fn next_event(&self) -> u64 {
        self.clock
            .as_ref()
            .map_or(u64::MAX, |clock| clock.instant(clock.ticks() + 1))
    }

    /// Level of pin INT_MAG/DRDY.
    fn interrupt(&self) -> bool {
        let routed = |bit| self.registers.has(map::CFG_REG_C_M, bit);
        routed(INTERRUPT_ON_PIN) && self.threshold.level(&self.registers)
            || routed(DATA_READY_ON_PIN) && self.outputs.ready()
    }
}

impl SpiChip for Magnetometer {
    fn select(&mut self, now_ns: u64) {
        self.advance(now_ns);
        self.spi.select();
    }

    fn transfer(&mut self, now_ns: u64, mosi: u8) -> u8 {
        self.advance(now_ns);
        match self.spi.clock(mosi) {
            Some(Byte::Write(address)) => {
                self.store(address, mosi);
                mosi
            }
            Some(Byte::Read(address)) => {
                let value = self.load(address);
                let drives = !self.registers.has(map::CFG_REG_C_M, FOUR_WIRES);
                if drives { value } else { mosi }
            }
            Some(Byte::Command) | None => mosi,
        }
    }

    fn deselect(&mut self, now_ns: u64) {
        self.advance(now_ns);
        self.spi.deselect();
    }
}
