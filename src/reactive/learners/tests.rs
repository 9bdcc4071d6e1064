//! Inputs that first crossings teach too little learn from lags, and only those.

use super::learner::PATIENCE;
use super::*;
use crate::airframe::{Mixer, MotorShares};
use crate::config::{HYPERPERIOD, SETTINGS};
use crate::reactive::RefitJob;
use crate::reactive::owed::axes_of;
use crate::time::{Duration, micros};
use proptest::prelude::*;

/// Where the command at one instant leads.
const DEAD_BAND: Settings = Settings {
    triggers: Inputs::ALL.without(Input::Owed),
    ..SETTINGS
};

/// Learners that are shown a run per hyperperiod.
struct School {
    learners: Learners,
    now: Instant,
    turned: Inputs,
}

impl School {
    fn new(settings: &Settings) -> Self {
        Self {
            learners: Learners::new(settings, axes_of(&Mixer::default())),
            now: Instant::from_ticks(0),
            turned: Inputs::NONE,
        }
    }

    /// Shows runs for a while, each motor at what `share` says for the time in seconds.
    fn show(&mut self, length: Duration, share: impl Fn(f32) -> f32) {
        for step in 0..length / HYPERPERIOD {
            self.now += HYPERPERIOD;
            let command = MotorShares::all(share(self.now.ticks() as f32 * 1e-6), 4);
            self.learners.hold_run(self.now, &command, |_, _| {});
            if step % 500 == 0 {
                self.refit(Input::Command);
            }
        }
    }

    fn refit(&mut self, input: Input) {
        let leads = input == self.learners.lead();
        let lesson = self.learners.lesson_mut(input);
        let labels = lesson.labels;
        lesson.swap(
            RefitJob {
                input,
                leads,
                evidence: EVIDENCE,
                labels,
            }
            .fit()
            .fit,
        );
        self.turned = self.turned.or(self.learners.turn_to_lags(self.now));
    }
}

/// A slow swing of so many quanta.
fn swing(quanta: f32) -> impl Fn(f32) -> f32 {
    move |time| 0.5 + 0.5 * quanta * SETTINGS.quantum * libm::sinf(6.0 * time)
}

#[test]
fn an_input_that_crosses_no_candidate_turns_to_lags_in_time() {
    let mut school = School::new(&DEAD_BAND);
    school.show(PATIENCE, swing(0.01));
    assert_eq!(school.turned, Inputs::NONE);
    let labels = school.learners.command.lesson.labels.total();
    school.show(micros(600_000), swing(0.01));
    assert_eq!(school.turned, Inputs::NONE.with(Input::Command));
    assert!(
        school.learners.command.lesson.labels.total() > labels,
        "labels stay"
    );
}

#[test]
fn an_input_that_learns_keeps_its_first_crossings() {
    let mut school = School::new(&DEAD_BAND);
    school.show(PATIENCE * 2, swing(8.0));
    assert_eq!(school.turned, Inputs::NONE);
    assert!(school.learners.command.lesson.decision.model().is_some());
}

#[test]
fn holds_that_begin_anew_are_given_as_long_again() {
    let mut school = School::new(&DEAD_BAND);
    school.show(PATIENCE, swing(0.01));
    school.learners.restart_holds();
    school.show(PATIENCE, swing(0.01));
    assert_eq!(school.turned, Inputs::NONE);
}

#[test]
fn learning_from_scratch_begins_with_first_crossings_again() {
    let mut school = School::new(&DEAD_BAND);
    school.show(PATIENCE + micros(600_000), swing(0.01));
    let pairs = |school: &School| school.learners.rule_for(Input::Command).pairs;
    assert_eq!(pairs(&school), Pairs::WeightedLags);
    school.learners.restart();
    assert_eq!(pairs(&school), Pairs::FirstCrossings);
}

#[test]
fn pairs_that_were_asked_for_stay() {
    let mut school = School::new(&Settings {
        pairs: Pairs::Published,
        ..DEAD_BAND
    });
    school.show(PATIENCE * 2, swing(0.01));
    assert_eq!(school.turned, Inputs::NONE);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn after_patience_an_input_has_a_model_or_lags(quanta in 0.0f32..12.0) {
        let mut school = School::new(&DEAD_BAND);
        school.show(PATIENCE + micros(600_000), swing(quanta));
        let model = school.learners.command.lesson.decision.model();
        let lags = school.turned.contains(Input::Command);
        prop_assert!(model.is_some() || lags);
        // Within the failsafe such a swing goes through more than a quantum.
        prop_assert!(!(lags && quanta > 6.0), "{quanta} quanta teach");
    }
}
