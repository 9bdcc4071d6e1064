//! Register layer for what the crates `lsm303agr` and `mpu6050` lack.
//!
//! Those crates wake the chips and set rates, ranges and modes. Reactive control also needs the
//! comparators inside the chips: thresholds computed in SI units, written, read back and checked,
//! re-armed at every control run. That is here, over the traits of embedded-hal 1.0.
//!
//! A driver takes its bus by value: a handle to a shared one, or a loan (`&mut`). Nothing sleeps
//! and nothing loops without a bound, so a call costs what its bytes cost on the bus.
//!
//! | module | for |
//! |---|---|
//! | [`lsm303agr`] | threshold interrupts, re-arming, offsets and read-back of both halves |
//! | [`mpu6050`] | whole configuration with read-back, motion detector, 15-byte burst |
//! | [`orders`] | orders to chips that compare, and their answers |
//! | [`bus_recovery`] | a hung I2C bus: up to nine clocks, each ended by STOP |
//! | [`legacy_hal`] | lends an embedded-hal 1.0 bus to a crate that speaks 0.2 |
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing
    )
)]

pub mod bus_recovery;
pub mod error;
pub mod legacy_hal;
pub mod lsm303agr;
pub mod mpu6050;
pub mod orders;
pub mod quantity;
mod registers;
pub mod threshold;

pub use error::{Chip, Error};
