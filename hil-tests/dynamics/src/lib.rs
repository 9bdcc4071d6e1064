//! Flight dynamics of a multirotor: rigid body, rotors, battery, ground, wind.
//!
//! The plant of closed-loop flights. It knows nothing of the firmware: shares of full throttle
//! go in, what perfect sensors would read comes out. Noise, bandwidth and registers of the real
//! chips are modelled elsewhere.
//!
//! **Frames**: earth is north, east, down with the ground at zero; body is forward, right, down
//! with its origin in the centre of mass; the attitude turns body vectors into earth vectors.
//! **Units**: SI, radians; magnetic fields in gauss, instants in nanoseconds since the start.
//!
//! **Same input, same bits**: no clock is read, chance comes from the seed of [`Wind`] alone,
//! and a step allocates nothing. A number that is not finite ends the flight as [`Diverged`].
//!
//! ```
//! # use std::error::Error;
//! # use flight_dynamics::{Drone, Environment, Start, Vehicle, Wind};
//! fn hop(vehicle: &Vehicle, environment: &Environment) -> Result<f64, Box<dyn Error>> {
//!     let mut wind = Wind::new(environment, 7)?;
//!     let mut drone = Drone::new(vehicle, Start::default(), environment)?;
//!     for _ in 0..1000 {
//!         let air = wind.advance(0.001);
//!         drone.advance(0.001, &[0.7; 4], air)?;
//!     }
//!     Ok(drone.height())
//! }
//! ```
//!
//! **Not modelled**: ground effect, vortex ring state and inflow, blade flapping, wake of one
//! rotor on another but for a constant factor, flexing of the frame, regenerative
//! braking, temperature, sensors away from the centre of mass.

mod battery;
mod drone;
mod environment;
mod faults;
mod frame;
mod ground;
mod motion;
mod range;
mod state;
mod vehicle;
mod wind;

pub use battery::Battery;
pub use drone::{Drone, Readings, Start};
pub use environment::{Environment, Gusts, Shelter, WindClimate};
pub use faults::{Crash, Diverged, Divergence};
pub use range::Unfit;
pub use state::State;
pub use vehicle::{
    Biases, Drag, Esc, MAX_MOTORS, Motor, Propulsion, STANDARD_GRAVITY, Skids, Spin, Vehicle,
    Vibration,
};
pub use wind::Wind;
