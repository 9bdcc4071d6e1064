//! The ranges of single values, checked while a file is read.
//!
//! A function for each kind of value, to be named beside the field: the error then carries the
//! value's place in the file, and no value out of its range ever exists. NaN is in no range.

use serde::de::{Deserialize, Deserializer, Error};

macro_rules! ranges {
    ($($(#[$doc:meta])* $name:ident: $type:ty = |$value:ident| $inside:expr, $range:literal;)*) => {
        $(
            $(#[$doc])*
            pub(crate) fn $name<'de, D: Deserializer<'de>>(source: D) -> Result<$type, D::Error> {
                let $value = <$type>::deserialize(source)?;
                if $inside {
                    Ok($value)
                } else {
                    Err(D::Error::custom(format!(
                        concat!("{:?} is out of range, must be ", $range),
                        $value
                    )))
                }
            }
        )*
    };
}

ranges! {
    /// A probability of which neither end makes sense.
    probability: f64 = |x| x > 0.0 && x < 1.0, "above 0 and below 1";
    /// The share of exploration runs.
    exploration_share: f64 = |x| (0.0..=0.1).contains(&x), "0 to 0.1";
    /// A share of full scale or of a value, not zero.
    positive_share: f64 = |x| x > 0.0 && x <= 1.0, "above 0 and at most 1";
    /// How far one thing is above another, m.
    rise: f64 = |x| (-1.0..=1.0).contains(&x), "-1 to 1 m";
    /// A share of full scale or authority.
    share: f64 = |x| (0.0..=1.0).contains(&x), "0 to 1";
    /// The least command of an armed motor.
    armed_minimum: f64 = |x| (0.0..=0.3).contains(&x), "0 to 0.3";
    /// Steps in a full scale.
    steps: u32 = |x| (2..=65_535).contains(&x), "2 to 65535";
    /// A factor on one label.
    weight: f64 = |x| (1.0..=256.0).contains(&x), "1 to 256";
    /// Labels that a model needs.
    labels: u32 = |x| (1..=10_000).contains(&x), "1 to 10000";
    /// Control's rate in Hz.
    control_rate: f64 = |x| (1.0..=1000.0).contains(&x), "1 to 1000 Hz";
    /// How often control runs to learn, in Hz.
    warm_up_rate: f64 = |x| (10.0..=1000.0).contains(&x), "10 to 1000 Hz";
    /// A window in which runs are judged, in s.
    window: f64 = |x| (1.0..=60.0).contains(&x), "1 to 60 s";
    /// Runs that a share is judged by.
    fewest_runs: u32 = |x| (10..=10_000).contains(&x), "10 to 10000";
    /// Rates of setpoints in rad/s that are aerobatics.
    aerobatics: f64 = |x| x > 0.0 && x <= 40.0, "above 0 and at most 40 rad/s";
    /// The longest fallback, in s.
    longest_fallback: f64 = |x| (1.0..=600.0).contains(&x), "1 to 600 s";
    /// The longest time between runs, in s.
    failsafe: f64 = |x| x > 0.0 && x <= 1.0, "above 2 hyperperiods and at most 1 s";
    /// The longest warm-up, in s.
    longest_warm_up: f64 = |x| x > 0.0 && x <= 30.0, "above 0 and at most 30 s";
    /// A time that may be none, in s.
    warm_up: f64 = |x| (0.0..=30.0).contains(&x), "0 to 30 s";
    /// A time constant of learning, in s.
    forgetting: f64 = |x| (1.0..=3600.0).contains(&x), "1 to 3600 s";
    /// Time between refits, in s.
    refit_interval: f64 = |x| (0.05..=60.0).contains(&x), "0.05 to 60 s";
    /// A tenth of a second to ten, in s.
    short_time: f64 = |x| (0.1..=10.0).contains(&x), "0.1 to 10 s";
    /// An end of a sensor's bins, in the sensor's unit.
    change: f64 = |x| x > 0.0 && x <= 1000.0, "above 0 and at most 1000";
    /// An angle in rad that counts as a change.
    angle_quantum: f64 = |x| x > 0.0 && x <= 1.0, "above 0 and at most 1 rad";
    /// A rate in rad/s that counts as a change.
    rate_quantum: f64 = |x| x > 0.0 && x <= 10.0, "above 0 and at most 10 rad/s";
    /// A distance in m that counts as a change.
    position_quantum: f64 = |x| x > 0.0 && x <= 10.0, "above 0 and at most 10 m";
    /// The rates in Hz of the MPU6050 whose periods are whole milliseconds.
    imu_rate: u32 = |x| [1000, 500, 250, 200, 125, 100].contains(&x),
        "one of 1000 500 250 200 125 100 Hz";
    /// The rates in Hz of the LSM303AGR's accelerometer at full resolution.
    chip_accel_rate: u32 = |x| [400, 200, 100, 50, 25, 10].contains(&x),
        "one of 400 200 100 50 25 10 Hz";
    /// The rates in Hz of the LSM303AGR's magnetometer.
    chip_mag_rate: u32 = |x| [100, 50, 20, 10].contains(&x), "one of 100 50 20 10 Hz";
    /// The corner of a sample filter in Hz; its upper end depends on the sample rate.
    sample_cutoff: f64 = |x| (5.0..=450.0).contains(&x), "5 to 450 Hz";
    /// The gyro's deviation at rest in rad/s.
    still_gyro: f64 = |x| x > 0.0 && x <= 1.0, "above 0 and at most 1 rad/s";
    /// Bits per second of the link.
    baud: u32 = |x| [57_600, 115_200, 230_400, 460_800, 921_600].contains(&x),
        "one of 57600 115200 230400 460800 921600 baud";
    /// The mass of a drone in kg.
    mass: f64 = |x| (0.05..=100.0).contains(&x), "0.05 to 100 kg";
    /// Moments of inertia in kg m2.
    inertia: [f64; 3] = |x| x.iter().all(|x| (1e-6..=100.0).contains(x)),
        "0.000001 to 100 kg m2 each";
    /// A length of a drone in m.
    length: f64 = |x| (0.01..=5.0).contains(&x), "0.01 to 5 m";
    /// The thrust of a rotor in N.
    thrust: f64 = |x| (0.1..=1000.0).contains(&x), "0.1 to 1000 N";
    /// The speed of a rotor in rad/s.
    rotor_speed: f64 = |x| (50.0..=10_000.0).contains(&x), "50 to 10000 rad/s";
    /// How long a rotor takes to follow, in s.
    motor_lag: [f64; 2] = |x| x.iter().all(|x| (0.005..=1.0).contains(x)),
        "0.005 to 1 s each";
    /// Ideal power over electric power.
    merit: f64 = |x| (0.05..=1.0).contains(&x), "0.05 to 1";
    /// Drag along or about three axes.
    drag: [f64; 3] = |x| x.iter().all(|x| (0.0..=10.0).contains(x)), "0 to 10 each";
    /// Cells of a battery.
    cells: u32 = |x| (1..=24).contains(&x), "1 to 24";
    /// The charge of a battery in Ah.
    charge: f64 = |x| (0.1..=1000.0).contains(&x), "0.1 to 1000 Ah";
    /// The power of electronics in W.
    electronics: f64 = |x| (0.0..=1000.0).contains(&x), "0 to 1000 W";
    /// Vibration per thrust.
    vibration: f64 = |x| (0.0..=10.0).contains(&x), "0 to 10";
    /// The side of a square to fly in, in m.
    area: f64 = |x| (1.0..=1000.0).contains(&x), "1 to 1000 m";
    /// A magnetic field in gauss, to the north and down.
    field: [f64; 2] = |x| x[0] > 0.0 && x[0] <= 0.5 && (-0.7..=0.7).contains(&x[1]),
        "above 0 and at most 0.5 gauss to the north, -0.7 to 0.7 gauss down";
    /// A speed of wind in m/s.
    wind: f64 = |x| (0.0..=30.0).contains(&x), "0 to 30 m/s";
    /// A width or spread of directions in degrees.
    spread: f64 = |x| (0.0..=180.0).contains(&x), "0 to 180 degrees";
    /// A height above ground in m.
    height: f64 = |x| (1.0..=300.0).contains(&x), "1 to 300 m";
    /// Time between gusts in s.
    gust_interval: f64 = |x| (1.0..=3600.0).contains(&x), "1 to 3600 s";
    /// Reports of a place per second.
    tracking_rate: f64 = |x| (5.0..=50.0).contains(&x), "5 to 50 Hz";
    /// Noise of a reported place or velocity, in m or m/s.
    tracking_noise: f64 = |x| (0.0..=1.0).contains(&x), "0 to 1";
    /// A direction in degrees.
    direction: f64 = |x| (0.0..360.0).contains(&x), "0 to 360 degrees, 360 excluded";
}
