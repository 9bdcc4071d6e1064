//! Predictions beside what each control logic computes.

use super::*;
use crate::airframe::Mixer;
use crate::config::SETTINGS;
use crate::control::Setpoint;
use crate::graph::tests::{Body, HOVER, settled};
use crate::graph::{ArduCopter, Cascade, Cleanflight, ControlLogic, Observer, OpenPilot};
use crate::math::{Quaternion, Vec3};
use crate::reactive::owed::{Budget, axes_of};
use crate::sensors::GRAVITY;
use crate::units::Thrust;

/// Samples between runs.
const HOLD: u32 = 15;

/// A drone in gusts, its control logic, and the prediction of that.
struct Flight<L> {
    logic: L,
    body: Body,
    prediction: Prediction,
    random: oorandom::Rand32,
}

impl<L: ControlLogic + Default + Clone> Flight<L> {
    fn new() -> Self {
        let mut logic: L = settled();
        logic.fly(Setpoint::level(Thrust::new(HOVER).expect("in range")));
        let cutoff = logic.derivative_cutoff();
        let mut flight = Self {
            logic,
            body: Body::new(Quaternion::default()),
            prediction: Prediction::new(axes_of(&Mixer::default()), 4, cutoff),
            random: oorandom::Rand32::new(3),
        };
        for _ in 0..400 {
            flight.body.hold(5, &flight.logic);
            flight.run();
        }
        flight
    }

    fn run(&mut self) -> bool {
        let motion = self.body.motion();
        self.body.run(&mut self.logic);
        let mixed = self.logic.mixed();
        self.prediction.on_run(mixed, &mixed.shares, &motion)
    }

    fn sound(&mut self, change: impl Fn(Column) -> Column) -> bool {
        let situation = Situation {
            rotation: self.body.motion().rotation,
            force: Vec3::new(0.0, 0.0, -GRAVITY),
            heading: None,
        };
        let axes = *self.prediction.axes();
        let sounding = Sounding::new(&self.logic, &axes, &situation);
        let mut columns = sounding.columns().map(change);
        columns.all(|column| self.prediction.on_column(&column))
    }

    fn gust(&mut self) {
        let mut turn = || 0.1 * (self.random.rand_float() - 0.5);
        self.body.push(Vec3::new(turn(), turn(), turn()));
    }

    /// Holds a command in gusts; what is owed by prediction, and exactly, at its end.
    fn hold(&mut self) -> (Impulse, Impulse) {
        let held = self.logic.mixed().shares;
        let (mut exact, mut last) = (Impulse::default(), 0.0);
        for _ in 0..HOLD {
            self.gust();
            self.body.hold(1, &self.logic);
            let motion = self.body.motion();
            let mut logic = self.logic.clone();
            logic.take(&motion, None);
            let off = self
                .prediction
                .axes()
                .between(&held, &logic.foresee().shares);
            exact = exact.grown(off, motion.sums.dt - last);
            last = motion.sums.dt;
            self.prediction.predict(&motion);
        }
        (*self.prediction.owed(), exact)
    }
}

/// Root mean squares of what predictions miss and of what is owed, over some holds.
fn missed_and_owed<L: ControlLogic + Default + Clone>() -> (f32, f32) {
    let mut flight = Flight::<L>::new();
    assert!(flight.prediction.is_exact(), "nothing is known yet");
    assert!(flight.sound(|column| column));
    let (mut missed, mut owed, mut predictions) = (0.0, 0.0, 0);
    for hold in 0..300 {
        flight.run();
        if hold % 16 == 0 {
            flight.sound(|column| column);
        }
        let predicts = !flight.prediction.is_exact();
        let (predicted, exact) = flight.hold();
        predictions += u16::from(predicts);
        if !predicts {
            continue;
        }
        for (predicted, exact) in predicted.0.into_iter().zip(exact.0) {
            missed += (predicted - exact) * (predicted - exact);
            owed += exact * exact;
        }
    }
    assert!(predictions > 250, "{predictions}");
    let mean = |squares: f32| (squares / f32::from(predictions)).sqrt();
    (mean(missed), mean(owed))
}

#[test]
fn what_is_owed_is_predicted_within_a_twentieth_whatever_the_logic() {
    let each = [
        ("cascade", missed_and_owed::<Cascade>()),
        ("arducopter", missed_and_owed::<ArduCopter>()),
        ("cleanflight", missed_and_owed::<Cleanflight>()),
        ("openpilot", missed_and_owed::<OpenPilot>()),
        ("observer", missed_and_owed::<Observer>()),
    ];
    for (logic, (missed, owed)) in each {
        assert!(owed > Budget::new(&SETTINGS).most, "{logic}: {owed}");
        assert!(missed < 0.05 * owed, "{logic}: {missed} of {owed}");
    }
}

#[test]
fn a_jump_of_the_setpoint_is_owed_from_then_on() {
    let mut flight = Flight::<Cascade>::new();
    flight.sound(|column| column);
    flight.run();
    let held = flight.logic.mixed().shares;
    flight.body.hold(5, &flight.logic);
    flight
        .logic
        .fly(Setpoint::level(Thrust::new(HOVER + 0.1).expect("in range")));
    flight.logic.run();
    let motion = flight.body.motion();
    flight.prediction.on_joined(flight.logic.mixed(), &motion);
    flight.body.hold(10, &flight.logic);
    let owed = *flight.prediction.predict(&flight.body.motion());
    let off = flight
        .prediction
        .axes()
        .between(&held, &flight.logic.mixed().shares);
    let exact = Impulse::default().grown(off, 0.01);
    assert!(
        (owed.0[3] - exact.0[3]).abs() < 0.02 * exact.0[3],
        "{owed:?} {exact:?}"
    );
}

#[test]
fn what_is_not_finite_is_refused_and_commands_foreseen_exactly() {
    let mut flight = Flight::<Cascade>::new();
    assert!(flight.sound(|column| column));
    flight.run();
    assert!(!flight.prediction.is_exact());
    let broken = |mut column: Column| {
        column.of_axes[2] = f32::INFINITY;
        column
    };
    assert!(!flight.sound(broken));
    flight.run();
    assert!(flight.prediction.is_exact());
}

#[test]
fn slopes_that_miss_twice_in_a_row_are_refuted() {
    let mut flight = Flight::<Cascade>::new();
    flight.sound(|mut column| {
        column.of_axes = column.of_axes.map(|slope| 100.0 * slope);
        column
    });
    assert!(flight.run());
    let mut sound = [true; 2];
    for sound in &mut sound {
        flight.hold();
        *sound = flight.run();
    }
    assert_eq!(sound, [true, false]);
    assert!(flight.prediction.is_exact());
}

#[test]
fn near_the_end_of_the_motors_range_commands_are_foreseen_exactly() {
    let mut flight = Flight::<Cascade>::new();
    flight.sound(|column| column);
    flight
        .logic
        .fly(Setpoint::level(Thrust::new(0.99).expect("in range")));
    flight.run();
    assert!(flight.prediction.is_exact());
}
