//! The supervisor: how control is run, as a table of (phase, event).

use crate::config::{LONGEST_WARM_UP, SHORTEST_WARM_UP};
use crate::settings::{Policy, WarmUp};
use crate::time::{Instant, span};

/// How control runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Phase {
    /// Motors stopped: control runs at every gating sample, nothing is learned.
    Ground,
    /// In the air, time-triggered at every gating sample, learning.
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
    /// No model of the gyroscope could be fitted.
    Unfit,
    /// The gating sensor fell silent.
    ImuLost,
}

/// What moves the supervisor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhaseEvent {
    /// Motors may turn.
    Armed,
    /// Motors are stopped.
    Disarmed,
    /// Every relevant model is fitted and stable.
    Learned,
    /// Learning took its longest; the gyroscope has a model.
    TimedOutFitted,
    /// Learning took its longest; the gyroscope has none.
    TimedOutUnfit,
    /// The gyroscope's model was lost.
    Unfit,
    /// The gating sensor fell silent.
    ImuLost,
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
            (Self::Ground, PhaseEvent::Armed) => match policy {
                Policy::Reactive => Self::WarmUp,
                Policy::Periodic(_) => Self::Periodic,
            },
            (Self::WarmUp, PhaseEvent::Learned | PhaseEvent::TimedOutFitted)
            | (Self::Fallback(Unfit), PhaseEvent::Learned) => Self::Reactive,
            (Self::WarmUp, PhaseEvent::TimedOutUnfit) | (Self::Reactive, PhaseEvent::Unfit) => {
                Self::Fallback(Unfit)
            }
            (Self::WarmUp | Self::Reactive | Self::Fallback(Unfit), PhaseEvent::ImuLost) => {
                Self::Fallback(ImuLost)
            }
            (Self::Fallback(ImuLost), PhaseEvent::ImuBack) => Self::WarmUp,
            (phase, _) => phase,
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
        matches!(
            self.phase,
            Phase::WarmUp | Phase::Fallback(FallbackReason::Unfit)
        )
    }

    /// Moves; the new phase where it differs.
    pub fn on(&mut self, event: PhaseEvent, now: Instant) -> Option<Phase> {
        let phase = self.phase.after(event, self.policy);
        if phase == self.phase {
            return None;
        }
        self.phase = phase;
        self.since = now;
        Some(phase)
    }

    /// What the models' state means now: called after every refit.
    ///
    /// `learned`: every relevant model is stable. `fitted`: the gyroscope has a model.
    #[must_use]
    pub fn judge(&self, learned: bool, fitted: bool, now: Instant) -> Option<PhaseEvent> {
        let age = span(self.since, now);
        let (earliest, latest) = match self.warm_up {
            WarmUp::Automatic => (SHORTEST_WARM_UP, LONGEST_WARM_UP),
            WarmUp::Fixed(length) => (length, length),
        };
        match self.phase {
            // However long it took: a model is all that was missing.
            Phase::Fallback(FallbackReason::Unfit) => {
                let ready = age >= earliest && learned || age >= latest && fitted;
                ready.then_some(PhaseEvent::Learned)
            }
            Phase::WarmUp => {
                if age >= latest && !fitted {
                    Some(PhaseEvent::TimedOutUnfit)
                } else if age >= latest {
                    Some(PhaseEvent::TimedOutFitted)
                } else if age >= earliest && learned {
                    Some(PhaseEvent::Learned)
                } else {
                    None
                }
            }
            Phase::Reactive if !fitted => Some(PhaseEvent::Unfit),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::{at_micros, micros};

    const PHASES: [Phase; 6] = [
        Phase::Ground,
        Phase::WarmUp,
        Phase::Reactive,
        Phase::Fallback(FallbackReason::Unfit),
        Phase::Fallback(FallbackReason::ImuLost),
        Phase::Periodic,
    ];

    #[test]
    fn every_pair_of_phase_and_event_leads_where_the_table_says() {
        use PhaseEvent::{
            Armed, Disarmed, ImuBack, ImuLost, Learned, TimedOutFitted, TimedOutUnfit, Unfit,
        };
        // Columns: Ground, WarmUp, Reactive, Fallback(Unfit), Fallback(ImuLost), Periodic.
        let table = [
            (Armed, ["W", "W", "R", "FU", "FI", "P"]),
            (Disarmed, ["G", "G", "G", "G", "G", "G"]),
            (Learned, ["G", "R", "R", "R", "FI", "P"]),
            (TimedOutFitted, ["G", "R", "R", "FU", "FI", "P"]),
            (TimedOutUnfit, ["G", "FU", "R", "FU", "FI", "P"]),
            (Unfit, ["G", "W", "FU", "FU", "FI", "P"]),
            (ImuLost, ["G", "FI", "FI", "FI", "FI", "P"]),
            (ImuBack, ["G", "W", "R", "FU", "W", "P"]),
        ];
        let short = |phase| match phase {
            Phase::Ground => "G",
            Phase::WarmUp => "W",
            Phase::Reactive => "R",
            Phase::Fallback(FallbackReason::Unfit) => "FU",
            Phase::Fallback(FallbackReason::ImuLost) => "FI",
            Phase::Periodic => "P",
        };
        for (event, row) in table {
            let after = PHASES.map(|phase| short(phase.after(event, Policy::Reactive)));
            assert_eq!(after, row, "{event:?}");
        }
    }

    #[test]
    fn warm_up_lasts_from_its_shortest_to_its_longest() {
        let mut supervisor = Supervisor::new(Policy::Reactive, WarmUp::Automatic);
        supervisor.on(PhaseEvent::Armed, at_micros(0));
        let just_before = at_micros(SHORTEST_WARM_UP.ticks() - 1);
        assert_eq!(supervisor.judge(true, true, just_before), None);
        let after = at_micros(SHORTEST_WARM_UP.ticks());
        assert_eq!(
            supervisor.judge(true, true, after),
            Some(PhaseEvent::Learned)
        );
        assert_eq!(supervisor.judge(false, true, after), None);
        let longest = at_micros(LONGEST_WARM_UP.ticks());
        assert_eq!(
            supervisor.judge(false, false, longest),
            Some(PhaseEvent::TimedOutUnfit)
        );
    }

    #[test]
    fn a_fallback_for_want_of_a_model_ends_when_there_is_one_however_late() {
        let fixed = WarmUp::Fixed(micros(1_000_000));
        for warm_up in [WarmUp::Automatic, fixed] {
            let mut supervisor = Supervisor::new(Policy::Reactive, warm_up);
            supervisor.on(PhaseEvent::Armed, at_micros(0));
            supervisor.on(PhaseEvent::TimedOutUnfit, at_micros(0));
            let late = at_micros(LONGEST_WARM_UP.ticks() * 10);
            assert_eq!(supervisor.judge(false, false, late), None);
            let event = supervisor.judge(false, true, late);
            assert_eq!(event, Some(PhaseEvent::Learned));
            assert_eq!(
                supervisor.on(PhaseEvent::Learned, late),
                Some(Phase::Reactive)
            );
        }
    }

    #[test]
    fn a_fixed_warm_up_ends_when_it_says() {
        let length = micros(5_000_000);
        let mut supervisor = Supervisor::new(Policy::Reactive, WarmUp::Fixed(length));
        supervisor.on(PhaseEvent::Armed, at_micros(0));
        assert_eq!(supervisor.judge(true, true, at_micros(4_999_999)), None);
        assert_eq!(
            supervisor.judge(false, true, at_micros(5_000_000)),
            Some(PhaseEvent::TimedOutFitted)
        );
    }
}
