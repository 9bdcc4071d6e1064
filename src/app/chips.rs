//! What the LSM303AGR's two chips shall do, and what they were seen to do.
//!
//! In the warm-up every sample is wanted; in reactive control, with a model, the chip compares
//! and only tells of a change past its threshold. Orders go out one at a time per chip, are
//! read back by the board, and are repeated while they fail.

use super::{Autopilot, Call, ChipOrder, Event, Fault, OrderError, Recorder};
use crate::config::{CHIP_ACCEL, CHIP_ACCEL_RATE, CHIP_MAG};
use crate::graph::ControlLogic;
use crate::sensors::{GRAVITY, Input, Inputs, MAG_SCALE};
use crate::time::{Duration, Instant, micros, seconds, span};

/// m/s2 per code of the accelerometer's threshold at +-2 g: 16 mg (LSM303AGR, INT1_THS_A).
const ACCEL_CODE: f32 = 0.016 * GRAVITY;

/// The largest threshold code of the accelerometer: 7 bits.
const LARGEST_ACCEL_CODE: f32 = 127.0;

/// Time constant (s) of the accelerometer's high-pass at its lowest corner, rate / 400.
const HIGH_PASS_TIME: f32 = 400.0 / (core::f32::consts::TAU * CHIP_ACCEL_RATE as f32);

/// A sample that repeats this often, bit by bit, comes from a chip that is stuck.
const STUCK: u8 = 50;

/// After this long without an answer an order counts as lost, and after a failure is given again.
const PATIENCE: Duration = micros(100_000);

/// What a chip interrupts for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    DataReady,
    Threshold(u16),
}

/// One of the two chips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chip {
    wanted: Mode,
    programmed: Option<Mode>,
    /// When the order under way was given, or the last one failed: nothing is ordered for a while.
    quiet_since: Option<Instant>,
    failures: u32,
    rearm: bool,
    rearmed: Instant,
    seen: Instant,
    /// When its threshold was last read back.
    checked: Instant,
    silence_told: bool,
    counts: [i16; 3],
    repeats: u8,
}

/// Both.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(super) struct Chips {
    pub(super) accel: Chip,
    pub(super) mag: Chip,
}

impl Default for Chip {
    fn default() -> Self {
        Self {
            wanted: Mode::DataReady,
            programmed: None,
            quiet_since: None,
            failures: 0,
            rearm: false,
            rearmed: Instant::from_ticks(0),
            seen: Instant::from_ticks(0),
            checked: Instant::from_ticks(0),
            silence_told: false,
            counts: [0; 3],
            repeats: 0,
        }
    }
}

/// What one chip needs next.
enum Need {
    Program(Mode),
    Rearm,
    Heartbeat,
}

impl Chip {
    /// Takes a sample; true where it shows for the first time that the chip is stuck.
    pub(super) fn on_sample(&mut self, at: Instant, counts: [i16; 3]) -> bool {
        self.seen = at;
        self.silence_told = false;
        self.repeats = if counts == self.counts {
            self.repeats.saturating_add(1)
        } else {
            0
        };
        self.counts = counts;
        self.repeats == STUCK
    }

    /// True where the samples repeat bit by bit: no sensor is that still.
    pub(super) fn is_stuck(&self) -> bool {
        self.repeats >= STUCK
    }

    /// Re-arming more often than the chip samples would change nothing.
    fn need(&mut self, now: Instant, period: Duration, failsafe: Duration) -> Option<Need> {
        if self.quiet_since.is_some_and(|at| span(at, now) < PATIENCE) {
            return None;
        }
        let compares = matches!(self.wanted, Mode::Threshold(_));
        // A chip that compares may rightly be silent, and is asked whether it still does.
        let heard = if compares { self.checked } else { self.seen };
        let need = if self.programmed != Some(self.wanted) {
            Need::Program(self.wanted)
        } else if span(heard, now) >= failsafe {
            Need::Heartbeat
        } else if self.rearm && compares && span(self.rearmed, now) >= period {
            // A run that comes while this is under way asks for the next.
            self.rearm = false;
            Need::Rearm
        } else {
            return None;
        };
        self.quiet_since = Some(now);
        Some(need)
    }

    fn on_done(&mut self, at: Instant, order: Done, result: Result<(), OrderError>) {
        // A chip that lost its registers, in a reset, is programmed anew at once; patience is for
        // one that goes on failing.
        let worked = self.programmed.is_some();
        self.quiet_since = (result.is_err() && !worked).then_some(at);
        if result.is_ok() {
            self.seen = at;
        }
        match (order, result) {
            (Done::Programmed(mode), Ok(())) => {
                self.programmed = Some(mode);
                self.checked = at;
                self.rearm = matches!(mode, Mode::Threshold(_));
            }
            (Done::Rearmed, Ok(())) => self.rearmed = at,
            (Done::HeartbeatRead, Ok(())) => self.checked = at,
            // Whatever failed, what the chip does now is not known: program it anew.
            (_, Err(_)) => {
                self.programmed = None;
                self.failures = self.failures.saturating_add(1);
            }
        }
    }
}

/// The kind of order that was carried out.
enum Done {
    Programmed(Mode),
    Rearmed,
    HeartbeatRead,
}

impl Chips {
    /// After a run the chips' references are old.
    pub(super) fn on_run(&mut self) {
        self.accel.rearm = true;
        self.mag.rearm = true;
    }

    /// False for a chip that fell silent, or repeats itself: its model is not waited for.
    pub(super) fn delivers(&self, input: Input) -> bool {
        let chip = match input {
            Input::Gyro | Input::Accel | Input::Turned | Input::Command => return true,
            Input::ChipAccel => &self.accel,
            Input::ChipMag => &self.mag,
        };
        !chip.silence_told && !chip.is_stuck()
    }

    /// The inputs that deliver.
    pub(super) fn delivering(&self) -> Inputs {
        Input::ALL
            .into_iter()
            .filter(|input| self.delivers(*input))
            .fold(Inputs::NONE, Inputs::with)
    }

    /// A new phase: what is under way is not waited for.
    pub(super) fn retry(&mut self) {
        self.accel.quiet_since = None;
        self.mag.quiet_since = None;
    }
}

impl<R: Recorder, L: ControlLogic> Autopilot<R, L> {
    /// The next order for the LSM303AGR, where one is due; the board reports when it is done.
    pub fn next_order(&mut self) -> Option<ChipOrder> {
        let (now, failsafe) = (self.record.clock(), self.reactive.failsafe());
        if let Some(need) = self.chips.accel.need(now, CHIP_ACCEL.period, failsafe) {
            return Some(match need {
                Need::Program(Mode::DataReady) => ChipOrder::AccelDataReady,
                Need::Program(Mode::Threshold(code)) => ChipOrder::AccelThreshold(code as u8),
                Need::Rearm => ChipOrder::AccelRearm,
                Need::Heartbeat => ChipOrder::AccelHeartbeat,
            });
        }
        let need = self.chips.mag.need(now, CHIP_MAG.period, failsafe)?;
        Some(match need {
            Need::Program(Mode::DataReady) => ChipOrder::MagDataReady,
            Need::Program(Mode::Threshold(code)) => ChipOrder::MagThreshold(code),
            Need::Rearm => ChipOrder::MagRearm,
            Need::Heartbeat => ChipOrder::MagHeartbeat,
        })
    }

    /// The board carried an order out, or could not.
    pub fn on_order_done(&mut self, at: Instant, order: ChipOrder, result: Result<(), OrderError>) {
        self.record.call(at, Call::OrderDone(order, result));
        let accel = &mut self.chips.accel;
        let mag = &mut self.chips.mag;
        let (chip, done) = match order {
            ChipOrder::AccelDataReady => (accel, Done::Programmed(Mode::DataReady)),
            ChipOrder::AccelThreshold(code) => {
                (accel, Done::Programmed(Mode::Threshold(u16::from(code))))
            }
            ChipOrder::AccelRearm => (accel, Done::Rearmed),
            ChipOrder::AccelHeartbeat => (accel, Done::HeartbeatRead),
            ChipOrder::MagDataReady => (mag, Done::Programmed(Mode::DataReady)),
            ChipOrder::MagThreshold(code) => (mag, Done::Programmed(Mode::Threshold(code))),
            ChipOrder::MagRearm => (mag, Done::Rearmed),
            ChipOrder::MagHeartbeat => (mag, Done::HeartbeatRead),
        };
        let programs = matches!(done, Done::Programmed(_));
        chip.on_done(at, done, result);
        let failures = chip.failures;
        match result {
            Ok(()) if programs => self.record.event(Event::Programmed(order)),
            Ok(()) => {}
            Err(error) => {
                if failures.is_power_of_two() {
                    self.record.event(Event::OrderFailed(order, error));
                }
                self.record.fault(Fault::ChipBus);
            }
        }
    }

    /// A chip that answers nothing for two failsafe periods is told of, once per silence.
    pub(super) fn check_chips(&mut self, now: Instant) {
        let longest = self.reactive.failsafe() * 2;
        let silent = |chip: &mut Chip| {
            let tell = !chip.silence_told && span(chip.seen, now) > longest;
            chip.silence_told |= tell;
            tell
        };
        let accel = silent(&mut self.chips.accel);
        let mag = silent(&mut self.chips.mag);
        if accel {
            self.record.fault(Fault::AccelSilent);
            self.on_chip_lost(Input::ChipAccel);
        }
        if mag {
            self.record.fault(Fault::MagSilent);
            self.on_chip_lost(Input::ChipMag);
        }
    }

    /// Rounds the thresholds of the models down to what the chips can hold.
    pub(super) fn want_thresholds(&mut self) {
        self.chips.accel.wanted = self.wanted(Input::ChipAccel, |x| self.accel_code(x));
        self.chips.mag.wanted = self.wanted(Input::ChipMag, mag_code);
    }

    /// A chip that delivers nothing is not programmed to compare.
    fn wanted(&self, input: Input, code: impl Fn(f32) -> Option<u16>) -> Mode {
        self.reactive
            .threshold_for_chip(input)
            .filter(|_| self.chips.delivers(input))
            .and_then(code)
            .map_or(Mode::DataReady, Mode::Threshold)
    }

    /// The accelerometer's code; `None` where the change is finer than one code.
    ///
    /// Its high-pass forgets: where the failsafe lets it forget more than a fifth of its time
    /// constant, the code is lowered by the worst decay.
    fn accel_code(&self, x: f32) -> Option<u16> {
        let age = seconds(self.reactive.failsafe()) / HIGH_PASS_TIME;
        let kept = if age > 0.2 { libm::expf(-age) } else { 1.0 };
        let code = libm::floorf(x * kept / ACCEL_CODE).min(LARGEST_ACCEL_CODE);
        (code >= 1.0).then_some(code as u16)
    }
}

/// The magnetometer's code, 1.5 mG each; `None` where the change is finer than one.
fn mag_code(x: f32) -> Option<u16> {
    let code = libm::floorf(x / MAG_SCALE).min(32_767.0);
    (code >= 1.0).then_some(code as u16)
}
