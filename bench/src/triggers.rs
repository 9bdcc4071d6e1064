//! The tests that decide whether control runs.

use core::hint::black_box;

use reflex::airframe::MotorShares;
use reflex::config::GEOMETRY;
use reflex::math::Vec3;
use reflex::reactive::{Decision, Fit, Logistic, Rest, Sample, Watch};
use reflex::settings::Reference;
use reflex_bench::marks::{measured, rounds};
use reflex_bench::{AXES_ABOVE, AXES_BELOW, COMMAND_ABOVE, COMMAND_BELOW};

/// A model whose threshold is 0.1 at a probability of 0.5.
const MODEL: Fit = Fit::Model(Logistic { b1: -1.0, b2: 10.0 });

pub fn measure() {
    rounds(AXES_BELOW, |round| test(axes(round, 0.02), false));
    rounds(AXES_ABOVE, |round| test(axes(round, 0.5), true));
    rounds(COMMAND_BELOW, |round| test(command(round, 0.02), false));
    rounds(COMMAND_ABOVE, |round| test(command(round, 0.5), true));
}

/// Another axis changes most, in another direction, with each round.
fn axes(round: usize, size: f32) -> [Vec3; 2] {
    let change = |axis: usize| size * share(round, axis, 3);
    let before = Vec3::new(0.3, -0.2, 0.1);
    let after = before + Vec3::new(change(0), change(1), change(2));
    [before, after]
}

fn command(round: usize, size: f32) -> [MotorShares; 2] {
    let before = MotorShares::all(0.4, GEOMETRY.count());
    let mut after = before;
    for (motor, after) in after.iter_mut().enumerate() {
        *after += size * share(round, motor, GEOMETRY.count());
    }
    [before, after]
}

/// 1 for the one of `of` that changes most in a round, less for the others.
fn share(round: usize, place: usize, of: usize) -> f32 {
    let sign = if round >> place & 1 == 0 { 1.0 } else { -1.0 };
    let rank = (place + round) % of;
    sign * (1.0 - rank as f32 / of as f32)
}

fn test<S: Sample>([before, after]: [S; 2], calls: bool) {
    let mut watch = Watch::new(black_box(Reference::LastRun));
    let mut decision = Decision::new(0.5, Rest::Open);
    decision.set_fit(MODEL);
    decision.take(watch.take(&before));
    watch.on_run();
    let (watch, decision, after) = black_box((&mut watch, &mut decision, &after));
    let answer = measured(|| decision.take(watch.take(after)));
    assert!(answer == calls);
}
