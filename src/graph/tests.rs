//! What the tests of every page share.

mod body;

pub use body::{Body, HOVER};

use super::ControlLogic;
use crate::control::Setpoint;
use crate::estimate::{Increment, Motion, Rotation};
use crate::math::Vec3;
use crate::sensors::GRAVITY;
use crate::units::{BodyRates, Thrust};

/// A graph that has flown level for a run.
pub fn settled<L: ControlLogic + Default>() -> L {
    let mut graph = L::default();
    graph.fly(Setpoint::level(Thrust::new(0.5).expect("in range")));
    graph.run();
    graph
}

/// A millisecond of turning about the roll axis at this rate (rad/s), otherwise at rest.
pub fn turning(rate: f32) -> Motion {
    let dt = 0.001;
    Motion {
        sums: Increment {
            angle: Vec3::new(rate * dt, 0.0, 0.0),
            swept: Vec3::new(0.5 * rate * dt * dt, 0.0, 0.0),
            velocity: Vec3::new(0.0, 0.0, -GRAVITY * dt),
            down: Vec3::new(0.0, 0.0, dt),
            dt,
            ..Increment::default()
        },
        rotation: Rotation {
            rates: BodyRates(Vec3::new(rate, 0.0, 0.0)),
            acceleration: Vec3::ZERO,
        },
    }
}

/// The values that a run changes, inputs first.
pub fn visited<L: ControlLogic>(graph: &mut L) -> String {
    let dirty = graph.run();
    let names: Vec<&str> = graph
        .description()
        .values
        .iter()
        .filter(|value| dirty.any(value.mark))
        .map(|value| value.name)
        .collect();
    names.join(" ")
}
