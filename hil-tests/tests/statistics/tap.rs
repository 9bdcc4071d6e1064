//! Every label that the learners of a flight were given, tapped behind their backs.

use reflex::airframe::Mixer;
use reflex::app::{Autopilot, Call, Recorder, Stamped};
use reflex::config::{FORGETTING, REFIT_INTERVAL};
use reflex::graph::CONFIGURED;
use reflex::reactive::{Label, Labels, changes_of};
use reflex::sensors::Input;
use reflex::settings::{Settings, Start};
use reflex::time::Instant;

use super::maximum_likelihood::Sample;

/// What one input was given until now: every label by itself, and counted as it counts them.
#[derive(Clone, Debug)]
pub(super) struct Lessons {
    pub(super) input: Input,
    pub(super) binned: Labels,
    /// With the number of times that the firmware had forgotten when it came.
    raw: Vec<(Label, i32)>,
    faded: i32,
}

/// The share that is kept when a little is forgotten.
fn kept() -> f64 {
    1.0 - REFIT_INTERVAL.ticks() as f64 / FORGETTING.ticks() as f64
}

impl Lessons {
    fn new(input: Input, settings: &Settings) -> Self {
        Self {
            input,
            binned: Labels::new(&changes_of(input, settings)),
            raw: Vec::new(),
            faded: 0,
        }
    }

    /// The labels one by one, weighing what is left of them.
    pub(super) fn samples(&self) -> Vec<Sample> {
        let sample = |(label, faded): &(Label, i32)| Sample {
            x: f64::from(label.x),
            changed: label.changed,
            weight: f64::from(label.weight) * kept().powi(self.faded - faded),
        };
        self.raw.iter().map(sample).collect()
    }

    /// Unforgotten labels of the rarer class.
    pub(super) fn of_rarer_class(&self) -> usize {
        let changed = self.raw.iter().filter(|(label, _)| label.changed).count();
        changed.min(self.raw.len() - changed)
    }
}

/// Listens to an autopilot, and shows the lessons at each refit, before a little is forgotten.
struct Tap<F> {
    lessons: Vec<Lessons>,
    on_refit: F,
}

impl<F: FnMut(Instant, &Lessons)> Recorder for Tap<F> {
    fn record(&mut self, at: Instant, call: &Call) {
        let Call::Refit(refit) = call else {
            return;
        };
        let lessons = &mut self.lessons[refit.input as usize];
        (self.on_refit)(at, lessons);
        lessons.binned.fade(kept() as f32);
        lessons.faded += 1;
    }

    fn label(&mut self, input: Input, label: &Label) {
        let lessons = &mut self.lessons[input as usize];
        lessons.raw.push((*label, lessons.faded));
        lessons.binned.add(label);
    }
}

/// Makes the calls of a flight again, and shows each input's lessons at each of its refits.
pub(super) fn tap(
    calls: &[Stamped],
    settings: Settings,
    on_refit: impl FnMut(Instant, &Lessons),
) -> Vec<Lessons> {
    let lessons = Input::ALL.map(|input| Lessons::new(input, &settings));
    let tap = Tap {
        lessons: lessons.into(),
        on_refit,
    };
    let mut autopilot = Autopilot::new(
        &Start {
            settings,
            ..CONFIGURED
        },
        &Mixer::default(),
        tap,
    );
    for stamped in calls {
        stamped.call.replay(stamped.at, &mut autopilot);
    }
    autopilot.recorder().lessons.clone()
}
