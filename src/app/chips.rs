//! What the chips that compare shall do, and what they were seen to do.
//!
//! In the warm-up every sample is wanted. In reactive control, with a model, the chip compares and
//! interrupts only past its threshold. Thresholds are ordered in SI units; the chip's driver
//! rounds them, and its answer says which thresholds the setting serves. Orders are given one at
//! a time per chip, are read back by the board, and are repeated while they fail.

use super::{
    Autopilot, Call, ChipAction, ChipOrder, ChipSetting, Event, Fault, OrderError, Recorder,
};
use crate::config::{CHIP_ACCEL, CHIP_MAG};
use crate::graph::ControlLogic;
use crate::math::Vec3;
use crate::sensors::{Input, Inputs};
use crate::time::{Duration, Instant, micros, span};

/// A sample that repeats this often, bit by bit, comes from a chip that is stuck.
const STUCK: u8 = 50;

/// After this long without an answer an order counts as lost, and after a failure is given again.
const PATIENCE: Duration = micros(100_000);

/// What a chip shall interrupt for: every sample, or a change past a threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    DataReady,
    Threshold(f32),
}

impl Mode {
    fn action(self) -> ChipAction {
        match self {
            Self::DataReady => ChipAction::DataReady,
            Self::Threshold(change) => ChipAction::Threshold(change),
        }
    }

    /// True where a chip that is set like this does what is wanted.
    fn is_served_by(self, setting: ChipSetting) -> bool {
        match self {
            Self::DataReady => !setting.compares(),
            Self::Threshold(change) => setting.serves(change),
        }
    }
}

/// One chip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chip {
    wanted: Mode,
    /// What was ordered last, and the chip's answer; `None` where it is not known.
    programmed: Option<(Mode, ChipSetting)>,
    /// When the order under way was given, or the last one failed: nothing is ordered for a while.
    quiet_since: Option<Instant>,
    failures: u32,
    rearm: bool,
    rearmed: Instant,
    seen: Instant,
    /// When its threshold was last read back.
    checked: Instant,
    silence_told: bool,
    sample: Vec3,
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
            sample: Vec3::ZERO,
            repeats: 0,
        }
    }
}

impl Chip {
    /// Takes a sample; true where it shows for the first time that the chip is stuck.
    pub(super) fn on_sample(&mut self, at: Instant, sample: Vec3) -> bool {
        self.seen = at;
        self.silence_told = false;
        self.repeats = if sample == self.sample {
            self.repeats.saturating_add(1)
        } else {
            0
        };
        self.sample = sample;
        self.repeats == STUCK
    }

    /// True where the samples repeat bit by bit: no sensor is that still.
    pub(super) fn is_stuck(&self) -> bool {
        self.repeats >= STUCK
    }

    /// What it shall do next. Re-arming more often than it samples would change nothing.
    fn need(&mut self, now: Instant, period: Duration, failsafe: Duration) -> Option<ChipAction> {
        if self.quiet_since.is_some_and(|at| span(at, now) < PATIENCE) {
            return None;
        }
        let compares = self.compares();
        // A chip that compares may rightly be silent, and is asked whether it still does.
        let heard = if compares { self.checked } else { self.seen };
        let need = if !self.is_as_wanted() {
            self.wanted.action()
        } else if span(heard, now) >= failsafe {
            ChipAction::Heartbeat
        } else if self.rearm && compares && span(self.rearmed, now) >= period {
            // A run that comes while this is under way asks for the next.
            self.rearm = false;
            ChipAction::Rearm
        } else {
            return None;
        };
        self.quiet_since = Some(now);
        Some(need)
    }

    fn compares(&self) -> bool {
        self.programmed
            .is_some_and(|(_, setting)| setting.compares())
    }

    /// An order that was carried out is not given again, whatever the chip made of it.
    fn is_as_wanted(&self) -> bool {
        self.programmed.is_some_and(|(ordered, setting)| {
            ordered == self.wanted || self.wanted.is_served_by(setting)
        })
    }

    fn on_done(
        &mut self,
        at: Instant,
        action: ChipAction,
        result: Result<ChipSetting, OrderError>,
    ) {
        // A chip that lost its registers, in a reset, is programmed anew at once; patience is for
        // one that goes on failing.
        let worked = self.programmed.is_some();
        self.quiet_since = (result.is_err() && !worked).then_some(at);
        let Ok(setting) = result else {
            // Whatever failed, what the chip does now is not known: program it anew.
            self.programmed = None;
            self.failures = self.failures.saturating_add(1);
            return;
        };
        self.seen = at;
        let ordered = match action {
            ChipAction::DataReady => Mode::DataReady,
            ChipAction::Threshold(change) => Mode::Threshold(change),
            ChipAction::Rearm => {
                self.rearmed = at;
                return;
            }
            ChipAction::Heartbeat => {
                self.checked = at;
                return;
            }
        };
        self.programmed = Some((ordered, setting));
        self.checked = at;
        self.rearm = setting.compares();
    }
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
            .collect()
    }

    fn of_mut(&mut self, input: Input) -> Option<&mut Chip> {
        match input {
            Input::Gyro | Input::Accel | Input::Turned | Input::Command => None,
            Input::ChipAccel => Some(&mut self.accel),
            Input::ChipMag => Some(&mut self.mag),
        }
    }

    /// A new phase: what is under way is not waited for.
    pub(super) fn retry(&mut self) {
        self.accel.quiet_since = None;
        self.mag.quiet_since = None;
    }
}

impl<R: Recorder, L: ControlLogic> Autopilot<R, L> {
    /// The next order for a chip, where one is due; the board reports when it is done.
    pub fn next_order(&mut self) -> Option<ChipOrder> {
        let (now, failsafe) = (self.record.clock(), self.reactive.failsafe());
        let chips = [
            (Input::ChipAccel, &mut self.chips.accel, CHIP_ACCEL.period),
            (Input::ChipMag, &mut self.chips.mag, CHIP_MAG.period),
        ];
        chips.into_iter().find_map(|(input, chip, period)| {
            let action = chip.need(now, period, failsafe)?;
            Some(ChipOrder { input, action })
        })
    }

    /// The board carried an order out, or could not.
    pub fn on_order_done(
        &mut self,
        at: Instant,
        order: ChipOrder,
        result: Result<ChipSetting, OrderError>,
    ) {
        self.record.call(at, Call::OrderDone(order, result));
        let ChipOrder { input, action } = order;
        let Some(chip) = self.chips.of_mut(input) else {
            return;
        };
        chip.on_done(at, action, result);
        match (action, result) {
            (ChipAction::DataReady | ChipAction::Threshold(_), Ok(setting)) => {
                self.record.event(Event::Programmed(input, setting));
            }
            (_, Ok(_)) => {}
            (_, Err(error)) => {
                if chip.failures.is_power_of_two() {
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

    /// The thresholds of the models, for the chips to compare with.
    pub(super) fn want_thresholds(&mut self) {
        self.chips.accel.wanted = self.wanted(Input::ChipAccel);
        self.chips.mag.wanted = self.wanted(Input::ChipMag);
    }

    /// A chip that delivers nothing is not programmed to compare.
    fn wanted(&self, input: Input) -> Mode {
        self.reactive
            .threshold_for_chip(input)
            .filter(|_| self.chips.delivers(input))
            .map_or(Mode::DataReady, Mode::Threshold)
    }
}
