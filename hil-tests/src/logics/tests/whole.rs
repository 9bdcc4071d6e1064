//! Steps that set every input: as a flight holds them, or each another than before.

use reflex::control::Goal;
use reflex::estimate::Place;
use reflex::math::Vec3;
use reflex::units::{BodyRates, Position, Velocity};
use reflex_bench::step::Step;

/// A change that no sum rounds away, in rad, rad/s and rad/s2.
const NUDGE: f32 = 1.0 / 64.0;
/// Time between two places, s.
const PLACE_DT: f32 = 0.02;

/// Every input as last set, from the first run on at which all of them are known.
pub fn held(steps: &[Step]) -> Vec<Step> {
    let mut whole = Step {
        goal: Some(None),
        place: Some(Place::default()),
        ..Step::default()
    };
    let steps = steps.iter().map(|step| {
        whole = step.over(&whole);
        whole
    });
    steps.filter(Step::is_whole).collect()
}

/// The same flight with every input another than at the run before.
///
/// Odd runs are blind, nudge rotation and setpoint, and have no heading or another one; goals
/// come and go in turns of three. The place moves about the origin.
pub fn changing(held: &[Step]) -> Vec<Step> {
    let steps = held.iter().enumerate();
    steps.map(|(run, step)| changed(run, step)).collect()
}

fn changed(run: usize, held: &Step) -> Step {
    let odd = run % 2 == 1;
    let nudge = if odd { NUDGE } else { 0.0 };
    let mut step = *held;
    if let Some(rotation) = &mut step.rotation {
        rotation.acceleration.x += nudge;
        rotation.rates.0.y += nudge;
    }
    if let Some(setpoint) = &mut step.setpoint {
        setpoint.rates = BodyRates(setpoint.rates.0 + Vec3::new(0.0, 0.0, nudge));
    }
    if odd {
        let heading = held
            .heading
            .flatten()
            .map_or(NUDGE, |heading| heading + NUDGE);
        step.heading = Some(Some(heading));
    }
    step.blind = Some(odd);
    step.goal = Some(goal(run));
    step.place = Some(place(run));
    step
}

/// None, one place, another place.
fn goal(run: usize) -> Option<Goal> {
    let side = match run % 3 {
        0 => return None,
        1 => 1.0,
        _ => -1.0,
    };
    Some(Goal {
        position: Position(Vec3::new(side, 0.5, 0.25 * side)),
        velocity: Velocity(Vec3::new(0.0, 0.1 * side, 0.0)),
        heading: 0.1 * side,
    })
}

/// About the origin, at its own pace along each axis.
fn place(run: usize) -> Place {
    let swings = |period: usize| 2.0 * (run % period) as f32 / period as f32 - 1.0;
    Place {
        position: Position(Vec3::new(swings(61), swings(127), 0.5 * swings(251))),
        velocity: Velocity(Vec3::new(swings(31), swings(53), 0.5 * swings(97))),
        dt: PLACE_DT,
    }
}

/// Whether every input is set and, where a graph compares it, another than before.
pub fn all_change(before: &Step, step: &Step) -> bool {
    step.is_whole()
        && step.rotation != before.rotation
        && step.heading != before.heading
        && step.setpoint != before.setpoint
        && step.goal != before.goal
        && step.blind != before.blind
}
