//! INT_STATUS and the INT pin against RM-MPU-6000A registers 55 to 58.

use super::super::registers::*;
use super::super::*;
use super::chip;
use crate::testing::*;

#[test]
fn data_ready_pulses_for_50_us_per_sample() {
    let mut chip = chip(lively(), exact());
    assert_eq!(
        rising_edges(&mut chip, 5 * MS),
        [1, 2, 3, 4, 5].map(|n| n * MS)
    );
    assert!(chip.interrupt());
    assert_eq!(chip.next_event(), 5 * MS + 50_000);
    chip.advance(5 * MS + 49_999);
    assert!(chip.interrupt());
    chip.advance(5 * MS + 50_000);
    assert!(!chip.interrupt());
}

#[test]
fn a_latched_interrupt_holds_until_its_status_is_read() {
    let mut chip = chip(lively(), exact());
    write_i2c(&mut chip, 0, &[(INT_PIN_CFG, 0x20)]);
    chip.advance(1500 * 1000);
    assert!(chip.interrupt());
    read_i2c(&mut chip, 1500 * 1000, ACCEL_XOUT_H, 14);
    assert!(chip.interrupt(), "data reads do not clear it");
    assert_eq!(
        read_i2c(&mut chip, 1500 * 1000, INT_STATUS, 1),
        [DATA_READY]
    );
    assert!(!chip.interrupt());
    assert_eq!(read_i2c(&mut chip, 1500 * 1000, INT_STATUS, 1), [0]);
}

#[test]
fn any_read_clears_the_interrupt_when_told_so() {
    let mut chip = chip(lively(), exact());
    write_i2c(&mut chip, 0, &[(INT_PIN_CFG, 0x30)]);
    chip.advance(MS);
    assert!(chip.interrupt());
    read_i2c(&mut chip, MS, WHO_AM_I, 1);
    assert!(!chip.interrupt());
}

#[test]
fn the_pin_can_be_active_low_and_keeps_its_drive_bit() {
    let mut chip = chip(lively(), exact());
    write_i2c(&mut chip, 0, &[(INT_PIN_CFG, 0xC0)]);
    assert!(chip.interrupt());
    chip.advance(MS);
    assert!(!chip.interrupt());
    assert_eq!(read_i2c(&mut chip, MS, INT_PIN_CFG, 1), [0xC0]);
}

#[test]
fn without_its_enable_bit_data_ready_is_silent() {
    let mut chip = chip(lively(), exact());
    write_i2c(&mut chip, 0, &[(INT_ENABLE, 0)]);
    assert_eq!(chip.next_event(), u64::MAX);
    chip.advance(10 * MS);
    assert_eq!(chip.samples(), 10);
    assert!(!chip.interrupt());
    assert_eq!(read_i2c(&mut chip, 10 * MS, INT_STATUS, 1), [0]);
}
