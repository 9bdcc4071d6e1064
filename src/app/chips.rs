//! What the chips that compare shall do, and what they were seen to do.
//!
//! While models are learned every sample is wanted. Else the chip compares and interrupts only past
//! its threshold, the highest where nothing is asked of it. Thresholds are ordered in SI units; the
//! chip's driver rounds them, and its answer says which thresholds the setting serves. Orders are
//! given one at a time per chip, are read back by the board, and are repeated while they fail.
//!
//! After a run the reference is old. An open chip is re-armed, no more often than it samples; one at
//! its highest threshold compares with whatever it has, and is read instead, seldom.

use super::door::{ChipAction, ChipOrder, ChipSetting, OrderError};
use crate::config::of_input;
use crate::math::Vec3;
use crate::sensors::{ChipSample, Input, Inputs};
use crate::settings::Settings;
use crate::time::{Duration, Instant, micros, span};

/// A sample that repeats this often, bit by bit, comes from a chip that is stuck.
const STUCK: u8 = 50;

/// After this long without an answer an order counts as lost, and after a failure is given again.
const PATIENCE: Duration = micros(100_000);

/// How often the estimator wants the magnetic field.
const FIELD_INTERVAL: Duration = micros(20_000);

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
struct Chip {
    wanted: Mode,
    /// What was ordered last, and the chip's answer; `None` where it is not known.
    programmed: Option<(Mode, ChipSetting)>,
    /// When the order under way was given, or the last one failed: nothing is ordered for a while.
    quiet_since: Option<Instant>,
    failures: u32,
    /// The reference is older than the last run.
    ran: bool,
    /// When the reference was taken.
    referred: Instant,
    seen: Instant,
    /// When its threshold was last read back.
    checked: Instant,
    silence_noticed: bool,
    sample: Vec3,
    repeats: u8,
}

impl Default for Chip {
    fn default() -> Self {
        Self {
            wanted: Mode::Threshold(f32::MAX),
            programmed: None,
            quiet_since: None,
            failures: 0,
            ran: false,
            referred: Instant::from_ticks(0),
            seen: Instant::from_ticks(0),
            checked: Instant::from_ticks(0),
            silence_noticed: false,
            sample: Vec3::ZERO,
            repeats: 0,
        }
    }
}

impl Chip {
    /// Takes a sample; true where it shows for the first time that the chip is stuck.
    fn on_sample(&mut self, at: Instant, sample: Vec3) -> bool {
        self.seen = at;
        self.silence_noticed = false;
        self.repeats = if sample == self.sample {
            self.repeats.saturating_add(1)
        } else {
            0
        };
        self.sample = sample;
        self.repeats == STUCK
    }

    /// True where the samples repeat bit by bit: no sensor is that still.
    fn is_stuck(&self) -> bool {
        self.repeats >= STUCK
    }

    /// True once per silence that is longer than `longest`.
    fn notice_silence(&mut self, now: Instant, longest: Duration) -> bool {
        let noticed = !self.silence_noticed && span(self.seen, now) > longest;
        self.silence_noticed |= noticed;
        noticed
    }

    /// False where it fell silent, or repeats itself: its model is not waited for.
    fn delivers(&self) -> bool {
        !self.silence_noticed && !self.is_stuck()
    }

    /// What it shall do next.
    fn need(&mut self, now: Instant, pace: &Pace) -> Option<ChipAction> {
        if self.quiet_since.is_some_and(|at| span(at, now) < PATIENCE) {
            return None;
        }
        let (compares, closed) = self.comparison();
        let age = span(self.referred, now);
        let interval = if closed { pace.reading } else { pace.period };
        let refers = compares && self.ran && age >= interval;
        // A heartbeat is a sample to learn from: behind a reference that is neither the same
        // sample nor about to be replaced.
        let tells = age >= pace.period && !(refers && age >= pace.failsafe);
        let need = if !self.is_as_wanted() {
            self.mode().action()
        } else if span(self.heard(), now) >= pace.failsafe && tells {
            ChipAction::Heartbeat
        } else if refers {
            // A run that comes while this is under way asks for the next.
            self.ran = false;
            if closed {
                ChipAction::Read
            } else {
                ChipAction::Rearm
            }
        } else {
            return None;
        };
        self.quiet_since = Some(now);
        Some(need)
    }

    /// A chip that compares may rightly be silent, and is asked whether it still does.
    fn heard(&self) -> Instant {
        if self.comparison().0 {
            self.checked
        } else {
            self.seen
        }
    }

    /// Whether it compares, and with its highest threshold.
    fn comparison(&self) -> (bool, bool) {
        self.programmed.map_or((false, false), |(_, setting)| {
            (setting.compares(), setting.is_closed())
        })
    }

    /// What it shall interrupt for. One that delivers nothing shall tell its next sample.
    fn mode(&self) -> Mode {
        if self.delivers() {
            self.wanted
        } else {
            Mode::DataReady
        }
    }

    /// An order that was carried out is not given again, whatever the chip made of it.
    fn is_as_wanted(&self) -> bool {
        let mode = self.mode();
        self.programmed
            .is_some_and(|(ordered, setting)| ordered == mode || mode.is_served_by(setting))
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
            ChipAction::Rearm | ChipAction::Read => {
                self.referred = at;
                return;
            }
            ChipAction::Heartbeat => {
                self.checked = at;
                return;
            }
        };
        self.programmed = Some((ordered, setting));
        self.checked = at;
        self.ran = setting.compares();
    }
}

/// How often a chip is asked for what.
struct Pace {
    /// The time between two of its samples: re-arming more often would change nothing.
    period: Duration,
    /// The time between two readings of a closed chip.
    reading: Duration,
    /// The longest time between two checks.
    failsafe: Duration,
}

/// All of them, in the order of [`Input::OF_CHIPS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chips {
    chips: [Chip; Input::OF_CHIPS.len()],
    failsafe: Duration,
    /// When an order is due that no run, interrupt or timer leads to.
    due: Instant,
}

impl Chips {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            chips: Default::default(),
            failsafe: settings.failsafe,
            due: Instant::from_ticks(0),
        }
    }

    fn each(&mut self) -> impl Iterator<Item = (Input, &mut Chip)> {
        Input::OF_CHIPS.into_iter().zip(&mut self.chips)
    }

    fn of(&mut self, input: Input) -> Option<&mut Chip> {
        let found = self.each().find(|(of, _)| *of == input);
        found.map(|(_, chip)| chip)
    }

    /// Takes a sample; true where it shows for the first time that its chip is stuck.
    pub(super) fn on_sample(&mut self, at: Instant, sample: &ChipSample) -> bool {
        let chip = self.of(sample.input);
        chip.is_some_and(|chip| chip.on_sample(at, sample.axes))
    }

    /// Inputs whose chip answers nothing for two failsafe periods, each once per silence.
    pub(super) fn notice_silence(&mut self, now: Instant) -> Inputs {
        let longest = self.failsafe * 2;
        let silent = self
            .each()
            .filter_map(|(input, chip)| chip.notice_silence(now, longest).then_some(input));
        silent.collect()
    }

    /// Inputs that deliver: all but those whose chip fell silent, or repeats itself.
    pub(super) fn delivering(&self) -> Inputs {
        let chips = Input::OF_CHIPS.into_iter().zip(&self.chips);
        let lost = chips.filter(|(_, chip)| !chip.delivers());
        lost.fold(Inputs::ALL, |all, (input, _)| all.without(input))
    }

    /// After a run the references are old of chips that `matter`, and so is the field.
    pub(super) fn on_run(&mut self, matter: bool) {
        for (input, chip) in self.each() {
            chip.ran |= matter || input == Input::ChipMag;
        }
    }

    /// A new phase: what is under way is not waited for.
    pub(super) fn retry(&mut self) {
        for chip in &mut self.chips {
            chip.quiet_since = None;
        }
    }

    /// The thresholds (in the inputs' units) to compare with, `None` where every sample is wanted.
    pub(super) fn want(&mut self, threshold: impl Fn(Input) -> Option<f32>) {
        for (input, chip) in self.each() {
            chip.wanted = threshold(input).map_or(Mode::DataReady, Mode::Threshold);
        }
    }

    /// True where the owner of the chips is to be raised: a heartbeat is due.
    pub(super) fn are_due(&self, now: Instant) -> bool {
        now >= self.due
    }

    /// The next order, where one is due.
    pub(super) fn next_order(&mut self, now: Instant) -> Option<ChipOrder> {
        let failsafe = self.failsafe;
        let order = self.each().find_map(|(input, chip)| {
            let pace = Pace {
                period: of_input(input).period,
                reading: if input == Input::ChipMag {
                    FIELD_INTERVAL
                } else {
                    failsafe
                },
                failsafe,
            };
            let action = chip.need(now, &pace)?;
            Some(ChipOrder { input, action })
        });
        if order.is_some() {
            return order;
        }
        let heartbeats = self.each().map(|(input, chip)| {
            let told = chip.referred + of_input(input).period;
            let heard = chip.heard() + failsafe;
            chip.quiet_since.map_or(told.max(heard), |at| at + PATIENCE)
        });
        self.due = heartbeats.min().unwrap_or(now);
        None
    }

    /// An order was carried out, or failed; how often that chip failed so far.
    pub(super) fn on_order_done(
        &mut self,
        at: Instant,
        order: &ChipOrder,
        result: Result<ChipSetting, OrderError>,
    ) -> Option<u32> {
        let chip = self.of(order.input)?;
        chip.on_done(at, order.action, result);
        Some(chip.failures)
    }
}
