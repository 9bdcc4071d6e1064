//! Made-up steps for control logics: everything changes, then one input alone.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use reflex::control::{Goal, Setpoint, Yaw};
use reflex::estimate::{Increment, Place, Rotation};
use reflex::math::{Quaternion, Vec3};
use reflex::sensors::GRAVITY;
use reflex::units::{BodyRates, Position, Thrust, Velocity};
use reflex_bench::STEPS;
use reflex_bench::step::Step;

/// Inputs by name, in the order in which they change alone.
pub(super) const INPUTS: [&str; 7] = [
    "motion", "rotation", "heading", "setpoint", "goal", "place", "blind",
];

/// A step and what it is for.
pub(super) struct Case {
    /// The input that changes alone; `None` where all do.
    pub(super) alone: Option<&'static str>,
    pub(super) step: Step,
}

/// Rounds of a step with everything, and one for each input.
pub(super) fn cases() -> Vec<Case> {
    let mut random = Lively(ChaCha8Rng::seed_from_u64(1));
    let rounds = STEPS / (1 + INPUTS.len());
    let cases = (0..rounds).flat_map(|_| {
        // Alone it goes blind; the next step with everything lets it see again.
        let all = Case {
            alone: None,
            step: random.step(false),
        };
        let changed = random.step(true);
        let alone = INPUTS.map(|input| Case {
            alone: Some(input),
            step: only(input, &changed),
        });
        [all].into_iter().chain(alone)
    });
    cases.collect()
}

/// The part of a step that sets this input.
fn only(input: &str, step: &Step) -> Step {
    let mut only = Step::default();
    match input {
        "motion" => only.motion = step.motion,
        "rotation" => only.rotation = step.rotation,
        "heading" => only.heading = step.heading,
        "setpoint" => only.setpoint = step.setpoint,
        "goal" => only.goal = step.goal,
        "place" => only.place = step.place,
        _ => only.blind = step.blind,
    }
    only
}

/// A lively flight.
struct Lively(ChaCha8Rng);

impl Lively {
    fn around(&mut self, middle: f32, by: f32) -> f32 {
        let unit = (self.0.next_u32() >> 8) as f32 / (1u32 << 24) as f32;
        middle + by * (2.0 * unit - 1.0)
    }

    fn axes(&mut self, by: f32) -> Vec3 {
        Vec3::new(
            self.around(0.0, by),
            self.around(0.0, by),
            self.around(0.0, by),
        )
    }

    fn step(&mut self, blind: bool) -> Step {
        let dt = self.around(0.01, 0.009);
        let angle = self.axes(1.0) * dt;
        let level = Vec3::new(0.0, 0.0, 1.0);
        let lean = self.axes(0.2);
        Step {
            motion: Some(Increment {
                angle,
                coning: self.axes(0.001) * dt,
                swept: angle * (0.5 * dt),
                velocity: (self.axes(1.0) - level * GRAVITY) * dt,
                down: (level + self.axes(0.05)) * dt,
                dt,
            }),
            rotation: Some(Rotation {
                rates: BodyRates(self.axes(1.0)),
                acceleration: self.axes(10.0),
            }),
            heading: Some(Some(self.around(0.0, 0.1))),
            setpoint: Some(Setpoint {
                attitude: Some(Quaternion::IDENTITY.turned_by(lean)),
                rates: BodyRates::default(),
                yaw: Yaw::Heading,
                thrust: Thrust::new(self.around(0.5, 0.1)).unwrap_or_default(),
            }),
            goal: Some(Some(Goal {
                position: Position(self.axes(2.0)),
                velocity: Velocity(self.axes(0.1)),
                heading: self.around(0.0, 0.5),
            })),
            place: Some(Place {
                position: Position(self.axes(2.0)),
                velocity: Velocity(self.axes(0.5)),
                dt: 0.02,
            }),
            blind: Some(blind),
        }
    }
}
