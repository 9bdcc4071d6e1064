//! The SPI enable bit stays set, whatever the crate `lsm303agr` writes.

mod common;

use common::{FailingBus, on_bus, reads, writes};
use embedded_hal::spi::{ErrorKind, Operation, SpiDevice};
use embedded_hal_mock::eh1::{delay::NoopDelay, spi::Transaction};
use lsm303agr::{AccelMode, AccelOutputDataRate, AccelScale, Lsm303agr};
use reflex_drivers::lsm303agr::{Accelerometer, ThreeWire};

#[test]
fn enabling_writes_the_bit_before_anything_is_read() {
    on_bus(&[writes(&[0x23, 0x01])], |bus| {
        ThreeWire::enable(bus).unwrap();
    });
    assert_eq!(
        ThreeWire::enable(FailingBus { remaining: 0 }).unwrap_err(),
        ErrorKind::Overrun
    );
}

#[test]
fn the_crate_runs_through_the_wrapper_and_every_write_to_ctrl_reg4_has_the_bit() {
    let accel = [
        writes(&[0x23, 0x01]),
        reads(0x8F, &[0x33]),
        writes(&[0x23, 0x81]),
        writes(&[0x1F, 0xC0]),
        writes(&[0x20, 0x57]),
        writes(&[0x23, 0x89]),
        writes(&[0x23, 0x99]),
        reads(0x8F, &[0x33]),
    ];
    let mag = [writes(&[0x62, 0x10])];
    on_bus(&accel, |accel_bus| {
        on_bus(&mag, |mag_bus| {
            let accel_bus = ThreeWire::enable(accel_bus).unwrap();
            let mut chip = Lsm303agr::new_with_spi(accel_bus, mag_bus);
            assert!(chip.accelerometer_id().unwrap().is_correct());
            chip.init().unwrap();
            let (mode, rate) = (AccelMode::HighResolution, AccelOutputDataRate::Hz100);
            chip.set_accel_mode_and_odr(&mut NoopDelay::new(), mode, rate)
                .unwrap();
            chip.set_accel_scale(AccelScale::G4).unwrap();
            let (accel_bus, _) = chip.destroy();
            Accelerometer::new(accel_bus).check_identity().unwrap();
        });
    });
}

#[test]
fn bursts_that_cross_the_register_are_recognised_and_others_pass_unchanged() {
    let frames = [
        writes(&[0x23, 0x01]),
        writes(&[0x60, 0x57, 0x31, 0x40, 0x81]), // 0x20..0x23: the last byte lands in 0x23
        writes(&[0x63, 0x81, 0x08]),             // 0x23, 0x24
        writes(&[0x64, 0x00, 0x00]),             // starts behind it
        writes(&[0x60, 0x57, 0x31, 0x40]),       // ends before it
        writes(&[0x20, 0x57, 0x00, 0x00, 0x00]), // address does not increment
        writes(&[0x23]),
        writes(&[]),
        writes(&[0x60, 0, 0, 0, 0, 0, 0, 0, 0]), // longer than the wrapper looks into
    ];
    on_bus(&frames, |bus| {
        let mut bus = ThreeWire::enable(bus).unwrap();
        bus.write(&[0x60, 0x57, 0x31, 0x40, 0x80]).unwrap();
        bus.write(&[0x63, 0x80, 0x08]).unwrap();
        bus.write(&[0x64, 0x00, 0x00]).unwrap();
        bus.write(&[0x60, 0x57, 0x31, 0x40]).unwrap();
        bus.write(&[0x20, 0x57, 0x00, 0x00, 0x00]).unwrap();
        bus.write(&[0x23]).unwrap();
        bus.write(&[]).unwrap();
        bus.write(&[0x60, 0, 0, 0, 0, 0, 0, 0, 0]).unwrap();
    });
}

#[test]
fn transfers_write_the_bit_and_reads_of_the_register_are_left_alone() {
    let frames = [
        writes(&[0x23, 0x01]),
        vec![
            Transaction::transaction_start(),
            Transaction::transfer_in_place(vec![0x23, 0x81], vec![0, 0]),
            Transaction::transaction_end(),
        ],
        reads(0xA3, &[0x81]),
        vec![
            Transaction::transaction_start(),
            Transaction::write_vec(vec![0xA3]),
            Transaction::read_vec(vec![0x81]),
            Transaction::transaction_end(),
        ],
    ];
    on_bus(&frames, |bus| {
        let mut bus = ThreeWire::enable(bus).unwrap();
        bus.transfer_in_place(&mut [0x23, 0x80]).unwrap();
        let mut read = [0xA3, 0x00];
        bus.transfer_in_place(&mut read).unwrap();
        assert_eq!(read, [0x00, 0x81]);
        let mut value = [0];
        bus.transaction(&mut [Operation::Write(&[0xA3]), Operation::Read(&mut value)])
            .unwrap();
        assert_eq!(value, [0x81]);
    });
}
