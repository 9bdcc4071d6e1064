//! Each hyperperiod judged once: what was decided, what the motors held.
//!
//! Definitions, with the choices where they leave room:
//! - *positive*: the run at the hyperperiod's end was asked for by a trigger. *True*: the
//!   reference differs by a quantum or more from the command held when the decision was taken,
//!   so after a failsafe run that came earlier in the hyperperiod and before the run that the
//!   decision led to.
//! - A missed change counts once, until the next run of any reason. Later hyperperiods in
//!   which a change is still open are `StillMissed`; one where it has gone is a true negative.
//! - A hyperperiod is `Outside` when control ran there time-triggered (warm-up, periodic,
//!   fallback, ground), where no model's word decides, or by exploration or for a setpoint
//!   that no trigger joined: their outcome says nothing about a model. Failsafe runs are
//!   inside: every model said no.
//! - *Failsafe-changed*: a failsafe run that moved some motor by a quantum or more while no
//!   trigger had asked.
//! - *Prediction*: of a triggered run, the probability of a changed command that the models gave
//!   it, beside whether it was changed as the models learn it: its command repaid what a run is
//!   worth, or, where impulses do not count, differed from the one held before.
//! - *Stale from the trigger*: the policy's runs, with the reference's command in place of its
//!   own: at a run, hold the reference's command of that hyperperiod, or for an early run that
//!   of the one before, since the newer sample was not there yet.

use super::deviation::{Strayed, Straying, differs};
use super::flight_steps::{Command, FlightSteps, Run, Step};
use super::rules::Rules;
use reflex::app::Reason;

/// What a hyperperiod's decision turned out to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    TruePositive,
    FalsePositive,
    FalseNegative,
    TrueNegative,
    StillMissed,
    Outside,
}

/// One hyperperiod, judged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judged {
    pub class: Class,
    pub failsafe_changed: u64,
    /// Of a run that a model asked for: what it expected, and whether the command changed.
    pub prediction: Option<(f32, bool)>,
    /// What the motors held.
    pub own: Strayed,
    /// The reference's commands at the policy's runs.
    pub from_trigger: Strayed,
    pub saturated: bool,
}

/// Judges every hyperperiod of a flight, warm-up included, in order.
pub(super) fn judge(flight: &FlightSteps, rules: &Rules) -> Vec<Judged> {
    let mut judge = Judge {
        rules,
        missed: false,
        own: Straying::new(rules.quantum),
        trigger: Straying::new(rules.quantum),
        from_trigger: flight.initial(),
        last_reference: flight.initial(),
    };
    flight.steps().iter().map(|step| judge.step(step)).collect()
}

struct Judge<'r> {
    rules: &'r Rules,
    /// A missed change was counted and nothing ran since.
    missed: bool,
    own: Straying,
    trigger: Straying,
    /// The reference's command at the last run.
    from_trigger: Command,
    last_reference: Command,
}

impl Judge<'_> {
    fn step(&mut self, step: &Step) -> Judged {
        let quantum = self.rules.quantum;
        let mut failsafe_changed = 0;
        let mut before = step.before;
        for run in &step.early {
            failsafe_changed += failsafe_changed_by(run, &before, quantum);
            self.missed = false;
            before = run.command;
            self.from_trigger = self.last_reference;
        }
        let class = self.classify(step);
        self.missed |= class == Class::FalseNegative;
        let prediction = step.run.as_ref().and_then(|run| {
            let expected = run.expected.filter(|_| run.reason == Reason::Trigger)?;
            let changed = if self.rules.repays {
                run.repaid?
            } else {
                differs(&run.command, &step.held, quantum)
            };
            Some((expected, changed))
        });
        if let Some(run) = &step.run {
            failsafe_changed += failsafe_changed_by(run, &step.held, quantum);
            self.missed = false;
            self.from_trigger = step.reference;
        }
        self.last_reference = step.reference;
        Judged {
            class,
            failsafe_changed,
            prediction,
            own: (self.own).at(step.at_us, &step.applied, &step.reference),
            from_trigger: (self.trigger).at(step.at_us, &self.from_trigger, &step.reference),
            saturated: self.rules.saturates(&step.reference),
        }
    }

    fn classify(&self, step: &Step) -> Class {
        let truth = differs(&step.reference, &step.held, self.rules.quantum);
        let word = step.run.map_or(Word::No, |run| word(&run));
        match (word, truth) {
            (Word::None, _) => Class::Outside,
            (Word::Yes, true) => Class::TruePositive,
            (Word::Yes, false) => Class::FalsePositive,
            (Word::No, true) if self.missed => Class::StillMissed,
            (Word::No, true) => Class::FalseNegative,
            (Word::No, false) => Class::TrueNegative,
        }
    }
}

/// What the models said to a run.
enum Word {
    Yes,
    No,
    None,
}

fn word(run: &Run) -> Word {
    match run.reason {
        Reason::WarmUp | Reason::Periodic | Reason::Fallback | Reason::Ground => Word::None,
        _ if run.asked => Word::Yes,
        Reason::Trigger => Word::Yes,
        Reason::Failsafe => Word::No,
        Reason::Setpoint | Reason::Exploration => Word::None,
    }
}

/// 1 for a failsafe run that changed the command though no trigger had asked, else 0.
fn failsafe_changed_by(run: &Run, before: &Command, quantum: f32) -> u64 {
    let failsafe = run.reason == Reason::Failsafe && !run.asked;
    u64::from(failsafe && differs(&run.command, before, quantum))
}
