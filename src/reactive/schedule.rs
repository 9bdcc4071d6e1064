//! When control runs: hyperperiods, what was asked for, the failsafe.

use super::hyperperiod::Hyperperiod;
use super::{Exploration, Phase};
use crate::config::HYPERPERIOD;
use crate::numbered::numbered;
use crate::sensors::{Input, Inputs};
use crate::settings::{Feedback, Policy, Settings};
use crate::time::{Duration, Instant, span};

/// What the board does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Next {
    /// Nothing: the applied commands are still good.
    Wait,
    /// Raise the hyperperiod task now.
    Hyperperiod,
    /// Raise it at this instant at the latest, should no gating sample end the hyperperiod.
    HyperperiodAt(Instant),
}

numbered! {
    /// Why control ran.
    Reason {
        /// Time-triggered, to learn.
        WarmUp,
        /// Some input's change called for it.
        Trigger,
        /// No run for `T_failsafe`.
        Failsafe,
        /// The setpoint moved past its quantum.
        Setpoint,
        /// Rare and random, to label what the thresholds hide.
        Exploration,
        /// Time-triggered, by policy.
        Periodic,
        /// Time-triggered, because reactive control was left.
        Fallback,
        /// Time-triggered on the ground.
        Ground,
    }
}

/// Bookkeeping of runs.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    failsafe: Duration,
    /// Time between runs where they are time-triggered.
    period: Duration,
    last_run: Instant,
    next_periodic: Instant,
    /// Inputs that asked for a run in this hyperperiod.
    asked: Inputs,
    setpoint_asked: bool,
    pending: Option<Reason>,
    pending_since: Instant,
    hyperperiod: Hyperperiod,
    /// Where the settings let chance ask for runs.
    exploration: Option<Exploration>,
    runs: u32,
}

impl Schedule {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            failsafe: settings.failsafe,
            period: match settings.policy {
                Policy::Reactive => settings.warm_up_period,
                Policy::Periodic => settings.period,
            },
            last_run: Instant::from_ticks(0),
            next_periodic: Instant::from_ticks(0),
            asked: Inputs::NONE,
            setpoint_asked: false,
            pending: None,
            pending_since: Instant::from_ticks(0),
            hyperperiod: Hyperperiod::default(),
            exploration: (settings.feedback == Feedback::Every)
                .then(|| Exploration::new(settings.seed)),
            runs: 0,
        }
    }

    /// An input's change calls for a run.
    pub(super) fn ask(&mut self, input: Input) {
        self.asked = self.asked.with(input);
    }

    /// The setpoint calls for a run.
    pub(super) fn ask_for_setpoint(&mut self) {
        self.setpoint_asked = true;
    }

    /// A run is due at once, whatever the phase.
    pub(super) fn force(&mut self, reason: Reason) {
        self.pending = Some(reason);
    }

    /// True where the setpoint moved past its quantum since the last run.
    pub(super) fn is_asked_by_setpoint(&self) -> bool {
        self.setpoint_asked
    }

    pub(super) fn asked(&self) -> Inputs {
        self.asked
    }

    pub(super) fn runs(&self) -> u32 {
        self.runs
    }

    /// Takes note of samples of gating inputs; true where they end the hyperperiod.
    pub(super) fn deliver(&mut self, at: Instant, inputs: Inputs) -> bool {
        self.hyperperiod.deliver(at, inputs)
    }

    /// A hyperperiod ended: is a run due?
    pub(super) fn end_hyperperiod(&mut self, at: Instant, phase: Phase) -> bool {
        let reason = match phase {
            Phase::Ground => Some(Reason::Ground),
            Phase::WarmUp => self.is_period_over(at).then_some(Reason::WarmUp),
            Phase::Fallback(_) => self.is_period_over(at).then_some(Reason::Fallback),
            Phase::Periodic => self.is_period_over(at).then_some(Reason::Periodic),
            Phase::Reactive => self.asked_reason().or_else(|| self.explored_reason()),
        };
        // A run that is due and did not happen yet stays due.
        if self.pending.is_none() {
            self.pending = reason;
            self.pending_since = at;
        }
        self.pending.is_some()
    }

    fn asked_reason(&self) -> Option<Reason> {
        if !self.asked.is_empty() {
            Some(Reason::Trigger)
        } else {
            self.setpoint_asked.then_some(Reason::Setpoint)
        }
    }

    fn explored_reason(&mut self) -> Option<Reason> {
        let explores = self.exploration.as_mut().is_some_and(Exploration::draw);
        explores.then_some(Reason::Exploration)
    }

    fn is_period_over(&mut self, at: Instant) -> bool {
        let period = self.period;
        // A period of one hyperperiod or less means every one, however long it really is.
        if period <= HYPERPERIOD {
            return true;
        }
        if at < self.next_periodic {
            return false;
        }
        // Keeps its phase, so that the mean rate is the one asked for; a long gap starts it anew.
        let behind = span(self.next_periodic, at) > period;
        self.next_periodic = if behind { at } else { self.next_periodic } + period;
        true
    }

    /// When the hyperperiod ends should a gating sample be missing.
    pub(super) fn timeout(&self) -> Instant {
        self.hyperperiod.timeout(self.last_run)
    }

    /// The reason of the run that is due at the end of a hyperperiod, if one is.
    pub(super) fn take_due(&mut self, now: Instant, phase: Phase) -> Option<Reason> {
        let cut_off = phase == Phase::Reactive && self.hyperperiod.is_over(now);
        let due = self.pending.take();
        if due.is_none() && cut_off {
            self.hyperperiod.end(now);
        }
        due.or_else(|| self.asked_reason().filter(|_| cut_off))
    }

    /// True where a run is due since a hyperperiod or longer.
    pub(super) fn is_late(&self, now: Instant) -> bool {
        self.pending.is_some() && span(self.pending_since, now) >= HYPERPERIOD
    }

    /// When the failsafe run is due.
    pub(super) fn deadline(&self) -> Instant {
        self.last_run + self.failsafe
    }

    /// A run happened.
    pub(super) fn on_run(&mut self, now: Instant) {
        self.last_run = now;
        self.asked = Inputs::NONE;
        self.setpoint_asked = false;
        self.pending = None;
        self.runs = self.runs.wrapping_add(1);
    }
}
