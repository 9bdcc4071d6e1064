//! The MPU6050's motion detector: high-pass, threshold, counter.
//!
//! PS-MPU-6000A (rev. 3.1, section 8.3): a high-passed sample of any axis whose
//! magnitude exceeds MOT_THR makes a 1 kHz counter rise, any other makes it
//! fall, and the interrupt comes when it reaches MOT_DUR. The counter then
//! stays there; the next interrupt needs it to have fallen below first.

use super::registers::{self, Registers, Setup};
use crate::filter::HighPass;

/// Corner in Hz by ACCEL_HPF 1..=4, RM-MPU-6000A register 28.
const CORNERS: [f64; 4] = [5.0, 2.5, 1.25, 0.63];
/// ACCEL_HPF: the present sample is held as the zero.
const HOLD: u8 = 7;
/// Milliseconds from wake-up to valid detection; ACCEL_ON_DELAY adds to it.
const ACCEL_START_MS: u32 = 4;

/// State of the detector.
#[derive(Clone, Copy, Debug, Default)]
pub struct MotionDetector {
    high_pass: HighPass,
    mode: u8,
    counter: u8,
    reached: bool,
    awake_ms: u32,
    status: u8,
}

impl MotionDetector {
    /// Forgets counter, filter and status, as after a reset or in sleep.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// One 1 kHz accelerometer value in g; whether motion is newly detected.
    ///
    /// `threshold_g` is MOT_THR times the weight of one count.
    pub fn step(
        &mut self,
        accel: [f64; 3],
        setup: &Setup,
        registers: &Registers,
        threshold_g: f64,
    ) -> bool {
        let passed = self.filter(accel, setup.high_pass);
        self.awake_ms = self.awake_ms.saturating_add(1);
        let control = registers.get(registers::MOT_DETECT_CTRL);
        if self.awake_ms <= ACCEL_START_MS + u32::from(control >> 4 & 0x03) {
            return false;
        }
        if passed.iter().any(|axis| axis.abs() > threshold_g) {
            self.counter = self.counter.saturating_add(1);
        } else {
            self.counter = match control & 0x03 {
                0 => 0,
                step => self.counter.saturating_sub(1 << (step - 1)),
            };
        }
        let duration = registers.get(registers::MOT_DUR).max(1);
        let was_reached = std::mem::replace(&mut self.reached, self.counter >= duration);
        self.counter = self.counter.min(duration);
        if !self.reached || was_reached {
            return false;
        }
        self.status |= direction(passed, threshold_g);
        true
    }

    fn filter(&mut self, accel: [f64; 3], mode: u8) -> [f64; 3] {
        if std::mem::replace(&mut self.mode, mode) != mode && mode == HOLD {
            self.high_pass.snap(accel);
        }
        match mode {
            1..=4 => {
                let corner = CORNERS[usize::from(mode) - 1];
                self.high_pass.step(accel, HighPass::blend(corner, 1000.0))
            }
            HOLD => self.high_pass.step(accel, 0.0),
            // Reset: the output is zero "within a few samples"; here at once.
            _ => {
                self.high_pass.snap(accel);
                [0.0; 3]
            }
        }
    }

    /// MOT_DETECT_STATUS; reading it clears it.
    pub fn read_status(&mut self) -> u8 {
        std::mem::take(&mut self.status)
    }

    /// MOT_DETECT_STATUS without clearing it.
    pub fn status(&self) -> u8 {
        self.status
    }
}

/// Bits X-, X+, Y-, Y+, Z-, Z+ from bit 7 down, of the axes over threshold.
fn direction(passed: [f64; 3], threshold_g: f64) -> u8 {
    let mut bits = 0;
    for (axis, value) in passed.into_iter().enumerate() {
        if value < -threshold_g {
            bits |= 0x80 >> (2 * axis);
        } else if value > threshold_g {
            bits |= 0x40 >> (2 * axis);
        }
    }
    bits
}
