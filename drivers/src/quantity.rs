//! Physical quantities at this crate's boundary: one type each, never mixed.

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
        #[cfg_attr(target_os = "none", derive(defmt::Format))]
        pub struct $name(pub f32);
    };
}

quantity! {
    /// Specific force along one axis, in m/s2.
    MetersPerSecondSquared
}
quantity! {
    /// Angular rate about one axis, in rad/s.
    RadiansPerSecond
}
quantity! {
    /// Magnetic flux density along one axis, in gauss (100 microtesla).
    Gauss
}
quantity! {
    /// Temperature of a die, in degrees Celsius.
    Celsius
}
quantity! {
    /// Rate or corner frequency, in Hz.
    Hertz
}
quantity! {
    /// Span of time, in s.
    Seconds
}

/// Standard gravity in m/s2, by which datasheets' `g` are turned into SI.
pub const STANDARD_GRAVITY: f32 = 9.806_65;
