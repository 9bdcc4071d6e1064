//! Shadow runs: what a run at a chip's sample would repay if it were made.
//!
//! A threshold in a chip hides most samples, and runs that only a chip asks for are rare: labels
//! from runs alone would be too few to learn a model from. But three things say what a run repays:
//! the command that it would compute, the one that it would replace, and what control wants in the
//! time of repayment. The course of the command has all three, also where no run is made. So every
//! sample of a chip gives a label.
//!
//! The change is that since the chip's reference, and what is replaced is the command in force. A
//! change since a reference that an open chip would have renewed by then tells nothing.

use super::Label;
use super::owed::{Course, OfAxes, REPAYMENT};
use crate::config::of_input;
use crate::sensors::Input;
use crate::time::{Duration, Instant, micros, span};

/// From when on a shadow run is judged; its last command counts for what is left of the time of
/// repayment. So that the chip's next sample finds it judged, however fast its oscillator.
const JUDGED_AFTER: Duration = micros(REPAYMENT.ticks() * 9 / 10);

/// The shadow runs of all chips, in the order of [`Input::OF_CHIPS`].
#[derive(Clone, Debug)]
pub(super) struct ShadowRuns {
    chips: [OfChip; Input::OF_CHIPS.len()],
    /// When the next is begun or judged.
    due: Option<Instant>,
}

/// One chip's.
#[derive(Clone, Copy, Debug, Default)]
struct OfChip {
    /// When its reference was taken.
    referred: Option<Instant>,
    /// A change that was sampled, and the command in force; the run begins with the next command
    /// that is known.
    sampled: Option<(f32, OfAxes)>,
    run: Option<ShadowRun>,
}

#[derive(Clone, Copy, Debug)]
struct ShadowRun {
    x: f32,
    run: Course,
    replaced: OfAxes,
}

impl ShadowRuns {
    pub(super) fn new() -> Self {
        Self {
            chips: Default::default(),
            due: None,
        }
    }

    /// Forgets references, and runs that are not judged yet.
    pub(super) fn restart(&mut self) {
        *self = Self::new();
    }

    fn of(&mut self, input: Input) -> Option<&mut OfChip> {
        let mut chips = Input::OF_CHIPS.into_iter().zip(&mut self.chips);
        chips.find_map(|(of, chip)| (of == input).then_some(chip))
    }

    /// A chip's reference was taken.
    pub(super) fn refer(&mut self, at: Instant, input: Input) {
        if let Some(chip) = self.of(input) {
            chip.referred = Some(at);
        }
    }

    /// A chip sampled a change since its reference; the command in force is that of a run. False
    /// where that tells nothing.
    pub(super) fn sample(&mut self, at: Instant, input: Input, x: f32, run: &Course) -> bool {
        let period = of_input(input).period;
        let Some(chip) = self.of(input) else {
            return false;
        };
        let tells = (chip.referred).is_some_and(|referred| run.at() < referred + period);
        if tells {
            chip.sampled = Some((x, run.command()));
            self.due = Some(at);
        }
        tells
    }

    /// True where [`Self::follow`] is worth a call.
    pub(super) fn are_due(&self, now: Instant) -> bool {
        self.due.is_some_and(|due| now >= due)
    }

    /// True where the course's sum matters to a run that is not judged yet.
    pub(super) fn are_under_way(&self) -> bool {
        self.due.is_some()
    }

    /// Begins and judges runs along the course of the command; `worth` is the impulse that one
    /// must repay to be *changed*.
    pub(super) fn follow(
        &mut self,
        course: &Course,
        worth: f32,
        mut learn: impl FnMut(Input, Label),
    ) {
        self.due = None;
        for (input, chip) in Input::OF_CHIPS.into_iter().zip(&mut self.chips) {
            if let Some(run) = &chip.run
                && let Some(label) = run.judged(course, worth)
            {
                learn(input, label);
                chip.run = None;
            }
            // One that comes while another is under way is left out.
            if let Some((x, replaced)) = chip.sampled.take()
                && chip.run.is_none()
            {
                let run = *course;
                chip.run = Some(ShadowRun { x, run, replaced });
            }
            if let Some(run) = &chip.run {
                let due = run.run.at() + JUDGED_AFTER;
                self.due = Some(self.due.map_or(due, |soonest| soonest.min(due)));
            }
        }
    }
}

impl ShadowRun {
    fn judged(&self, course: &Course, worth: f32) -> Option<Label> {
        let due = span(self.run.at(), course.at()) >= JUDGED_AFTER;
        let rest = course.held_until(self.run.at() + REPAYMENT);
        let repaid = rest.repaid(&self.run, self.replaced).filter(|_| due)?;
        Some(Label {
            x: self.x,
            changed: repaid >= worth,
            weight: 1.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::SETTINGS;
    use crate::reactive::owed::Budget;
    use crate::time::at_micros;

    const CHIP: Input = Input::ChipAccel;

    /// Labels of shadow runs at samples with a change of 1, every 10 ms, while a roll command follows
    /// its course behind the only run.
    fn labels(roll: impl Fn(u64) -> f32) -> Vec<Label> {
        let command = |step| [roll(step), 0.0, 0.0, 0.0];
        let run = Course::begun(at_micros(0), command(0));
        let (mut course, mut shadow_runs) = (run, ShadowRuns::new());
        let mut labels = Vec::new();
        for step in 1..=60 {
            let now = at_micros(step * 1000);
            course.go_on(now, command(step));
            if step % 10 == 0 {
                shadow_runs.refer(at_micros(0), CHIP);
                shadow_runs.sample(now, CHIP, 1.0, &run);
            }
            if shadow_runs.are_due(now) {
                let worth = Budget::new(&SETTINGS).worth;
                shadow_runs.follow(&course, worth, |_, label| labels.push(label));
            }
        }
        labels
    }

    #[test]
    fn a_run_that_nobody_made_is_changed_where_it_would_have_repaid() {
        let quantum = SETTINGS.quantum;
        let steady = labels(|_| 0.0);
        assert_eq!(steady.len(), 5, "one for each sample whose time is over");
        assert!(steady.iter().all(|label| !label.changed && label.x == 1.0));
        let off = labels(|step| if step > 5 { 2.0 * quantum } else { 0.0 });
        assert!(off.iter().all(|label| label.changed));
    }

    #[test]
    fn what_is_back_within_the_time_of_repayment_repays_nothing() {
        let quantum = SETTINGS.quantum;
        let back = labels(|step| if step % 10 == 0 { 2.0 * quantum } else { 0.0 });
        assert!(back.iter().all(|label| !label.changed));
    }

    #[test]
    fn a_change_behind_a_run_that_would_have_renewed_the_reference_tells_nothing() {
        let period = of_input(CHIP).period;
        let mut shadow_runs = ShadowRuns::new();
        shadow_runs.refer(at_micros(0), CHIP);
        let run = Course::begun(at_micros(0) + period, OfAxes::default());
        assert!(!shadow_runs.sample(run.at() + period, CHIP, 1.0, &run));
        assert!(!shadow_runs.are_due(run.at() + period));
    }
}
