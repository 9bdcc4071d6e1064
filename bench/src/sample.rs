//! What is done with a sample, run or no run.

use core::hint::black_box;

use oorandom::Rand32;
use reflex::airframe::MotorShares;
use reflex::config::{GEOMETRY, of_input};
use reflex::control::Setpoint;
use reflex::estimate::Arrival;
use reflex::graph::{ControlLogic, Flown};
use reflex::math::Vec3;
use reflex::reactive::{
    Column, Commanded, Feature, Held, Label, Labels, Lead, Prediction, Rule, ShadowHolds, axes_of,
};
use reflex::sensors::{GRAVITY, ImuSample, Input};
use reflex::settings::{Pairs, Reference};
use reflex::time::{at_micros, micros};
use reflex::units::{BodyRates, SpecificForce, Thrust};
use reflex_bench::marks::{measured, rounds};
use reflex_bench::{ANCHOR, ARRIVAL, FADE, FORESEE, HOLDS, LABEL, PREDICT, RUN};

/// Corner of the angular acceleration's filter, in Hz.
const CUTOFF: f32 = 20.0;

pub fn measure() {
    arrival();
    predictions();
    runs();
    holds();
    labels();
}

/// Samples of a lively flight at 1 kHz.
struct Samples(Rand32);

impl Samples {
    fn new() -> Self {
        Self(Rand32::new(1))
    }

    fn around(&mut self, middle: f32, by: f32) -> f32 {
        middle + by * (2.0 * self.0.rand_float() - 1.0)
    }

    fn axes(&mut self, by: f32) -> Vec3 {
        Vec3::new(
            self.around(0.0, by),
            self.around(0.0, by),
            self.around(0.0, by),
        )
    }

    fn next(&mut self, round: usize) -> ImuSample {
        ImuSample {
            at: at_micros(1000 * round as u64),
            rates: BodyRates(self.axes(2.0)),
            force: SpecificForce(self.axes(1.0) - Vec3::new(0.0, 0.0, GRAVITY)),
        }
    }
}

fn arrival() {
    let (mut arrival, mut samples) = (Arrival::default(), Samples::new());
    assert!(arrival.take(&samples.next(0), CUTOFF));
    rounds(ARRIVAL, |round| {
        let sample = samples.next(round + 1);
        let (arrival, sample) = black_box((&mut arrival, &sample));
        assert!(measured(|| arrival.take(sample, CUTOFF)));
    });
}

/// A prediction of the command, whatever its slopes, after each of some samples; then after runs.
fn predictions() {
    let (mut arrival, mut samples) = (Arrival::default(), Samples::new());
    let mut graph = Flown::default();
    graph.fly(Setpoint::level(Thrust::new(0.5).unwrap_or(Thrust::ZERO)));
    graph.run();
    let axes = axes_of(graph.mixer());
    let mut prediction = Prediction::new(axes, graph.mixer().motors(), CUTOFF);
    for &feature in &Feature::ALL {
        let of_axes = [0.0; 4].map(|zero| samples.around(zero, 0.01));
        assert!(prediction.on_column(&Column { feature, of_axes }));
    }
    let command = *graph.mixed();
    assert!(prediction.on_run(&command, &command.shares, &arrival.motion()));
    assert!(arrival.take(&samples.next(0), CUTOFF));
    rounds(PREDICT, |round| {
        assert!(arrival.take(&samples.next(round + 1), CUTOFF));
        let (prediction, motion) = (&mut prediction, arrival.motion());
        let (prediction, motion) = black_box((prediction, &motion));
        measured(|| *prediction.predict(motion));
    });
    rounds(ANCHOR, |round| {
        let sample = samples.next(PREDICT.rounds + round + 1);
        assert!(arrival.take(&sample, CUTOFF));
        let motion = arrival.take_motion();
        let (prediction, motion) = black_box((&mut prediction, &motion));
        measured(|| prediction.on_run(&command, &command.shares, motion));
    });
}

fn runs() {
    let (mut arrival, mut samples) = (Arrival::default(), Samples::new());
    let mut graph = Flown::default();
    let thrust = Thrust::new(0.5).unwrap_or(Thrust::ZERO);
    graph.fly(Setpoint::level(thrust));
    graph.run();
    assert!(arrival.take(&samples.next(0), CUTOFF));
    rounds(FORESEE, |round| {
        let sample = samples.next(round + 1);
        assert!(arrival.take(&sample, CUTOFF));
        let motion = arrival.motion();
        let (graph, motion) = black_box((&mut graph, &motion));
        measured(|| {
            graph.take(motion, Some(0.01));
            graph.foresee()
        });
    });
    arrival.take_motion();
    rounds(RUN, |round| {
        let sample = samples.next(FORESEE.rounds + round + 1);
        assert!(arrival.take(&sample, CUTOFF));
        let motion = arrival.take_motion();
        let (graph, motion) = black_box((&mut graph, &motion));
        measured(|| {
            graph.take(motion, Some(0.01));
            graph.run()
        });
    });
}

fn holds() {
    let mut holds = ShadowHolds::new(&of_input(Input::Gyro).changes);
    let mut labels = Labels::new(&of_input(Input::Gyro).changes);
    let rule = Rule {
        reference: Reference::LastRun,
        pairs: Pairs::FirstCrossings,
        counts: 1.0 / 255.0,
        failsafe: micros(100_000),
    };
    let mut samples = Samples::new();
    rounds(HOLDS, |round| {
        let rates = samples.axes(2.0);
        let newest = Held {
            sample: rates,
            command: Commanded::Now(command(&mut samples)),
            rates,
        };
        let now = at_micros(1000 * round as u64);
        let (holds, newest, rule) = black_box((&mut holds, &newest, &rule));
        let (lead, labels) = black_box((&Lead::Command(0.018), &mut labels));
        measured(|| holds.take(now, newest, rule, lead, labels, |_| {}));
    });
}

fn labels() {
    let mut labels = Labels::new(&of_input(Input::Gyro).changes);
    let mut samples = Samples::new();
    rounds(LABEL, |round| {
        let label = label(&mut samples, round);
        let (labels, label) = black_box((&mut labels, &label));
        measured(|| labels.add(label));
    });
    rounds(FADE, |round| {
        let label = label(&mut samples, round);
        let (labels, label) = black_box((&mut labels, &label));
        measured(|| {
            labels.fade(black_box(0.975));
            labels.add(label);
        });
    });
}

fn label(samples: &mut Samples, round: usize) -> Label {
    Label {
        x: samples.around(2.0, 2.0),
        changed: round.is_multiple_of(3),
        weight: 1.0,
    }
}

fn command(samples: &mut Samples) -> MotorShares {
    let mut command = MotorShares::all(0.0, GEOMETRY.count());
    for share in command.iter_mut() {
        *share = samples.around(0.5, 0.01);
    }
    command
}
