//! `logics/*.toml`: the gains of a control logic; lists are roll, pitch, yaw.

use serde::Deserialize;

use crate::range;

/// The content of `logics/cascade.toml`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cascade {
    /// The attitude estimate.
    pub estimate: Estimate,
    /// The attitude loop.
    pub attitude: Attitude,
    /// The rate loop.
    pub rate: Rate,
}

/// The attitude estimate.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Estimate {
    /// How fast the attitude follows the accelerometer, in 1/s, 0 to 10.
    #[serde(deserialize_with = "range::correction")]
    pub accel_correction: f64,
    /// How fast the heading follows the magnetometer, in 1/s, 0 to 10.
    #[serde(deserialize_with = "range::correction")]
    pub heading_correction: f64,
}

/// The attitude loop.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Attitude {
    /// Body rate asked for per radian of error, in 1/s, 0 to 30.
    #[serde(deserialize_with = "range::attitude_gains")]
    pub p: [f64; 3],
    /// Most that is asked for, in rad/s, within (0, 35].
    #[serde(deserialize_with = "range::rate_limits")]
    pub rate_limit_rad_s: [f64; 3],
}

/// The rate loop.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rate {
    /// Share of full authority per rad/s, 0 to 2.
    #[serde(deserialize_with = "range::proportional_gains")]
    pub p: [f64; 3],
    /// Share of full authority per rad, 0 to 5.
    #[serde(deserialize_with = "range::integral_gains")]
    pub i: [f64; 3],
    /// Share of full authority per rad/s2, 0 to 0.1.
    #[serde(deserialize_with = "range::derivative_gains")]
    pub d: [f64; 3],
    /// Corner of the derivative's filter in Hz, 1 to 200.
    #[serde(deserialize_with = "range::derivative_cutoff")]
    pub d_cutoff_hz: f64,
    /// Most that the integral holds, as a share of full authority.
    #[serde(deserialize_with = "range::share")]
    pub integral_limit: f64,
}
