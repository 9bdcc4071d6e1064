//! What the drone shall do: an attitude or rates, and a thrust.

use crate::math::Quaternion;
use crate::units::{BodyRates, Thrust};

/// Which angle, if any, the yaw axis holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Yaw {
    /// Hold the heading of the attitude.
    Heading,
    /// Turn at the setpoint's yaw rate, whatever the heading.
    Rate,
}

/// The demand on the control logic.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Setpoint {
    /// Desired attitude; `None` where only rates are asked for.
    pub attitude: Option<Quaternion>,
    /// Desired body rates, added to what the attitude asks for; zero where not given.
    pub rates: BodyRates,
    /// What the yaw axis follows.
    pub yaw: Yaw,
    /// Collective thrust.
    pub thrust: Thrust,
}

impl Setpoint {
    /// Level, heading free, at a thrust: what remains when the peer falls silent.
    #[must_use]
    pub fn level(thrust: Thrust) -> Self {
        Self {
            attitude: Some(Quaternion::IDENTITY),
            rates: BodyRates::default(),
            yaw: Yaw::Rate,
            thrust,
        }
    }
}

impl Default for Setpoint {
    fn default() -> Self {
        Self::level(Thrust::ZERO)
    }
}
