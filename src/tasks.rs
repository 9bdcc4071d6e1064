//! What a board does around the autopilot, over the traits of embedded-hal.
//!
//! A board stamps interrupts, moves bytes and calls the autopilot. What it does with those bytes,
//! when it repairs a chip and how it carries out an order is the same on every board, and is here.
//! `chips` and `imu` say what the tasks need of a chip; a module named by its part number gives it.

pub mod chips;
pub mod lsm303agr;
pub mod mpu6050;
