//! A flight as it is scored: one step per hyperperiod, with its runs.
//!
//! The steps are filled in order while a replay goes on; everything else in this module only
//! reads them. What a motor held is derived here, once, from the runs, so that a step can
//! never claim a command that no run wrote.

use std::ops::Range;

use reflex::airframe::MotorShares;
use reflex::app::Reason;

/// One command per motor, as shares of full scale within 0..=1.
pub type Command = MotorShares;

/// One execution of the control logic and the command that it applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Why control ran.
    pub reason: Reason,
    /// Whether a trigger had asked for it, for this or another reason.
    pub asked: bool,
    /// The probability of a changed command by the models that asked; `None` without one.
    pub expected: Option<f32>,
    /// Whether it repaid what a run is worth; `None` where nobody saw.
    pub repaid: Option<bool>,
    /// What it wrote to the motors.
    pub command: Command,
}

/// One hyperperiod of the flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// End of the hyperperiod in microseconds of the firmware's clock.
    pub at_us: u64,
    /// Command of the autopilot that runs at every gating sample, with its own state.
    pub reference: Command,
    /// Runs since the previous hyperperiod's end that waited for none, in order.
    pub early: Vec<Run>,
    /// The run at this hyperperiod's end.
    pub run: Option<Run>,
    /// Command held at the end of the previous hyperperiod.
    pub before: Command,
    /// Command held when this hyperperiod's decision was taken: after the early runs.
    pub held: Command,
    /// Command held after the decision took effect.
    pub applied: Command,
}

impl Step {
    /// All runs of the hyperperiod, in order.
    pub fn runs(&self) -> impl Iterator<Item = &Run> {
        self.early.iter().chain(&self.run)
    }
}

/// A whole flight, from its first hyperperiod, warm-up included.
#[derive(Clone, Debug)]
pub struct FlightSteps {
    start_us: u64,
    initial: Command,
    warm_up_end_us: Option<u64>,
    steps: Vec<Step>,
    early: Vec<Run>,
    /// Spans of the firmware's clock in which nothing is scored, in order.
    left_out: Vec<Range<u64>>,
    /// What the motors held behind the last of them.
    resumed: Option<Command>,
}

impl FlightSteps {
    /// An empty flight that starts at `start_us` of the firmware's clock.
    ///
    /// `initial` is what the motors held before the first run.
    #[must_use]
    pub fn new(start_us: u64, initial: Command) -> Self {
        Self {
            start_us,
            initial,
            warm_up_end_us: None,
            steps: Vec::new(),
            early: Vec::new(),
            left_out: Vec::new(),
            resumed: None,
        }
    }

    /// The same flight, in which some spans are not scored: what the sensors felt there, nobody knows.
    #[must_use]
    pub fn leaving_out(self, left_out: Vec<Range<u64>>) -> Self {
        Self { left_out, ..self }
    }

    /// True for an instant that is not scored: no hyperperiod is ended there.
    #[must_use]
    pub fn leaves_out(&self, at_us: u64) -> bool {
        self.left_out.iter().any(|span| span.contains(&at_us))
    }

    /// Takes note of a command that was applied where nothing is scored.
    pub fn hold(&mut self, command: Command) {
        self.early.clear();
        self.resumed = Some(command);
    }

    /// Takes note of a run that did not wait for a hyperperiod's end: the failsafe timer's.
    ///
    /// It belongs to the hyperperiod that ends next; after the last one it is not scored.
    pub fn run_early(&mut self, run: Run) {
        self.early.push(run);
    }

    /// Ends a hyperperiod with the run that was decided there, if one was.
    ///
    /// `at_us` must not go back. A hyperperiod that timed out without a gating sample ends too;
    /// its reference is the one before.
    pub fn end_hyperperiod(&mut self, at_us: u64, reference: Command, run: Option<Run>) {
        debug_assert!(at_us >= self.last_us(), "hyperperiods come in order");
        let last = self.steps.last().map_or(self.initial, |step| step.applied);
        let before = self.resumed.take().unwrap_or(last);
        let held = self.early.last().map_or(before, |run| run.command);
        self.steps.push(Step {
            at_us,
            reference,
            early: std::mem::take(&mut self.early),
            run,
            before,
            held,
            applied: run.map_or(held, |run| run.command),
        });
    }

    /// Marks the end of the first warm-up: hyperperiods that end later are scored.
    ///
    /// Only the first call counts; a warm-up after a fallback is part of what is scored.
    pub fn end_warm_up(&mut self, at_us: u64) {
        self.warm_up_end_us.get_or_insert(at_us);
    }

    /// When the warm-up ended, `None` while it lasts.
    #[must_use]
    pub fn warm_up_end_us(&self) -> Option<u64> {
        self.warm_up_end_us
    }

    /// Every hyperperiod so far, warm-up included.
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Seconds from the flight's start to an instant of the firmware's clock.
    #[must_use]
    pub fn seconds(&self, at_us: u64) -> f64 {
        seconds(self.start_us, at_us)
    }

    /// End of the last hyperperiod in microseconds of the firmware's clock.
    #[must_use]
    pub fn last_us(&self) -> u64 {
        self.steps.last().map_or(self.start_us, |step| step.at_us)
    }

    /// The part that is scored.
    pub(super) fn scored(&self) -> Scored<'_> {
        let end = self.warm_up_end_us.unwrap_or(u64::MAX);
        let first = self.steps.partition_point(|step| step.at_us <= end);
        let (warm_up, steps) = self.steps.split_at(first);
        let last = warm_up.last();
        Scored {
            first,
            start_us: self.warm_up_end_us.unwrap_or_else(|| self.last_us()),
            steps,
            reference: last.map_or(self.initial, |step| step.reference),
            ran_us: last.map_or(self.start_us, |step| step.at_us),
            left_out: &self.left_out,
        }
    }

    pub(super) fn initial(&self) -> Command {
        self.initial
    }
}

/// The hyperperiods after warm-up, and where they start from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scored<'f> {
    /// How many hyperperiods came before.
    pub first: usize,
    /// End of the warm-up.
    pub start_us: u64,
    /// The hyperperiods that ended later.
    pub steps: &'f [Step],
    /// What a yardstick holds at first: the reference's last command of the warm-up.
    pub reference: Command,
    /// When a yardstick last ran: at the warm-up's last hyperperiod.
    pub ran_us: u64,
    /// Spans that are not scored.
    left_out: &'f [Range<u64>],
}

impl Scored<'_> {
    /// Length in seconds.
    pub fn length_s(&self) -> f64 {
        let end = self.steps.last().map_or(self.start_us, |step| step.at_us);
        self.seconds(self.start_us, end)
    }

    /// Seconds of a span that are scored.
    pub fn seconds(&self, from_us: u64, to_us: u64) -> f64 {
        let inside = |span: &Range<u64>| seconds(span.start.max(from_us), span.end.min(to_us));
        seconds(from_us, to_us) - self.left_out.iter().map(inside).sum::<f64>()
    }
}

/// Seconds between two instants, zero where they go back.
pub(super) fn seconds(from_us: u64, to_us: u64) -> f64 {
    to_us.saturating_sub(from_us) as f64 * 1e-6
}
