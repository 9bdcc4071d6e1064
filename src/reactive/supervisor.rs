//! The supervisor: how control is run, as a table of (phase, event).
//!
//! Whatever goes wrong leads to time-triggered control, which learns, and from there back. A
//! fallback lasts a while, and longer each time it follows soon on the one before: it cannot
//! chatter.

use crate::config::{LONGEST_FALLBACK, LONGEST_WARM_UP, SHORTEST_WARM_UP};
use crate::settings::{Policy, WarmUp};
use crate::time::{Duration, Instant, span};

/// How control runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Phase {
    /// Motors stopped: control runs at every gating sample, nothing is learned.
    Ground,
    /// In the air, time-triggered, learning.
    WarmUp,
    /// Control runs when a change calls for it.
    Reactive,
    /// Time-triggered again, learning anew, for a reason.
    Fallback(FallbackReason),
    /// Time-triggered at the period of the settings, by choice.
    Periodic,
}

/// Why reactive control was left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum FallbackReason {
    /// The leading input has no model.
    Unfit,
    /// Triggered runs change nothing more often than the models promise.
    FalsePositives,
    /// Failsafe runs change the command more often than the models promise.
    Missed,
    /// Setpoints turn faster than the models were learned at.
    Aerobatics,
    /// Runs begin a hyperperiod or more late.
    Overrun,
    /// A chip whose model triggers fell silent, or repeats itself.
    SensorLost,
    /// The gating sensor fell silent, or repeats itself.
    ImuLost,
}

impl FallbackReason {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Unfit,
        Self::FalsePositives,
        Self::Missed,
        Self::Aerobatics,
        Self::Overrun,
        Self::SensorLost,
        Self::ImuLost,
    ];

    /// True where what was learned is wrong here, so that learning begins from scratch.
    #[must_use]
    pub fn refutes_models(self) -> bool {
        matches!(self, Self::FalsePositives | Self::Missed)
    }
}

/// What moves the supervisor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhaseEvent {
    /// Motors may turn.
    Armed,
    /// Motors are stopped.
    Disarmed,
    /// Every relevant model is fitted and stable, or learning took its longest with a model.
    Learned,
    /// Learning took its longest; the leading input has no model.
    TimedOut,
    /// Something is wrong.
    Fail(FallbackReason),
    /// The gating sensor is back.
    ImuBack,
}

impl Phase {
    /// The phase after an event.
    #[must_use]
    pub fn after(self, event: PhaseEvent, policy: Policy) -> Self {
        use FallbackReason::{ImuLost, Unfit};
        match (self, event) {
            (_, PhaseEvent::Disarmed) => Self::Ground,
            (Self::Ground, PhaseEvent::Armed) | (Self::Fallback(ImuLost), PhaseEvent::ImuBack) => {
                match policy {
                    Policy::Reactive => Self::WarmUp,
                    Policy::Periodic => Self::Periodic,
                }
            }
            (Self::Ground | Self::Fallback(ImuLost), _) => self,
            // Whatever the policy: blind, it would hold the last torque.
            (_, PhaseEvent::Fail(ImuLost)) => Self::Fallback(ImuLost),
            (Self::Periodic, _) => self,
            (Self::Reactive, PhaseEvent::Fail(reason)) => Self::Fallback(reason),
            (Self::WarmUp | Self::Fallback(_), PhaseEvent::Learned) => Self::Reactive,
            (Self::WarmUp, PhaseEvent::TimedOut) => Self::Fallback(Unfit),
            _ => self,
        }
    }
}

/// The phase, and since when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervisor {
    phase: Phase,
    since: Instant,
    policy: Policy,
    warm_up: WarmUp,
    /// Fallbacks in a row, each soon after the one before.
    relapses: u8,
}

impl Supervisor {
    /// On the ground.
    #[must_use]
    pub fn new(policy: Policy, warm_up: WarmUp) -> Self {
        Self {
            phase: Phase::Ground,
            since: Instant::from_ticks(0),
            policy,
            warm_up,
            relapses: 0,
        }
    }

    /// The phase in force.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// True while labels come from shadow holds.
    #[must_use]
    pub fn is_learning(&self) -> bool {
        match self.phase {
            Phase::WarmUp => true,
            Phase::Fallback(reason) => reason != FallbackReason::ImuLost,
            Phase::Ground | Phase::Reactive | Phase::Periodic => false,
        }
    }

    /// Moves; the new phase where it differs.
    pub fn on(&mut self, event: PhaseEvent, now: Instant) -> Option<Phase> {
        let phase = self.phase.after(event, self.policy);
        if phase == self.phase {
            // What lasts is not over: the way back begins with its end.
            if let (Phase::Fallback(reason), PhaseEvent::Fail(again)) = (phase, event)
                && reason == again
            {
                self.since = now;
            }
            return None;
        }
        if matches!((self.phase, phase), (Phase::Reactive, Phase::Fallback(_))) {
            let soon = span(self.since, now) < LONGEST_FALLBACK;
            self.relapses = if soon {
                self.relapses.saturating_add(1)
            } else {
                0
            };
        }
        self.phase = phase;
        self.since = now;
        Some(phase)
    }

    /// What the models' state means now: called after every refit.
    ///
    /// `learned`: every relevant model is stable. `fitted`: the leading input has a model.
    #[must_use]
    pub fn judge(&self, learned: bool, fitted: bool, now: Instant) -> Option<PhaseEvent> {
        let age = span(self.since, now);
        let (earliest, latest) = match self.warm_up {
            WarmUp::Automatic => (SHORTEST_WARM_UP, LONGEST_WARM_UP),
            WarmUp::Fixed(length) => (length, length),
        };
        match self.phase {
            Phase::Fallback(FallbackReason::ImuLost) => None,
            // However long it took: a model is all that is needed.
            Phase::Fallback(_) => {
                let ready = age >= earliest && learned || age >= latest && fitted;
                (ready && age >= self.shortest_fallback()).then_some(PhaseEvent::Learned)
            }
            Phase::WarmUp if age >= latest && !fitted => Some(PhaseEvent::TimedOut),
            Phase::WarmUp => {
                let ready = age >= earliest && learned || age >= latest;
                ready.then_some(PhaseEvent::Learned)
            }
            Phase::Reactive if !fitted => Some(PhaseEvent::Fail(FallbackReason::Unfit)),
            Phase::Reactive | Phase::Ground | Phase::Periodic => None,
        }
    }

    /// Twice as long with each fallback that came soon after the one before.
    fn shortest_fallback(&self) -> Duration {
        let doubled = SHORTEST_WARM_UP * (1 << self.relapses.min(10));
        doubled.min(LONGEST_FALLBACK)
    }
}

#[cfg(test)]
mod tests;
