//! A replay's calls made again: reference, mirror, and the scored flight.
//!
//! The *reference* is a second autopilot that runs at every gating sample of the same flight,
//! with its own state: when the firmware ran behind that sample, so that both know of the same
//! messages, else at the sample itself. The *mirror* makes the firmware's very calls and must
//! compute the firmware's very commands, bit for bit.

use anyhow::Result;
use reflex::airframe::Mixer;
use reflex::app::{Autopilot, Call, Next, Reason, Stamped};
use reflex::config::HYPERPERIOD;
use reflex::reactive::{FallbackReason, Phase, axes_of};
use reflex::sensors::Input;
use reflex::settings::Policy;
use reflex::time::{Instant, seconds};

use crate::logics::{AnyLogic, Start};
use crate::record::Mirror;
use crate::scoring::{
    Clock, Command, FlightSteps, Held, LOADS, LoadRules, Rules, Run, Score, score,
};

/// A replay as its calls show it.
pub(crate) struct Timeline<'c> {
    /// Those of the flight, as far as it is scored.
    pub(crate) calls: &'c [Stamped],
    start: Start,
    start_us: u64,
    pub(crate) flight: FlightSteps,
    /// Places among the calls of the samples that ended the flight's hyperperiods.
    ends: Vec<usize>,
    /// For each call, whether it is a sample behind which the hyperperiod's task ran.
    answered: Vec<bool>,
    pub(crate) verdicts: Verdicts,
    pub(crate) mirror: Mirror,
    /// Runs with motors that may turn.
    pub(crate) runs_in_the_air: u64,
    /// Times that reactive control was left for a fallback.
    pub(crate) fallbacks: u64,
    /// The same, by reason.
    pub(crate) fallbacks_by_reason: [(FallbackReason, u64); FallbackReason::ALL.len()],
    /// The firmware's clock at the first end of a hyperperiod, in us.
    pub(crate) first_hyperperiod_us: Option<u64>,
    /// Samples behind the warm-up whose command was foreseen exactly.
    foreseen: u64,
    /// When the firmware disarmed its motors, in us of its clock, where it did.
    pub(crate) disarmed_us: Option<u64>,
}

/// How long before a disarm the score ends, in us: what led to it, as a crash, is no flight, and
/// control that runs at other times disarms up to a failsafe period apart.
const BEFORE_DISARM_US: u64 = 2_000_000;

/// What the mirror was behind a call.
#[derive(Clone, Copy)]
struct Seen {
    phase: Phase,
    foresees: bool,
}

/// All calls made again, and what was seen.
struct Mirrored {
    mirror: Mirror,
    /// Behind each call.
    seen: Vec<Seen>,
    /// When motors were disarmed, in us of the firmware's clock.
    disarmed_us: Option<u64>,
}

impl Mirrored {
    fn of(calls: &[Stamped], start: &Start) -> Result<Self> {
        let mut mirror = Mirror::new(start);
        let mut seen = Vec::with_capacity(calls.len());
        let (mut was_armed, mut disarmed_us) = (false, None);
        for stamped in calls {
            mirror.take(stamped)?;
            let telemetry = mirror.autopilot().telemetry();
            let is_armed = telemetry.state.is_armed();
            if was_armed && !is_armed {
                disarmed_us.get_or_insert(stamped.at.ticks());
            }
            was_armed = is_armed;
            seen.push(Seen {
                phase: telemetry.phase,
                foresees: mirror.autopilot().foresees(),
            });
        }
        Ok(Self {
            mirror,
            seen,
            disarmed_us,
        })
    }
}

/// The command that the motors held at an instant of the firmware's clock.
fn held_at(calls: &[Stamped], at_us: u64, motors: usize) -> Command {
    let before = calls
        .iter()
        .rev()
        .filter(|stamped| stamped.at.ticks() < at_us);
    let mut runs = before.filter_map(|stamped| match stamped.call {
        Call::Ran(ran) => Some(ran.shares),
        _ => None,
    });
    runs.next().unwrap_or(Command::all(0.0, motors))
}

/// The hyperperiod that a gating sample has ended and the next one will close.
struct Open {
    at_us: u64,
    run: Option<Run>,
}

impl<'c> Timeline<'c> {
    /// Makes the calls again; hyperperiods count from `start_us` of the firmware's clock.
    ///
    /// # Errors
    /// The firmware computed other bits than the host.
    pub(crate) fn of(calls: &'c [Stamped], start: &Start, start_us: u64) -> Result<Self> {
        let Mirrored {
            mirror,
            seen,
            disarmed_us,
        } = Mirrored::of(calls, start)?;
        let end_us = disarmed_us.map_or(u64::MAX, |at| at.saturating_sub(BEFORE_DISARM_US));
        let flown = calls.partition_point(|stamped| stamped.at.ticks() < end_us);
        let mut timeline = Self {
            calls: &calls[..flown],
            start: *start,
            start_us,
            flight: FlightSteps::new(start_us, held_at(calls, start_us, start.airframe.count())),
            ends: Vec::new(),
            answered: answered(calls),
            verdicts: Verdicts::of(calls),
            mirror,
            runs_in_the_air: 0,
            fallbacks: 0,
            fallbacks_by_reason: FallbackReason::ALL.map(|reason| (reason, 0)),
            first_hyperperiod_us: None,
            foreseen: 0,
            disarmed_us,
        };
        if start.settings.policy != Policy::Reactive {
            timeline.flight.end_warm_up(start_us);
        }
        timeline.walk(&seen);
        Ok(timeline)
    }

    fn walk(&mut self, seen: &[Seen]) {
        let mut reference = Native::new(self.start);
        let mut open: Option<Open> = None;
        let mut by_timer = false;
        let mut phase = Phase::Ground;
        for (place, stamped) in self.calls.iter().enumerate() {
            let at_us = stamped.at.ticks();
            let seen = seen[place];
            self.notice_phase(phase, seen.phase, at_us);
            phase = seen.phase;
            let ended = reference.take(stamped);
            match stamped.call {
                Call::Imu(_) if ended => {
                    self.close(&mut open, &reference.command);
                    self.first_hyperperiod_us.get_or_insert(at_us);
                    if at_us >= self.start_us {
                        self.ends.push(place);
                        self.foreseen += u64::from(seen.foresees);
                    }
                    open = Some(Open { at_us, run: None });
                    if !self.answered[place] {
                        reference.run(stamped.at);
                    }
                }
                Call::Timer => by_timer = true,
                Call::Hyperperiod => {
                    by_timer = false;
                    reference.run(stamped.at);
                }
                Call::Ran(ran) => {
                    // Only in reactive control does a change that is seen ask for anything.
                    let asked = !ran.asked.is_empty() && phase == Phase::Reactive;
                    let run = Run {
                        reason: ran.reason,
                        asked,
                        expected: ran.expected,
                        repaid: self.verdicts.changed(place),
                        command: ran.shares,
                    };
                    self.take_run(run, (at_us, by_timer), &mut open, &reference.command);
                }
                _ => {}
            }
        }
        self.close(&mut open, &reference.command);
    }

    fn notice_phase(&mut self, before: Phase, phase: Phase, at_us: u64) {
        if phase == Phase::Reactive {
            self.flight.end_warm_up(at_us);
        }
        if let Phase::Fallback(reason) = phase
            && phase != before
        {
            self.fallbacks += 1;
            let counted = self.fallbacks_by_reason.iter_mut();
            for (_, count) in counted.filter(|(known, _)| *known == reason) {
                *count += 1;
            }
        }
    }

    fn take_run(
        &mut self,
        run: Run,
        (at_us, by_timer): (u64, bool),
        open: &mut Option<Open>,
        reference: &Command,
    ) {
        if run.reason != Reason::Ground && run.command.iter().any(|share| *share != 0.0) {
            self.runs_in_the_air += 1;
        }
        match open {
            Some(open) if !by_timer && open.run.is_none() => open.run = Some(run),
            _ => {
                self.close(open, reference);
                if at_us >= self.start_us {
                    self.flight.run_early(run);
                }
            }
        }
    }

    fn close(&mut self, open: &mut Option<Open>, reference: &Command) {
        if let Some(open) = open.take()
            && open.at_us >= self.start_us
        {
            self.flight
                .end_hyperperiod(open.at_us, *reference, open.run);
        }
    }

    /// Judges the flight, and periodic control on the same flight.
    ///
    /// `busy` is the share of time in which the policy kept a processor busy, where there was one.
    pub(crate) fn score(&self, busy: Option<f64>) -> Score {
        score(&self.flight, &self.rules(busy), |clock| {
            self.fly_periodic(clock)
        })
    }

    fn rules(&self, busy: Option<f64>) -> Rules {
        let failsafe_us = self.start.settings.failsafe.ticks();
        let costs = LOADS.logics.get(self.start.gains.name().word());
        let load = costs.map(|costs| LoadRules {
            core_hz: LOADS.core_hz,
            policy: match self.start.settings.policy {
                Policy::Reactive => costs.reactive,
                Policy::Periodic => costs.periodic,
            },
            periodic: costs.periodic,
            foresight: costs.foresight * self.foreseen as f64,
            busy,
        });
        Rules {
            repays: self.start.settings.triggers.contains(Input::Owed),
            axes: axes_of(&Mixer::new(&self.start.airframe)),
            budget_s: seconds(self.start.settings.budget),
            load,
            quantum: self.start.settings.quantum,
            failsafe_us,
            limits: self.start.airframe.armed_minimum()..=1.0,
            // The failsafe's timer runs control where the clock does not.
            periodic_hz: 1e6 / failsafe_us as f64..=1e6 / HYPERPERIOD.ticks() as f64,
        }
    }

    /// Periodic control by a clock on the same flight: what it held at each hyperperiod's end.
    ///
    /// Through the warm-up it runs at every gating sample, as the policy it is compared with
    /// did: both enter the scored part with the same control state.
    fn fly_periodic(&self, clock: Clock) -> Vec<Held> {
        let mut native = Native::new(self.start);
        let warm_up_end = self.flight.warm_up_end_us().unwrap_or(u64::MAX);
        let period_us = (1e6 / clock.rate_hz).min(self.start.settings.failsafe.ticks() as f64);
        let mut due_us = warm_up_end as f64 + clock.phase * period_us;
        let mut held = Vec::<Held>::with_capacity(self.ends.len());
        let mut ends = self.ends.iter().peekable();
        let mut waits = false;
        for (place, stamped) in self.calls.iter().enumerate() {
            let at_us = stamped.at.ticks();
            let ended = native.take(stamped);
            if ended {
                waits = at_us <= warm_up_end || at_us as f64 >= due_us;
                if waits && at_us > warm_up_end {
                    due_us = (due_us + period_us).max(at_us as f64);
                }
                if ends.next_if_eq(&&place).is_some() {
                    held.push(Held {
                        command: native.command,
                        runs: 0,
                    });
                }
            }
            let now = stamped.call == Call::Hyperperiod || (ended && !self.answered[place]);
            if now
                && core::mem::take(&mut waits)
                && native.run(stamped.at)
                && let Some(held) = held.last_mut()
            {
                held.command = native.command;
                held.runs = 1;
            }
        }
        held
    }
}

/// An autopilot on the host that is given the flight's inputs and run when it is told.
struct Native {
    autopilot: Autopilot<(), AnyLogic>,
    command: Command,
}

impl Native {
    fn new(mut start: Start) -> Self {
        start.settings.policy = Policy::Periodic;
        start.settings.period = HYPERPERIOD;
        Self {
            autopilot: start.autopilot(()),
            command: Command::all(0.0, start.airframe.count()),
        }
    }

    /// Takes an input of the flight; true where a hyperperiod ends with it.
    fn take(&mut self, stamped: &Stamped) -> bool {
        match &stamped.call {
            Call::Imu(burst) => self.autopilot.on_imu(stamped.at, burst) == Next::Hyperperiod,
            Call::Chip(_) | Call::Message(_) => {
                stamped.call.replay(stamped.at, &mut self.autopilot);
                false
            }
            _ => false,
        }
    }

    /// Runs if a hyperperiod has ended since the last run; true where it ran.
    fn run(&mut self, at: Instant) -> bool {
        let output = self.autopilot.on_hyperperiod(at);
        self.command = output.map_or(self.command, |output| output.share());
        output.is_some()
    }
}

/// What became of runs, by their places among the calls.
pub(crate) struct Verdicts(Vec<Option<bool>>);

impl Verdicts {
    /// A verdict is on the run before it: every run ends the wait for the one before.
    fn of(calls: &[Stamped]) -> Self {
        let mut verdicts = vec![None; calls.len()];
        let mut last = None;
        for (place, stamped) in calls.iter().enumerate() {
            match stamped.call {
                Call::Ran(_) => last = Some(place),
                Call::Judged(changed) => {
                    if let Some(last) = last {
                        verdicts[last] = Some(changed);
                    }
                }
                _ => {}
            }
        }
        Self(verdicts)
    }

    /// Whether the run at this place was changed; `None` where that was not seen.
    pub(crate) fn changed(&self, place: usize) -> Option<bool> {
        self.0[place]
    }
}

/// For each call, whether it is a sample behind which the hyperperiod's task ran.
fn answered(calls: &[Stamped]) -> Vec<bool> {
    let mut ran = false;
    let backwards = calls.iter().rev().map(|stamped| match stamped.call {
        Call::Hyperperiod => {
            ran = true;
            false
        }
        Call::Imu(_) => core::mem::take(&mut ran),
        _ => false,
    });
    let mut answered: Vec<bool> = backwards.collect();
    answered.reverse();
    answered
}
