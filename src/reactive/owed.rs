//! What the held command owes: the trigger that reactive control is built on.
//!
//! Between two runs the motors hold a command that control would have changed by now. What they
//! owe for it is an impulse: the difference between the command that control would compute and
//! the one that is held, summed over time *with its sign*, about each axis. Vibration cancels in
//! it; a drift far below what counts at one instant adds up. A run is due once an axis owes more
//! than a budget: an actuator's quantum for a time.
//!
//! An event-triggered integral of this kind has a third of the variance of periodic sampling at
//! the same mean rate (Astrom and Bernhardsson 1999).

use super::Sample;
use crate::airframe::{Axes, Mixer};
use crate::math::max;
use crate::settings::Settings;
use crate::time::{Duration, Instant, micros, seconds, span};

/// What an impulse about each axis counts: yaw turns slowly, and thrust lifts slowly.
const WEIGHTS: [f32; Axes::COUNT] = [1.0, 1.0, 0.3, 0.3];

/// How long a new command is given to repay.
pub(super) const REPAYMENT: Duration = micros(10_000);

/// A weighted share of full scale for each axis: roll, pitch, yaw, thrust.
pub type OfAxes = [f32; Axes::COUNT];

/// An impulse about each axis: weighted shares of full scale times seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impulse(pub(super) OfAxes);

/// The impulse that calls for a run, and the one that is worth it; see [`Impulse::size`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Budget {
    /// Past this a run is due.
    pub(super) most: f32,
    /// A run that repays less changed nothing: a quantum for the time of repayment.
    pub(super) worth: f32,
}

/// Which samples are looked at: what is owed follows from sums that go on anyway, so that a look that
/// is left out loses nothing but time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Looks {
    /// What was owed at the last one.
    owed: f32,
    /// The sample before that was left out.
    rested: bool,
    /// The next one is.
    rests: bool,
}

/// The way that a command took: where it is, and its sum over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    at: Instant,
    command: OfAxes,
    sum: Impulse,
}

/// The axes that impulses are measured about.
#[must_use]
pub fn axes_of(mixer: &Mixer) -> Axes {
    Axes::weighted(mixer, WEIGHTS)
}

impl Budget {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            most: settings.quantum * seconds(settings.budget),
            worth: settings.quantum * seconds(REPAYMENT),
        }
    }
}

impl Looks {
    /// True where this sample is to be looked at.
    pub(super) fn is_due(&mut self) -> bool {
        self.rested = core::mem::take(&mut self.rests);
        !self.rested
    }

    /// True where the newest sample was left out.
    pub(super) fn left_one_out(&self) -> bool {
        self.rested
    }

    /// So much is owed: the next sample is left out where the one after it would still find the
    /// budget kept, should what is owed grow twice as fast as it did.
    pub(super) fn take(&mut self, owed: f32, budget: f32) {
        let grown = max(owed - self.owed, 0.0);
        let in_two_samples = if self.rested { grown } else { 2.0 * grown };
        self.owed = owed;
        self.rests = owed + 2.0 * in_two_samples < budget;
    }
}

impl Impulse {
    /// What is owed about the axis that is owed most.
    #[must_use]
    pub fn size(&self) -> f32 {
        self.0.iter().fold(0.0, |most, axis| max(axis.abs(), most))
    }

    /// By how much less is owed after a while (s) than with a command that is off by `gain` more: what
    /// the run repaid that moved the command by it.
    pub(super) fn repaid(&self, gain: OfAxes, time: f32) -> f32 {
        self.grown(gain, time).size() - self.size()
    }

    /// With a command that is off by so much for another while (s).
    pub(super) fn grown(mut self, off: OfAxes, time: f32) -> Self {
        for (sum, off) in self.0.iter_mut().zip(off) {
            *sum += off * time;
        }
        self
    }
}

impl Course {
    /// A course that begins here.
    pub(super) fn begun(at: Instant, command: OfAxes) -> Self {
        Self {
            at,
            command,
            sum: Impulse::default(),
        }
    }

    /// Goes on to a command, which was in force since the last.
    pub(super) fn go_on(&mut self, at: Instant, command: OfAxes) {
        let time = seconds(span(self.at, at));
        self.sum = self.sum.grown(command, time);
        self.at = at;
        self.command = command;
    }

    /// What a command that was held since `earlier` owes by now.
    fn owed_by(&self, held: OfAxes, earlier: &Self) -> Impulse {
        let time = seconds(span(earlier.at, self.at));
        let mut owed = self.sum;
        for (owed, (before, held)) in owed.0.iter_mut().zip(earlier.sum.0.iter().zip(held)) {
            *owed -= before + held * time;
        }
        owed
    }

    /// By how much less the command of `run` owes since then than the one that it replaced, after
    /// [`REPAYMENT`]; `None` before.
    pub(super) fn repaid(&self, run: &Self, replaced: OfAxes) -> Option<f32> {
        let done = span(run.at, self.at) >= REPAYMENT;
        let owed_by = |held| self.owed_by(held, run).size();
        done.then(|| owed_by(replaced) - owed_by(run.command))
    }

    /// When it was last gone on.
    pub(super) fn at(&self) -> Instant {
        self.at
    }

    /// With its command in force until then; the same where that is over.
    pub(super) fn held_until(mut self, at: Instant) -> Self {
        self.go_on(at.max(self.at), self.command);
        self
    }

    /// Goes on to a command that is `off` from its own, which was held since, and owes so much.
    pub(super) fn spend(&mut self, at: Instant, owed: &Impulse, off: OfAxes) {
        self.go_on(at, self.command);
        self.sum = owed.grown(self.sum.0, 1.0);
        for (command, off) in self.command.iter_mut().zip(off) {
            *command += off;
        }
    }

    /// The command at its end.
    pub(super) fn command(&self) -> OfAxes {
        self.command
    }
}

/// A course changed as much as the command at its beginning owes by now.
impl Sample for Course {
    fn change_since(&self, reference: &Self) -> f32 {
        self.owed_by(reference.command, reference).size()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::SETTINGS;
    use crate::time::at_micros;

    const LEVEL: OfAxes = [0.0; Axes::COUNT];

    /// A course of a roll command, a millisecond a step, behind one that is level.
    fn course(steps: u64, roll: impl Fn(u64) -> f32) -> (Course, Course) {
        let begun = Course::begun(at_micros(0), LEVEL);
        let mut course = begun;
        for step in 1..=steps {
            let mut command = LEVEL;
            command[0] = roll(step);
            course.go_on(at_micros(step * 1000), command);
        }
        (begun, course)
    }

    fn owed(steps: u64, roll: impl Fn(u64) -> f32) -> f32 {
        let (begun, course) = course(steps, roll);
        course.change_since(&begun)
    }

    #[test]
    fn vibration_cancels_and_a_drift_below_a_quantum_adds_up() {
        let budget = Budget::new(&SETTINGS).most;
        let vibration = |step| if step % 2 == 0 { 0.02 } else { -0.02 };
        assert!(owed(100, vibration) < budget);
        let quarter = SETTINGS.quantum / 4.0;
        assert!(owed(100, |_| quarter) > budget);
    }

    #[test]
    fn a_look_is_left_out_while_the_budget_is_far() {
        let budget = 1.0;
        let looked_at = |growth: f32| {
            let (mut looks, mut seen) = (Looks::default(), Vec::new());
            for sample in 1..=40u16 {
                let owed = growth * f32::from(sample);
                if looks.is_due() {
                    looks.take(owed, budget);
                    seen.push(sample);
                }
                if owed > budget {
                    return (seen.last() == Some(&sample), seen.len());
                }
            }
            unreachable!("it grows")
        };
        let (found_at_once, looks) = looked_at(0.03);
        assert!(found_at_once && looks <= 22, "{looks} of 34");
        assert_eq!(looked_at(0.3), (true, 4), "of 4: it grows too fast");
    }

    #[test]
    fn what_is_owed_is_owed_about_the_worst_axis() {
        assert_eq!(Impulse([1.0, -3.0, 2.0, 0.5]).size(), 3.0);
        assert_eq!(Impulse([f32::NAN, 0.5, 0.0, 0.0]).size(), 0.5);
    }

    #[test]
    fn a_run_repays_what_its_command_comes_closer() {
        let new = 4.0 * SETTINGS.quantum;
        let repaid = |later: f32, steps| {
            let (_, mut run) = course(1, |_| new);
            let begun = run;
            for step in 2..=steps {
                let mut command = LEVEL;
                command[0] = later;
                run.go_on(at_micros(step * 1000), command);
            }
            run.repaid(&begun, LEVEL)
        };
        assert_eq!(repaid(new, 10), None, "its time is not over");
        let worth = 4.0 * Budget::new(&SETTINGS).worth;
        assert!((repaid(new, 11).expect("over") - worth).abs() < 1e-7);
        assert!((repaid(0.0, 11).expect("over") + worth).abs() < 1e-7);
    }
}
