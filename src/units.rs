//! Physical quantities at public boundaries: SI, body frame, one type each.
//!
//! The body frame is forward-right-down (FRD), the Earth frame north-east-down (NED). A type
//! holds three axes of one quantity; within a function its `Vec3` is used.

use crate::math::Vec3;

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[cfg_attr(target_os = "none", derive(defmt::Format))]
        pub struct $name(pub Vec3);

        impl $name {
            /// True where no axis is infinite or not a number.
            #[must_use]
            pub fn is_finite(self) -> bool {
                self.0.is_finite()
            }
        }
    };
}

quantity! {
    /// Angular rates of the body about its own axes, in rad/s.
    BodyRates
}
quantity! {
    /// Specific force along the body's axes, in m/s2: -9.8 along z at rest.
    SpecificForce
}
quantity! {
    /// Magnetic field along the body's axes, in gauss.
    MagneticField
}
quantity! {
    /// Torque demands about the body's axes, as a share of full authority.
    TorqueDemand
}
quantity! {
    /// Position in the local north-east-down frame, in metres.
    Position
}
quantity! {
    /// Velocity in the local north-east-down frame, in m/s.
    Velocity
}

/// Collective thrust as a share of all motors' full scale, 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Thrust(f32);

impl Thrust {
    /// No thrust.
    pub const ZERO: Self = Self(0.0);

    /// Thrust within 0 to 1; `None` where it is outside or not a number.
    #[must_use]
    pub fn new(share: f32) -> Option<Self> {
        (0.0..=1.0).contains(&share).then_some(Self(share))
    }

    /// The share of full scale, 0 to 1.
    #[must_use]
    pub fn share(self) -> f32 {
        self.0
    }
}
