//! How long the firmware's tasks take, as measured on the emulated board.
//!
//! The native board runs no instruction of the firmware. What its tasks and buses take is put in
//! as constants, so that calls carry nearly the stamps they have on the target. They are rounded
//! from replays on the emulated board; a few microseconds move no result.

use reflex::time::{Instant, at_micros};

/// When the firmware's clock starts after reset, ns.
pub(super) const CLOCK_START_NS: u64 = 24_000;
/// When the LSM303AGR is set up, ns.
pub(super) const CHIPS_START_NS: u64 = 20_000;
/// When the write begins that wakes the MPU6050, ns. Its samples and their noise count from
/// there: at the right instant this tier sees the very counts that the emulated one sees.
pub(super) const IMU_WAKE_NS: u64 = 312_750;
/// When the MPU6050 has woken and is configured, ns.
pub(super) const IMU_START_NS: u64 = 100_990_000;
/// When start-up ends and interrupts are heard, ns.
pub(super) const BOOT_NS: u64 = 102_812_000;

/// From an interrupt of the MPU6050 to the START of its burst, ns.
pub(super) const BURST_START_NS: u64 = 500;
/// From an interrupt of the MPU6050 to the end of its burst at the soonest: 18 bytes at 400 kHz, ns.
pub(super) const SHORTEST_BURST_NS: u64 = 400_000;
/// Filtering, summing and comparing a burst, ns.
pub(super) const ARRIVAL_NS: u64 = 14_700;
/// A run, to the last motor register, ns.
pub(crate) const RUN_NS: u64 = 17_700;
/// From the end of a task, or an interrupt, to the next step of the LSM303AGR's owner, ns.
pub(super) const CHIPS_STEP_NS: u64 = 3_000;
/// From a sample to idle, where refits are looked for, and a refit itself, ns.
pub(super) const REFIT_NS: u64 = 200_000;
/// One character on the link at its rate: start bit, eight bits, stop bit, ns.
pub(super) const CHARACTER_NS: u64 = 10 * 1_000_000_000 / reflex::config::LINK_BAUD as u64;

/// The firmware's clock at an instant of virtual time.
pub(crate) fn clock(at_ns: u64) -> Instant {
    at_micros(at_ns.saturating_sub(CLOCK_START_NS) / 1000)
}

/// The virtual time at which the firmware's clock shows an instant.
pub(crate) fn nanos(at: Instant) -> u64 {
    at.ticks()
        .saturating_mul(1000)
        .saturating_add(CLOCK_START_NS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_and_virtual_time_lead_back_to_each_other() {
        assert_eq!(clock(nanos(at_micros(123_456))), at_micros(123_456));
        assert_eq!(clock(0), at_micros(0));
    }
}
