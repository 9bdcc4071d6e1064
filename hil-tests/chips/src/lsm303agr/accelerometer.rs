//! The accelerometer die: registers, high-pass routing, interrupts, bus.
//!
//! Not modelled: FIFO (always empty), click, activity, six-direction
//! detection, self-test. Their registers store what is written. BOOT reads as
//! set for 5 ms and, as documented, leaves the user registers alone; the die
//! has no software reset.
//!
//! Thresholds weigh what the datasheet says (16, 32, 62, 186 mg per count) and
//! are compared with the data at full resolution.

use std::sync::Arc;

use super::accelerometer_registers::{self as map, HighPassMode, Registers, Setup};
use super::accelerometer_sampling::{Sample, Sampler, justify};
use super::generator::{self, Generator};
use super::output::Outputs;
use super::spi::{Addressing, Byte, Transaction};
use crate::bus::{Chip, SpiChip};
use crate::filter::HighPass;
use crate::options::ChipOptions;
use crate::own_clock::OwnClock;
use crate::stimulus::{STANDARD_GRAVITY, StimulusSource, mounted};

/// How long a reload of the trimming takes.
const BOOT_NS: u64 = 5_000_000;
const SPI_ENABLE: u8 = 0x01;
const BLOCK_DATA_UPDATE: u8 = 0x80;
const BIG_ENDIAN: u8 = 0x40;
const ACTIVE_LOW: u8 = 0x02;
/// CTRL_REG5_A: latch of generator 1, 2.
const LATCH: [u8; 2] = [0x08, 0x02];

/// The accelerometer of an LSM303AGR.
pub struct Accelerometer {
    registers: Registers,
    setup: Setup,
    sampler: Sampler,
    high_pass: HighPass,
    /// The newest unfiltered sample in g.
    newest: [f64; 3],
    outputs: Outputs,
    temperature: Temperature,
    generators: [Generator; 2],
    spi: Transaction,
    boot_ends_ns: Option<u64>,
    samples: u64,
    triggers: [u64; 2],
    now_ns: u64,
}

/// Temperature registers: left-justified degrees above 25, and their flags.
#[derive(Clone, Copy, Debug, Default)]
struct Temperature {
    code: i16,
    fresh: bool,
    overrun: bool,
}

impl Accelerometer {
    /// A die just powered: in power-down, answering nothing on three wires.
    pub fn new(source: Arc<dyn StimulusSource>, options: ChipOptions) -> Self {
        let [_, axes] = options.mountings;
        let source = mounted(source, axes);
        let registers = Registers::at_reset();
        Self {
            setup: Setup::of(&registers),
            registers,
            sampler: Sampler::new(source, &options),
            high_pass: HighPass::default(),
            newest: [0.0; 3],
            outputs: Outputs::default(),
            temperature: Temperature::default(),
            generators: [Generator::default(); 2],
            spi: Transaction::new(Addressing::IncrementOnRequest),
            boot_ends_ns: None,
            samples: 0,
            triggers: [0; 2],
            now_ns: 0,
        }
    }

    /// A register's value without the side effects of reading it on the bus.
    pub fn register(&self, address: u8) -> u8 {
        let [temperature_low, temperature_high] = self.temperature.code.to_le_bytes();
        match address & 0x3F {
            map::STATUS_REG_AUX_A => {
                u8::from(self.temperature.fresh) << 2 | u8::from(self.temperature.overrun) << 6
            }
            map::OUT_TEMP_L_A => temperature_low,
            map::OUT_TEMP_H_A => temperature_high,
            map::CTRL_REG5_A => {
                let boot = if self.boot_ends_ns.is_some() {
                    map::BOOT
                } else {
                    0
                };
                self.registers.get(map::CTRL_REG5_A) | boot
            }
            map::STATUS_REG_A => self.outputs.status(),
            address @ map::OUT_X_L_A..=map::OUT_Z_H_A => self
                .outputs
                .peek(address - map::OUT_X_L_A, self.big_endian()),
            map::INT1_SRC_A => self.generators[0].source(),
            map::INT2_SRC_A => self.generators[1].source(),
            address => self.registers.get(address),
        }
    }

    /// Interrupts begun by generator 1 and 2 so far.
    pub fn triggers(&self) -> [u64; 2] {
        self.triggers
    }

    /// Threshold of generator 1 and 2 in m/s2.
    pub fn thresholds(&self) -> [f64; 2] {
        [map::INT1_THS_A, map::INT2_THS_A]
            .map(|address| self.threshold_g(address))
            .map(|g| g * STANDARD_GRAVITY)
    }

    /// Level of pin INT_2_XL.
    pub fn interrupt_2(&self) -> bool {
        let routed = |bit, active| self.registers.has(map::CTRL_REG6_A, bit) && active;
        self.polarised(
            routed(0x40, self.generators[0].active()) || routed(0x20, self.generators[1].active()),
        )
    }

    fn configure(&mut self) {
        self.setup = Setup::of(&self.registers);
        self.sampler.configure(self.now_ns, &self.setup);
    }

    fn big_endian(&self) -> bool {
        self.registers.has(map::CTRL_REG4_A, BIG_ENDIAN)
    }

    fn threshold_g(&self, address: u8) -> f64 {
        f64::from(self.registers.get(address)) * self.setup.threshold
    }

    fn polarised(&self, active: bool) -> bool {
        active != self.registers.has(map::CTRL_REG6_A, ACTIVE_LOW)
    }

    fn latched(&self, index: usize) -> bool {
        self.registers.has(map::CTRL_REG5_A, LATCH[index])
    }

    fn generator_setup(&self, index: usize) -> generator::Setup {
        let base = [map::INT1_CFG_A, map::INT2_CFG_A][index];
        generator::Setup {
            config: self.registers.get(base),
            threshold: self.threshold_g(base + 2),
            duration: self.registers.get(base + 3),
            latched: self.latched(index),
        }
    }

    fn take(&mut self, sample: Sample) {
        let setup = self.setup;
        // Codes are left-justified: one unit is a digit's 2^shift-th part.
        let unit = setup.sensitivity / f64::from(1 << setup.mode.shift());
        self.newest = sample.codes.map(|code| f64::from(code) * unit);
        let filtered = self.filter();
        let shown = match setup.filtered_output {
            true => filtered.map(|g| justify(g / setup.sensitivity, setup.mode)),
            false => sample.codes,
        };
        let hold = self.registers.has(map::CTRL_REG4_A, BLOCK_DATA_UPDATE);
        self.outputs.store(shown, hold);
        self.samples += 1;
        for index in 0..2 {
            let value = match setup.filtered_generator[index] {
                true => filtered,
                false => self.newest,
            };
            let generator = self.generator_setup(index);
            if self.generators[index].step(value, &generator) {
                self.triggers[index] += 1;
                if setup.high_pass == HighPassMode::ResetByInterrupt {
                    self.high_pass.snap(self.newest);
                }
            }
        }
        self.measure_temperature(sample.at_ns);
    }

    fn filter(&mut self) -> [f64; 3] {
        let setup = &self.setup;
        if setup.high_pass == HighPassMode::Reference {
            let reference = self.registers.get(map::REFERENCE_A).cast_signed();
            return self
                .newest
                .map(|axis| axis - f64::from(reference) * setup.reference);
        }
        let blend = HighPass::blend(setup.corner_hz, setup.rate_hz.unwrap_or(1.0));
        self.high_pass.step(self.newest, blend)
    }

    fn measure_temperature(&mut self, at_ns: u64) {
        if self.registers.get(map::TEMP_CFG_REG_A) != 0xC0 {
            return;
        }
        let above = self.sampler.temperature(at_ns) - 25.0;
        // 8 bits at 1 digit per degree in low power, else 10 bits at 4 digits.
        let low_power = self.setup.mode == map::Mode::LowPower;
        let mode = if low_power {
            map::Mode::LowPower
        } else {
            map::Mode::Normal
        };
        let digits = if low_power { above } else { 4.0 * above };
        self.temperature.overrun |= self.temperature.fresh;
        self.temperature.fresh = true;
        self.temperature.code = justify(digits, mode);
    }

    fn store(&mut self, address: u8, value: u8) {
        self.registers.write(address, value);
        if address == map::CTRL_REG5_A && value & map::BOOT != 0 {
            self.boot_ends_ns = Some(self.now_ns + BOOT_NS);
        }
        self.configure();
    }

    fn load(&mut self, address: u8) -> u8 {
        let value = self.register(address);
        match address {
            map::OUT_TEMP_H_A => {
                self.temperature.fresh = false;
                self.temperature.overrun = false;
            }
            map::OUT_X_L_A..=map::OUT_Z_H_A => {
                self.outputs
                    .read(address - map::OUT_X_L_A, self.big_endian());
            }
            map::REFERENCE_A if self.setup.high_pass == HighPassMode::ResetByReading => {
                self.high_pass.snap(self.newest);
            }
            map::INT1_SRC_A => {
                self.generators[0].read_source(self.latched(0));
            }
            map::INT2_SRC_A => {
                self.generators[1].read_source(self.latched(1));
            }
            _ => {}
        }
        value
    }
}

impl OwnClock for Accelerometer {
    fn samples(&self) -> u64 {
        self.samples
    }

    /// The threshold code in force on INT_1_XL; `None` where CTRL_REG3_A does not route generator
    /// 1 there.
    fn pin_threshold(&self) -> Option<u32> {
        const I1_AOI1: u8 = 0x40;
        let routed = self.registers.has(map::CTRL_REG3_A, I1_AOI1);
        routed.then(|| u32::from(self.register(map::INT1_THS_A)))
    }

    fn rate_hz(&self) -> Option<f64> {
        self.setup.rate_hz
    }

    fn flip_threshold_bit(&mut self, now_ns: u64, bit: u8) {
        self.advance(now_ns);
        let value = self.registers.get(map::INT1_THS_A) ^ (1 << bit);
        self.registers.write(map::INT1_THS_A, value);
    }

    fn hurry(&mut self, now_ns: u64, share: f64) {
        self.advance(now_ns);
        self.sampler.hurry(share);
    }

    fn brown_out(&mut self, now_ns: u64) {
        self.advance(now_ns);
        self.registers = Registers::at_reset();
        self.high_pass = HighPass::default();
        self.newest = [0.0; 3];
        self.outputs = Outputs::default();
        self.temperature = Temperature::default();
        self.generators = [Generator::default(); 2];
        self.boot_ends_ns = None;
        self.spi.deselect();
        self.configure();
    }
}

impl Chip for Accelerometer {
    fn advance(&mut self, now_ns: u64) {
        while let Some(sample) = self.sampler.sample(now_ns, &self.setup) {
            self.take(sample);
        }
        self.now_ns = self.now_ns.max(now_ns);
        if self.boot_ends_ns.is_some_and(|end| end <= self.now_ns) {
            self.boot_ends_ns = None;
        }
    }

    fn next_event(&self) -> u64 {
        self.sampler.next(&self.setup)
    }

    /// Level of pin INT_1_XL.
    fn interrupt(&self) -> bool {
        let routed = |bit, active| self.registers.has(map::CTRL_REG3_A, bit) && active;
        self.polarised(
            routed(0x40, self.generators[0].active())
                || routed(0x20, self.generators[1].active())
                || routed(0x10, self.outputs.ready()),
        )
    }
}

impl SpiChip for Accelerometer {
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
                let drives = self.registers.has(map::CTRL_REG4_A, SPI_ENABLE);
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
