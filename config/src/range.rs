//! The ranges of values that only simulations read, checked while a file is read.
//!
//! A function for each kind of value, to be named beside the field: the error then carries the
//! value's place in the file, and no value out of its range ever exists.

use reflex_settings::{
    ARMED_MINIMUM, DIRECTION, HARD_IRON, MOTOR_FIELD, Range, SOFT_IRON_DIAGONAL,
    SOFT_IRON_OFF_DIAGONAL, TURN_ON, WARMING, above, within,
};
use serde::de::{Deserialize, Deserializer, Error};

/// One number or several.
trait Numbers: Copy + std::fmt::Debug {
    /// What precedes the range in a refusal.
    const EACH: &str;

    fn all(self, inside: impl Fn(f64) -> bool) -> bool;
}

impl Numbers for f64 {
    const EACH: &str = "";

    fn all(self, inside: impl Fn(f64) -> bool) -> bool {
        inside(self)
    }
}

impl Numbers for u32 {
    const EACH: &str = "";

    fn all(self, inside: impl Fn(f64) -> bool) -> bool {
        inside(self.into())
    }
}

impl<const N: usize> Numbers for [f64; N] {
    const EACH: &str = "each ";

    fn all(self, inside: impl Fn(f64) -> bool) -> bool {
        self.iter().all(|&number| inside(number))
    }
}

fn checked<N: Numbers, E: Error>(numbers: N, range: Range, unit: &str) -> Result<N, E> {
    if numbers.all(|number| range.contains(number)) {
        return Ok(numbers);
    }
    let (each, unit) = (N::EACH, format!(" {unit}"));
    Err(E::custom(format!(
        "{numbers:?} is out of range, must be {each}{range}{}",
        unit.trim_end()
    )))
}

macro_rules! ranges {
    ($($(#[$doc:meta])* $name:ident: $type:ty = $range:expr, $unit:literal;)*) => {
        $(
            $(#[$doc])*
            pub(crate) fn $name<'de, D: Deserializer<'de>>(source: D) -> Result<$type, D::Error> {
                checked(<$type>::deserialize(source)?, $range, $unit)
            }
        )*
    };
}

ranges! {
    /// A share of full scale or of a value, not zero.
    positive_share: f64 = above(0.0, 1.0), "";
    /// How far one thing is above another.
    rise: f64 = within(-1.0, 1.0), "m";
    /// A share of full scale or authority.
    share: f64 = within(0.0, 1.0), "";
    /// The least command of an armed motor.
    armed_minimum: f64 = ARMED_MINIMUM, "";
    /// Steps in a full scale.
    steps: u32 = within(2.0, 65_535.0), "";
    /// A tenth of a second to ten.
    short_time: f64 = within(0.1, 10.0), "s";
    /// The mass of a drone.
    mass: f64 = within(0.05, 100.0), "kg";
    /// Moments of inertia.
    inertia: [f64; 3] = within(1e-6, 100.0), "kg m2";
    /// A length of a drone.
    length: f64 = within(0.01, 5.0), "m";
    /// The thrust of a rotor.
    thrust: f64 = within(0.1, 1000.0), "N";
    /// The speed of a rotor.
    rotor_speed: f64 = within(50.0, 10_000.0), "rad/s";
    /// How long a rotor takes to follow.
    motor_lag: [f64; 2] = within(0.005, 1.0), "s";
    /// The speed of a motor without load per voltage.
    velocity_constant: f64 = within(10.0, 20_000.0), "rpm/V";
    /// The resistance of a motor.
    winding: f64 = within(0.001, 10.0), "ohm";
    /// Ideal power over electric power.
    merit: f64 = within(0.05, 1.0), "";
    /// Drag along or about three axes.
    drag: [f64; 3] = within(0.0, 10.0), "";
    /// Cells of a battery.
    cells: u32 = within(1.0, 24.0), "";
    /// The charge of a battery.
    charge: f64 = within(0.1, 1000.0), "Ah";
    /// The power of electronics.
    electronics: f64 = within(0.0, 1000.0), "W";
    /// Vibration per thrust.
    vibration: f64 = within(0.0, 10.0), "";
    /// The side of a square to fly in.
    area: f64 = within(1.0, 1000.0), "m";
    /// A speed of wind.
    wind: f64 = within(0.0, 30.0), "m/s";
    /// A width or spread of directions.
    spread: f64 = within(0.0, 180.0), "degrees";
    /// A height above ground.
    height: f64 = within(1.0, 300.0), "m";
    /// Time between gusts.
    gust_interval: f64 = within(1.0, 3600.0), "s";
    /// Reports of a place per second.
    tracking_rate: f64 = within(5.0, 50.0), "Hz";
    /// How old a reported place is.
    tracking_delay: f64 = within(0.0, 0.5), "s";
    /// A slow error of a reported place.
    drift: f64 = within(0.0, 10.0), "m";
    /// How long such an error is remembered.
    drift_time: f64 = within(1.0, 3600.0), "s";
    /// Noise of a reported place or velocity, in m or m/s.
    tracking_noise: f64 = within(0.0, 1.0), "";
    /// What a gyroscope shows at rest.
    turn_on: f64 = TURN_ON, "deg/s";
    /// By how much a die warms up.
    warming: f64 = WARMING, "degrees Celsius";
    /// The field of magnets.
    hard_iron: [f64; 3] = HARD_IRON, "gauss";
    /// The diagonal of a matrix of soft iron.
    soft_iron_diagonal: [f64; 3] = SOFT_IRON_DIAGONAL, "";
    /// What is beside it.
    soft_iron_off_diagonal: [f64; 3] = SOFT_IRON_OFF_DIAGONAL, "";
    /// The field of motors for each ampere.
    motor_field: [f64; 3] = MOTOR_FIELD, "gauss for each A";
    /// A direction.
    direction: f64 = DIRECTION, "degrees";
}

/// A magnetic field, to the north and down.
pub(crate) fn field<'de, D: Deserializer<'de>>(source: D) -> Result<[f64; 2], D::Error> {
    let [north, down] = <[f64; 2]>::deserialize(source)?;
    Ok([
        checked(north, above(0.0, 0.5), "gauss to the north")?,
        checked(down, within(-0.7, 0.7), "gauss down")?,
    ])
}
