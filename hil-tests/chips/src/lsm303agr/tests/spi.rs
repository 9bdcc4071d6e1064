//! Three-wire SPI as the master on this board sees it.

use super::super::accelerometer_registers as xl;
use super::super::magnetometer_registers as mg;
use super::super::*;
use crate::testing::*;
use crate::{Chip, OwnClock, SpiChip};

fn accel() -> Accelerometer {
    Accelerometer::new(lively(), exact())
}

fn mag() -> Magnetometer {
    Magnetometer::new(lively(), exact())
}

#[test]
fn before_spi_enable_the_accelerometer_returns_the_masters_own_bytes() {
    let mut chip = accel();
    let miso = spi(&mut chip, 0, &[0x80 | xl::WHO_AM_I_A, 0x00]);
    assert_eq!(miso, [0x80 | xl::WHO_AM_I_A, 0x00]);
    let miso = spi(&mut chip, 0, &[0x80 | xl::WHO_AM_I_A, 0xFF]);
    assert_eq!(miso[1], 0xFF);
}

#[test]
fn writes_reach_the_accelerometer_before_spi_enable() {
    let mut chip = accel();
    write_spi(&mut chip, 0, &[(xl::CTRL_REG1_A, 0x57)]);
    assert_eq!(chip.register(xl::CTRL_REG1_A), 0x57);
}

#[test]
fn after_spi_enable_the_accelerometer_answers() {
    let mut chip = accel();
    write_spi(&mut chip, 0, &[(xl::CTRL_REG4_A, 0x01)]);
    let miso = spi(&mut chip, 0, &[0x80 | xl::WHO_AM_I_A, 0x00]);
    assert_eq!(miso, [0x80 | xl::WHO_AM_I_A, 0x33]);
    write_spi(&mut chip, 0, &[(xl::CTRL_REG4_A, 0x00)]);
    assert_eq!(read_accel(&mut chip, 0, xl::WHO_AM_I_A, 1), [0xFF]);
}

#[test]
fn the_masters_data_is_mirrored_while_it_writes() {
    let mut chip = accel();
    write_spi(&mut chip, 0, &[(xl::CTRL_REG4_A, 0x01)]);
    let miso = spi(&mut chip, 0, &[xl::CTRL_REG2_A, 0xC1]);
    assert_eq!(miso, [xl::CTRL_REG2_A, 0xC1]);
}

#[test]
fn the_accelerometer_increments_its_address_only_on_request() {
    let mut chip = accel();
    write_spi(&mut chip, 0, &[(xl::CTRL_REG4_A, 0x01)]);
    spi(&mut chip, 0, &[0x40 | xl::INT1_THS_A, 11, 22]);
    assert_eq!(chip.register(xl::INT1_THS_A), 11);
    assert_eq!(chip.register(xl::INT1_DURATION_A), 22);
    spi(&mut chip, 0, &[xl::INT1_THS_A, 33, 44]);
    assert_eq!(chip.register(xl::INT1_THS_A), 44);
    let miso = spi(&mut chip, 0, &[0x80 | xl::INT1_THS_A, 0, 0]);
    assert_eq!(miso[1..], [44, 44]);
    let miso = spi(&mut chip, 0, &[0xC0 | xl::INT1_THS_A, 0, 0]);
    assert_eq!(miso[1..], [44, 22]);
}

#[test]
fn the_magnetometer_answers_from_the_start_and_always_increments() {
    let mut chip = mag();
    assert_eq!(read_mag(&mut chip, 0, mg::WHO_AM_I_M, 1), [0x40]);
    spi(&mut chip, 0, &[mg::OFFSET_X_REG_L_M, 1, 2, 3, 4, 5, 6]);
    assert_eq!(
        read_mag(&mut chip, 0, mg::OFFSET_X_REG_L_M, 6),
        [1, 2, 3, 4, 5, 6]
    );
}

#[test]
fn the_reserved_four_wire_bit_silences_the_magnetometer() {
    let mut chip = mag();
    write_spi(&mut chip, 0, &[(mg::CFG_REG_C_M, 0x04)]);
    assert_eq!(read_mag(&mut chip, 0, mg::WHO_AM_I_M, 1), [0xFF]);
}

#[test]
fn a_deselected_chip_ignores_the_bus() {
    let mut chip = mag();
    assert_eq!(chip.transfer(0, mg::CFG_REG_A_M), mg::CFG_REG_A_M);
    chip.transfer(0, 0x00);
    assert_eq!(chip.register(mg::CFG_REG_A_M), 0x03);
}

#[test]
fn deselecting_ends_a_transaction() {
    let mut chip = mag();
    chip.select(0);
    chip.transfer(0, mg::OFFSET_X_REG_L_M);
    chip.deselect(0);
    chip.select(0);
    assert_eq!(
        chip.transfer(0, 0x80 | mg::WHO_AM_I_M),
        0x80 | mg::WHO_AM_I_M
    );
    assert_eq!(chip.transfer(0, 0), 0x40);
    assert_eq!(chip.register(mg::OFFSET_X_REG_L_M), 0);
}

#[test]
fn a_brown_out_makes_the_accelerometer_mute_again() {
    let mut chip = accel();
    write_spi(
        &mut chip,
        0,
        &[(xl::CTRL_REG4_A, 0x01), (xl::CTRL_REG1_A, 0x57)],
    );
    chip.brown_out(10 * MS);
    assert_eq!(read_accel(&mut chip, 10 * MS, xl::WHO_AM_I_A, 1), [0xFF]);
    assert_eq!(chip.register(xl::CTRL_REG1_A), 0x07);
    assert_eq!(chip.next_event(), u64::MAX);
}
