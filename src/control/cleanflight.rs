//! Cleanflight's laws: level mode, floating-point rate PID, altitude and GPS hold.
//!
//! After Cleanflight 1.13 (`src/main/flight/pid_luxfloat.c`, `altitudehold.c`, `navigation.c`)
//! with the gains of its `P_f`, `I_f`, `D_f`, written anew for measured time. How the gains of
//! `config/logics/cleanflight.toml` follow from the original's:
//!
//! - Motors take pulses of 1000 to 2000 us and the PID gives us, so 1000 us are full authority.
//!   `P_f` is in us per deg/s: times 180/pi/1000 for a share per rad/s (1.5 is 0.0859). `I_f` is
//!   multiplied by 10 and by degrees turned (0.4 is 0.229 per rad), `D_f` by deg/s2 (0.03 is
//!   0.00172).
//! - Level mode's `A_level` is deg/s per degree of error, the same in radians. Heading hold gives
//!   40/30 us of yaw stick per degree, which at the default rate is 0.27 deg/s.
//! - A full yaw stick is 500 us and 100 deg/s: what the stick adds to yaw's limit of 200 us is
//!   0.286 of full authority per rad/s.
//! - Altitude: `ALT` P 50/128 1/s. `VEL` P 120/32 us per cm/s; I 45/8192 us per cm/s, added 40
//!   times a second; D 1/512 us per count of the accelerometer, which has 4096 to 1 g and is added
//!   twice.
//! - GPS hold: `POS` P 15/100 1/s. `POSR` P 34/10, I 14/100, D 53/1000, hundredths of a degree per
//!   cm/s. Its lean may change by 0.3 degrees per loop, 3.5 ms then.
//!
//! Its filters at a fixed rate: the rates and their derivative are filtered in the arrival stage,
//! yaw's P with them, so the one pole at 80 Hz behind yaw's P has no counterpart; that of the
//! vertical acceleration is exact for the measured time; that of GPS hold's D (20 Hz, at 5 Hz of
//! places) passes everything and is left out, as is the averaging of places, which come
//! filtered. Left out too: sticks and their curves, horizon mode, waypoints, and throttle
//! correction by tilt (0 by default).

mod aim;
mod climb;
mod hold;
mod lean;
mod level;
mod rate;

pub use aim::{Aim, aimed};
pub use climb::{Climb, climbing};
pub use hold::{Hold, Sight, held};
pub use lean::Lean;
pub use level::level;
pub use rate::{RateIntegrals, Stretch, demand, integrated};

/// `x` brought nearer to zero by `width`, and zero within it.
fn beyond(x: f32, width: f32) -> f32 {
    x - crate::math::limited(x, width)
}
