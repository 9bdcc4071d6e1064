//! Registers of the chips: addresses, and the names that errors spell.
//!
//! Below the drivers, as an error of any of them names its register.

/// Declares addresses and a function from an address to its name, `?` for any other.
macro_rules! registers {
    ($function:ident: $($(#[$doc:meta])* $name:ident = $address:literal,)*) => {
        $($(#[$doc])* pub const $name: u8 = $address;)*

        pub(crate) const fn $function(address: u8) -> &'static str {
            match address {
                $($address => stringify!($name),)*
                _ => "?",
            }
        }
    };
}

pub mod lsm303agr;
pub mod mpu6050;
