//! Learning: labels from runs and shadow holds, refits, and what they change.

use super::{Autopilot, Call, Reason, Recorder};
use crate::airframe::MotorShares;
use crate::config::{
    ACCEL, CHIP_ACCEL, CHIP_MAG, FORGETTING, GYRO, LABELS_OF_EACH_CLASS, REFIT_INTERVAL,
    STABLE_CHANGE,
};
use crate::control::Setpoint;
use crate::reactive::{
    Exploration, Fit, Held, Labels, Logistic, Phase, Refit, RefitJob, Rule, ShadowHolds, Trigger,
};
use crate::sensors::Input;
use crate::settings::Settings;
use crate::telemetry::Event;
use crate::time::{Instant, seconds, span};

/// Everything one input learns and decides by.
#[derive(Clone, Debug)]
pub(super) struct Learner {
    pub(super) trigger: Trigger,
    labels: Labels,
    /// Its model may ask for a run.
    pub(super) triggers: bool,
    holds: ShadowHolds,
    refitted: Instant,
    /// Refits in a row that left the threshold where it was.
    stable: u8,
}

/// One learner per input.
#[derive(Clone, Debug)]
pub(super) struct Learners {
    gyro: Learner,
    accel: Learner,
    chip_accel: Learner,
    chip_mag: Learner,
    rule: Rule,
    setpoint: Setpoint,
}

impl Learner {
    fn new(input: &crate::config::SensorInput, settings: &Settings) -> Self {
        Self {
            trigger: Trigger::new(settings.reference, settings.p_run),
            labels: Labels::new(input),
            triggers: input.triggers,
            holds: ShadowHolds::new(input),
            refitted: Instant::from_ticks(0),
            stable: 0,
        }
    }

    /// Swaps a fit in; keeps count of how long the threshold has been stable.
    ///
    /// Where labels became too few to fit again, what they said while there were enough stays:
    /// a threshold that hides changes also starves its own labels.
    fn swap(&mut self, fit: Fit) {
        let starved = self.labels.of_rarer_class() < LABELS_OF_EACH_CLASS as f32;
        if fit == Fit::Unfit && starved && self.trigger.fit() != Fit::Unfit {
            return;
        }
        let before = self.trigger.model().map(|_| self.trigger.threshold());
        self.trigger.set_fit(fit);
        self.stable = match (before, self.trigger.model()) {
            (Some(threshold), Some(model)) if self.is_still_right(threshold, &model) => {
                self.stable.saturating_add(1)
            }
            _ => 0,
        };
    }

    /// True where a newer model sees an older threshold close to `P_run` too.
    fn is_still_right(&self, threshold: f32, newer: &Logistic) -> bool {
        (newer.probability(threshold) - self.trigger.p_run()).abs() <= STABLE_CHANGE
    }

    /// Stable and with labels of both classes, or known not to matter.
    fn is_settled(&self) -> bool {
        match self.trigger.fit() {
            _ if !self.triggers => true,
            Fit::Irrelevant => true,
            Fit::Unfit => false,
            Fit::Model(_) => {
                self.stable >= 2 && self.labels.of_rarer_class() >= LABELS_OF_EACH_CLASS as f32
            }
        }
    }
}

impl Learners {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            gyro: Learner::new(&GYRO, settings),
            accel: Learner::new(&ACCEL, settings),
            chip_accel: Learner::new(&CHIP_ACCEL, settings),
            chip_mag: Learner::new(&CHIP_MAG, settings),
            rule: Rule {
                reference: settings.reference,
                quantum: settings.quantum,
                failsafe: settings.failsafe,
            },
            setpoint: Setpoint::default(),
        }
    }

    pub(super) fn of(&mut self, input: Input) -> &mut Learner {
        match input {
            Input::Gyro => &mut self.gyro,
            Input::Accel => &mut self.accel,
            Input::ChipAccel => &mut self.chip_accel,
            Input::ChipMag => &mut self.chip_mag,
        }
    }

    pub(super) fn look(&self, input: Input) -> &Learner {
        match input {
            Input::Gyro => &self.gyro,
            Input::Accel => &self.accel,
            Input::ChipAccel => &self.chip_accel,
            Input::ChipMag => &self.chip_mag,
        }
    }

    /// Shows the newest sample of an input, with the command in force, to its shadow holds.
    pub(super) fn hold(&mut self, now: Instant, input: Input, command: &MotorShares) {
        let rule = self.rule;
        let learner = self.of(input);
        if let Some(sample) = learner.trigger.newest() {
            let newest = Held {
                sample,
                command: *command,
            };
            learner.holds.take(now, &newest, &rule, &mut learner.labels);
        }
    }

    pub(super) fn restart_holds(&mut self) {
        for input in Input::ALL {
            self.of(input).holds.restart();
        }
    }

    /// After a run: its samples and its setpoint are the new references.
    pub(super) fn on_run(&mut self, setpoint: &Setpoint) {
        for input in Input::ALL {
            self.of(input).trigger.on_run();
        }
        self.setpoint = *setpoint;
    }

    pub(super) fn setpoint_of_last_run(&self) -> &Setpoint {
        &self.setpoint
    }
}

impl<R: Recorder> Autopilot<R> {
    /// What a run taught: `changed` says whether it moved the command by a quantum.
    pub(super) fn learn(&mut self, now: Instant, reason: Reason, asked: u8, changed: bool) {
        match reason {
            Reason::WarmUp | Reason::Fallback => {
                self.learners.hold(now, Input::Gyro, self.gate.applied());
                self.learners.hold(now, Input::Accel, self.gate.applied());
            }
            // Runs that several inputs asked for teach nothing: whose change was it?
            Reason::Trigger if asked.is_power_of_two() => {
                if let Some(input) = Input::from_number(asked.trailing_zeros() as u8) {
                    self.label(input, changed, 1.0);
                }
            }
            Reason::Failsafe if self.supervisor.phase() == Phase::Reactive => {
                self.label_all(changed, 1.0);
            }
            Reason::Exploration => self.label_all(changed, Exploration::WEIGHT),
            Reason::Trigger
            | Reason::Failsafe
            | Reason::Setpoint
            | Reason::Periodic
            | Reason::Ground => {}
        }
    }

    fn label_all(&mut self, changed: bool, weight: f32) {
        for input in Input::ALL {
            self.label(input, changed, weight);
        }
    }

    fn label(&mut self, input: Input, changed: bool, weight: f32) {
        let learner = self.learners.of(input);
        if let Some(x) = learner.trigger.change() {
            learner.labels.add(x, changed, weight);
        }
    }

    /// The labels of an input whose refit is due, copied: to be fitted in idle, without a lock.
    #[must_use]
    pub fn refit_due(&self, now: Instant) -> Option<RefitJob> {
        let learns = self.supervisor.is_learning() || self.supervisor.phase() == Phase::Reactive;
        if !learns {
            return None;
        }
        Input::ALL.into_iter().find_map(|input| {
            let learner = self.learners.look(input);
            (span(learner.refitted, now) >= REFIT_INTERVAL).then_some(RefitJob {
                input,
                labels: learner.labels,
            })
        })
    }

    /// Swaps a fit in, forgets a little, and judges whether the phase ends.
    pub fn on_refit(&mut self, now: Instant, refit: Refit) {
        self.note(now, Call::Refit(refit));
        let learner = self.learners.of(refit.input);
        learner.refitted = now;
        learner.swap(refit.fit);
        let event = Event::Refit {
            input: refit.input,
            fit: refit.fit,
            threshold: learner.trigger.threshold(),
            labels: learner.labels.total(),
        };
        learner
            .labels
            .fade(1.0 - seconds(REFIT_INTERVAL) / seconds(FORGETTING));
        self.events.push(event);
        let learned = Input::ALL
            .into_iter()
            .all(|input| self.learners.look(input).is_settled() || !self.chips.delivers(input));
        let fitted = self.learners.gyro.trigger.model().is_some();
        if let Some(event) = self.supervisor.judge(learned, fitted, now) {
            self.move_phase(event);
        }
        self.want_thresholds();
    }

    /// The change of an input above which it calls for a run, in its SI unit.
    #[must_use]
    pub fn threshold(&self, input: Input) -> f32 {
        self.learners.look(input).trigger.threshold()
    }

    /// What the labels say of an input.
    #[must_use]
    pub fn fit(&self, input: Input) -> Fit {
        self.learners.look(input).trigger.fit()
    }
}
