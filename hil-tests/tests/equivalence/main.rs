//! Thresholds in the chips against the comparison in software.
//!
//! The software asks at every sample: is the largest per-axis absolute
//! difference from the reference sample above the threshold? A chip that
//! compares by itself must answer alike. Here both see the same samples: the
//! software ([`reflex::reactive::Watch`], in units in which its arithmetic is
//! exact) reads what the chip model puts into its data registers, and the
//! decision of each sample is compared with the chip's interrupt. The chips are
//! configured and re-armed by the drivers that the firmware uses.
//!
//! What a chip may decide otherwise follows from its filter, in formulas that
//! know nothing of the model: see `accelerometer`, `magnetometer`, `motion`.
//! `measured.txt` holds how often it does (see `table`); `docs/chips.md` says
//! what follows.

mod accelerometer;
mod accelerometer_tests;
mod comparison;
mod magnetometer;
mod motion;
mod motion_tests;
mod ports;
mod rounding;
mod streams;
mod table;
