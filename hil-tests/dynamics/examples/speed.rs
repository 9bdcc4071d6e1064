//! Flies a quad for some simulated seconds, to be timed from outside.
//!
//! `time cargo run --release --example speed -- 1000` divided by the steps it prints.

#[path = "../tests/suite/vehicles.rs"]
#[allow(dead_code)]
mod vehicles;

use flight_dynamics::{Drone, Environment, Gusts, State, Wind};
use nalgebra::Vector3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seconds: f64 = std::env::args()
        .nth(1)
        .as_deref()
        .unwrap_or("100")
        .parse()?;
    let mut environment = Environment::calm();
    environment.wind.mean = Vector3::new(3.0, 2.0, 0.0);
    environment.wind.speed_at_20_ft = 6.0;
    environment.wind.gusts = Some(Gusts {
        mean_interval: 10.0,
        amplitude: 3.0,
        length: 10.0,
    });
    let vehicle = vehicles::quad();
    let hover = vehicles::hover(&vehicle);
    let (mut steps, mut force) = (0_u64, 0.0);
    let mut wind = Wind::new(&environment, 1)?;
    while (steps as f64) < seconds * 1000.0 {
        let mut drone = Drone::in_state(&vehicle, State::at_height(500.0), &environment)?;
        for _ in 0..1000 {
            drone.advance(1e-3, &[hover; 4], wind.advance(1e-3))?;
            force += drone.readings().specific_force.z;
            steps += 1;
        }
    }
    println!(
        "{steps} steps of 1 ms, mean specific force {}",
        force / steps as f64
    );
    Ok(())
}
