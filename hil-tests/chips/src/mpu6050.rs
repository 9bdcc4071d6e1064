//! The MPU6050 gyroscope and accelerometer on I2C.
//!
//! Modelled: reset and sleep, clock source, sample-rate divider, both low-pass
//! filters, full-scale ranges with clipping, noise, temperature, standby bits,
//! the motion detector with its high-pass, INT_STATUS and the INT pin, bursts
//! with auto-increment and the held copy of the sensor registers.
//!
//! Not modelled: FIFO, DMP, auxiliary I2C master, FSYNC, self-test, free-fall
//! and zero-motion detection, cycle mode, start-up and PLL settling times.
//! Their registers store what is written; FIFO counts read as zero.
//!
//! Every master write takes effect at once. A read past the end of a burst is
//! answered like any other, since masters with DMA clock one byte too many.

mod interrupt;
mod motion;
mod registers;
mod sampling;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use interrupt::Interrupt;
use motion::MotionDetector;
use registers::{Command, Registers, Setup};
use sampling::Sampler;

use super::bus::{Chip, I2cChip};
use super::options::ChipOptions;
use super::stimulus::{StimulusSource, mounted};

/// Bytes from ACCEL_XOUT_H to GYRO_ZOUT_L.
const SENSOR_BYTES: usize = 14;

/// One MPU6050 with its AD0 pin low.
pub struct Mpu6050 {
    options: ChipOptions,
    registers: Registers,
    setup: Setup,
    sampler: Sampler,
    motion: MotionDetector,
    interrupt: Interrupt,
    /// The newest samples, updated at the sample rate.
    sensors: [u8; SENSOR_BYTES],
    /// The copy a master reads: refreshed only while the bus is idle.
    held: [u8; SENSOR_BYTES],
    port: Port,
    samples: u64,
    motions: u64,
    now_ns: u64,
}

/// Where a transaction stands.
#[derive(Clone, Copy, Debug, Default)]
struct Port {
    busy: bool,
    pointer: u8,
    pointer_follows: bool,
}

impl Mpu6050 {
    /// The 7-bit I2C address with AD0 low.
    pub const ADDRESS: u8 = 0x68;

    /// A chip just powered: asleep, until PWR_MGMT_1 wakes it.
    pub fn new(source: Arc<dyn StimulusSource>, options: ChipOptions) -> Self {
        let [axes, _] = options.mountings;
        let source = mounted(source, axes);
        let registers = Registers::at_reset();
        Self {
            setup: Setup::of(&registers),
            registers,
            sampler: Sampler::new(source, &options),
            options,
            motion: MotionDetector::default(),
            interrupt: Interrupt::default(),
            sensors: [0; SENSOR_BYTES],
            held: [0; SENSOR_BYTES],
            port: Port::default(),
            samples: 0,
            motions: 0,
            now_ns: 0,
        }
    }

    /// A register's value without the side effects of reading it on the bus.
    pub fn register(&self, address: u8) -> u8 {
        match address {
            registers::INT_STATUS => self.interrupt.status(),
            registers::MOT_DETECT_STATUS => self.motion.status(),
            registers::ACCEL_XOUT_H..=registers::GYRO_ZOUT_L => {
                self.sensors[usize::from(address - registers::ACCEL_XOUT_H)]
            }
            address => self.registers.get(address),
        }
    }

    /// Output samples produced so far, across resets.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Interrupts raised since the last reset.
    pub fn interrupts(&self) -> u64 {
        self.interrupt.events()
    }

    /// Motion events detected so far, enabled as an interrupt or not.
    pub fn motions(&self) -> u64 {
        self.motions
    }

    /// Threshold of the motion detector in m/s2.
    pub fn motion_threshold(&self) -> f64 {
        self.threshold_g() * super::stimulus::STANDARD_GRAVITY
    }

    /// A supply dip at `now_ns`: every register falls back to its reset value.
    pub fn brown_out(&mut self, now_ns: u64) {
        self.advance(now_ns);
        self.reset();
        self.port = Port::default();
    }

    /// A register falls to another value by itself: no master wrote it.
    pub fn corrupt(&mut self, now_ns: u64, address: u8, value: u8) {
        self.advance(now_ns);
        self.store(address, value);
    }

    /// From now on its clocks are faster by a share than they were at power-on.
    pub fn hurry(&mut self, now_ns: u64, share: f64) {
        self.advance(now_ns);
        self.sampler.hurry(share);
    }

    fn threshold_g(&self) -> f64 {
        let code = f64::from(self.registers.get(registers::MOT_THR));
        code * self.options.motion_threshold_lsb_mg / 1000.0
    }

    fn reset(&mut self) {
        self.registers = Registers::at_reset();
        self.interrupt = Interrupt::default();
        self.clear_signals();
        self.configure();
    }

    fn clear_signals(&mut self) {
        self.sampler.reset();
        self.motion.reset();
        self.sensors = [0; SENSOR_BYTES];
    }

    fn configure(&mut self) {
        self.setup = Setup::of(&self.registers);
        self.sampler.configure(self.now_ns, &self.setup);
        if !self.setup.awake {
            self.motion.reset();
        }
    }

    fn store(&mut self, address: u8, value: u8) {
        match registers::command(address, value) {
            Command::DeviceReset => self.reset(),
            command => {
                self.registers.write(address, value);
                if command == Command::SignalReset {
                    self.clear_signals();
                }
                self.configure();
            }
        }
    }

    fn load(&mut self, address: u8) -> u8 {
        let value = match address {
            registers::MOT_DETECT_STATUS => self.motion.read_status(),
            registers::ACCEL_XOUT_H..=registers::GYRO_ZOUT_L => {
                self.held[usize::from(address - registers::ACCEL_XOUT_H)]
            }
            address => self.register(address),
        };
        let of_status = address == registers::INT_STATUS;
        self.interrupt.after_read(of_status, &self.registers);
        value
    }

    fn detect_motion(&mut self, at_ns: u64) {
        let (accel, threshold) = (self.sampler.accel, self.threshold_g());
        if self
            .motion
            .step(accel, &self.setup, &self.registers, threshold)
        {
            self.motions += 1;
            self.interrupt
                .raise(at_ns, registers::MOTION, &self.registers);
        }
    }

    fn output(&mut self, at_ns: u64) {
        let setup = self.setup;
        let standby = |axis: usize| setup.standby & (0x20 >> axis) != 0;
        for axis in 0..3 {
            if !standby(axis) {
                self.put(2 * axis, self.sampler.accel[axis] * setup.accel_counts);
            }
            if !standby(axis + 3) {
                self.put(8 + 2 * axis, self.sampler.gyro[axis] * setup.gyro_counts);
            }
        }
        if !setup.temperature_off {
            // RM-MPU-6000A register 65: T = code / 340 + 36.53 degrees.
            let celsius = self.sampler.temperature(at_ns);
            self.put(6, (celsius - 36.53) * 340.0);
        }
        self.samples += 1;
        self.interrupt
            .raise(at_ns, registers::DATA_READY, &self.registers);
    }

    fn put(&mut self, index: usize, counts: f64) {
        // A float-to-integer cast saturates: that is the converter's clipping.
        let bytes = (counts.round() as i16).to_be_bytes();
        self.sensors[index..index + 2].copy_from_slice(&bytes);
    }
}

impl Chip for Mpu6050 {
    fn advance(&mut self, now_ns: u64) {
        while let Some(tick) = self.sampler.tick(now_ns, &self.setup) {
            if tick.accel {
                self.detect_motion(tick.at_ns);
            }
            if tick.output {
                self.output(tick.at_ns);
            }
        }
        self.now_ns = self.now_ns.max(now_ns);
        self.interrupt.advance(self.now_ns);
    }

    fn next_event(&self) -> u64 {
        let enabled = |bit, every| match self.registers.has(registers::INT_ENABLE, bit) {
            true => self.sampler.next(every),
            false => u64::MAX,
        };
        enabled(registers::DATA_READY, self.setup.divider)
            .min(enabled(registers::MOTION, sampling::TICKS_PER_ACCEL))
            .min(self.interrupt.next_event())
    }

    fn interrupt(&self) -> bool {
        self.interrupt.level(&self.registers)
    }
}

impl I2cChip for Mpu6050 {
    fn start(&mut self, now_ns: u64, address: u8, read: bool) -> bool {
        self.advance(now_ns);
        if address != Self::ADDRESS {
            return false;
        }
        if !self.port.busy {
            self.held = self.sensors;
        }
        self.port.busy = true;
        self.port.pointer_follows = !read;
        true
    }

    fn write(&mut self, now_ns: u64, byte: u8) -> bool {
        self.advance(now_ns);
        if !self.port.busy {
            return false;
        }
        if std::mem::take(&mut self.port.pointer_follows) {
            self.port.pointer = byte & 0x7F;
        } else {
            self.store(self.port.pointer, byte);
            self.port.pointer = (self.port.pointer + 1) & 0x7F;
        }
        true
    }

    fn read(&mut self, now_ns: u64, _last: bool) -> u8 {
        self.advance(now_ns);
        if !self.port.busy {
            return 0xFF;
        }
        let value = self.load(self.port.pointer);
        self.port.pointer = (self.port.pointer + 1) & 0x7F;
        value
    }

    fn stop(&mut self, now_ns: u64) {
        self.advance(now_ns);
        self.port.busy = false;
    }
}
