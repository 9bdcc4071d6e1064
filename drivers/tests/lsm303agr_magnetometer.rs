//! Magnetometer of the LSM303AGR: exact bytes of every operation, failures.

mod common;

use common::{FailingBus, checked, on_bus, reads, writes};
use embedded_hal::spi::ErrorKind;
use proptest::prelude::*;
use reflex_drivers::{
    Chip, Error,
    lsm303agr::{
        Axes, MagCompare, MagCounts, MagInterrupt, MagOffset, MagPin, MagThreshold, Magnetometer,
    },
};

const CHIP: Chip = Chip::Lsm303agrMagnetometer;

/// As the firmware uses it, threshold 0x0123 (436.5 milligauss).
fn flight_interrupt() -> MagInterrupt {
    MagInterrupt {
        compare: MagCompare::ChangeFromOffset,
        axes: Axes::ALL,
        threshold: MagThreshold::from_code(0x0123).unwrap(),
        latch: true,
        pin: MagPin::Threshold,
    }
}

#[test]
fn identity_is_read_from_0x4f_and_another_chip_is_refused() {
    on_bus(&[reads(0xCF, &[0x40])], |bus| {
        Magnetometer::new(bus).check_identity().unwrap()
    });
    on_bus(&[reads(0xCF, &[0x00])], |bus| {
        assert_eq!(
            Magnetometer::new(bus).check_identity(),
            Err(Error::WrongIdentity {
                chip: CHIP,
                expected: 0x40,
                found: 0x00
            })
        );
    });
}

#[test]
fn interrupt_keeps_the_bits_that_the_crate_set() {
    // Low-pass and offset cancellation in CFG_REG_B, block update in CFG_REG_C survive.
    let frames = [
        writes(&[0x65, 0x23, 0x01]),
        reads(0xE5, &[0x23, 0x01]),
        reads(0xE1, &[0x03]),
        checked(0x61, 0x0B),
        checked(0x63, 0xE7),
        reads(0xE4, &[0x81]),
        reads(0xE2, &[0x11]),
        checked(0x62, 0x50),
    ];
    on_bus(&frames, |bus| {
        Magnetometer::new(bus)
            .configure_interrupt(flight_interrupt())
            .unwrap();
    });
}

#[test]
fn the_chip_is_told_to_correct_its_errors_and_asked_whether_it_does() {
    let frames = [
        reads(0xE0, &[0x0C]),
        checked(0x60, 0x8C),
        reads(0xE1, &[0x08]),
        checked(0x61, 0x0A),
        reads(0xE0, &[0x8C]),
        reads(0xE1, &[0x0A]),
        reads(0xE0, &[0x8C]),
        reads(0xE1, &[0x08]),
    ];
    on_bus(&frames, |bus| {
        let mut chip = Magnetometer::new(bus);
        chip.compensate().unwrap();
        chip.verify_compensation().unwrap();
        let forgotten = Error::ReadBack {
            chip: CHIP,
            register: 0x61,
            wrote: 0x0A,
            read: 0x08,
        };
        assert_eq!(chip.verify_compensation(), Err(forgotten));
    });
}

#[test]
fn verifying_reads_only_and_ignores_the_bits_of_others() {
    let frames = [
        reads(0xE5, &[0x23, 0x01]),
        reads(0xE1, &[0x0B]),
        reads(0xE3, &[0xE7]),
        reads(0xE2, &[0x70]),
    ];
    on_bus(&frames, |bus| {
        Magnetometer::new(bus)
            .verify_interrupt(flight_interrupt())
            .unwrap();
    });
}

#[test]
fn every_choice_of_the_interrupt_lands_in_its_bits() {
    let interrupt = MagInterrupt {
        compare: MagCompare::Field,
        axes: Axes {
            x: true,
            y: false,
            z: false,
        },
        threshold: MagThreshold::from_code(0xFFFE).unwrap(),
        latch: false,
        pin: MagPin::DataReady,
    };
    let frames = [
        reads(0xE5, &[0xFE, 0xFF]),
        reads(0xE1, &[0x00]),
        reads(0xE3, &[0x85]),
        reads(0xE2, &[0x01]),
    ];
    on_bus(&frames, |bus| {
        Magnetometer::new(bus).verify_interrupt(interrupt).unwrap()
    });
}

#[test]
fn each_mismatch_names_its_register() {
    let good = [
        reads(0xE5, &[0x23, 0x01]),
        reads(0xE1, &[0x08]),
        reads(0xE3, &[0xE7]),
    ];
    let cases = [
        (vec![reads(0xE5, &[0x22, 0x01])], 0x65, 0x23, 0x22),
        (vec![reads(0xE5, &[0x23, 0x00])], 0x66, 0x01, 0x00),
        (
            vec![good[0].clone(), reads(0xE1, &[0x02])],
            0x61,
            0x0A,
            0x02,
        ),
        (
            vec![good[0].clone(), good[1].clone(), reads(0xE3, &[0xE0])],
            0x63,
            0xE7,
            0xE0,
        ),
        (
            [&good[..], &[reads(0xE2, &[0x31])]].concat(),
            0x62,
            0x70,
            0x31,
        ),
    ];
    for (frames, register, wrote, read) in cases {
        on_bus(&frames, |bus| {
            assert_eq!(
                Magnetometer::new(bus).verify_interrupt(flight_interrupt()),
                Err(Error::ReadBack {
                    chip: CHIP,
                    register,
                    wrote,
                    read
                })
            );
        });
    }
}

#[test]
fn threshold_is_one_burst_of_two_bytes_and_its_read_back() {
    let threshold = MagThreshold::from_code(0xABCD).unwrap();
    let frames = [writes(&[0x65, 0xCD, 0xAB]), reads(0xE5, &[0xCD, 0xAB])];
    on_bus(&frames, |bus| {
        Magnetometer::new(bus).set_threshold(threshold).unwrap();
    });
}

#[test]
fn offset_is_one_burst_of_six_bytes_and_its_read_back() {
    let bytes = [0x01, 0x00, 0xFF, 0xFF, 0x00, 0x80];
    let frames = [
        writes(&[[0x45].as_slice(), &bytes].concat()),
        reads(0xC5, &bytes),
    ];
    on_bus(&frames, |bus| {
        let offset = MagOffset([1, -1, i16::MIN]);
        Magnetometer::new(bus).set_offset(offset).unwrap();
    });
}

#[test]
fn an_offset_byte_that_was_not_taken_is_named() {
    let bytes = [0x11, 0x22, 0x33, 0x44, 0x55, 0x66];
    for (index, register) in (0x45..=0x4A).enumerate() {
        let mut wrong = bytes;
        wrong[index] ^= 0x01;
        let frames = [
            writes(&[[0x45].as_slice(), &bytes].concat()),
            reads(0xC5, &wrong),
        ];
        on_bus(&frames, |bus| {
            assert_eq!(
                Magnetometer::new(bus).set_offset(MagOffset([0x2211, 0x4433, 0x6655])),
                Err(Error::ReadBack {
                    chip: CHIP,
                    register,
                    wrote: bytes[index],
                    read: wrong[index]
                })
            );
        });
    }
}

#[test]
fn pins_and_i2c_change_only_their_bits_of_cfg_reg_c() {
    let routes = [
        (MagPin::Nothing, 0x30),
        (MagPin::DataReady, 0x31),
        (MagPin::Threshold, 0x70),
    ];
    for (pin, value) in routes {
        on_bus(&[reads(0xE2, &[0x71]), checked(0x62, value)], |bus| {
            Magnetometer::new(bus).set_pin(pin).unwrap();
        });
    }
    on_bus(&[reads(0xE2, &[0x10]), checked(0x62, 0x30)], |bus| {
        Magnetometer::new(bus).disable_i2c().unwrap();
    });
}

#[test]
fn clearing_reads_the_source_and_status_tells_of_a_sample() {
    on_bus(&[reads(0xE4, &[0x91]), reads(0xE7, &[0x0F])], |bus| {
        let mut chip = Magnetometer::new(bus);
        chip.clear_request().unwrap();
        assert!(chip.status().unwrap().new_sample());
    });
}

#[test]
fn a_sample_is_one_burst_and_gets_its_offset_back() {
    on_bus(
        &[reads(0xE8, &[0x0A, 0x00, 0xF6, 0xFF, 0xFF, 0x7F])],
        |bus| {
            let sample = Magnetometer::new(bus).read_sample().unwrap();
            assert_eq!(sample, MagCounts([10, -10, i16::MAX]));
            let field = sample.with_offset_restored(MagOffset([100, -100, 1]));
            assert_eq!(
                field,
                MagCounts([110, -110, i16::MAX]),
                "saturates instead of wrapping"
            );
            assert_eq!(MagOffset::at(field), MagOffset([110, -110, i16::MAX]));
        },
    );
    let ends = MagCounts([i16::MIN, i16::MAX, i16::MIN]);
    assert_eq!(ends.with_offset_restored(MagOffset([-1, 1, -1])), ends);
    assert_eq!(
        MagCounts([i16::MAX; 3])
            .with_offset_restored(MagOffset([1; 3]))
            .0,
        [i16::MAX; 3]
    );
    let [x, y, _] = MagCounts([1000, -2, 0]).field();
    assert!((x.0 - 1.5).abs() < 1.0e-6 && (y.0 + 0.003).abs() < 1.0e-9);
}

#[test]
fn a_bus_error_at_any_transaction_ends_the_call_with_that_error() {
    let failed = Err(Error::Bus(ErrorKind::Overrun));
    let fail = || Magnetometer::new(FailingBus { remaining: 0 });
    assert_eq!(fail().check_identity(), failed);
    assert_eq!(fail().configure_interrupt(flight_interrupt()), failed);
    assert_eq!(fail().verify_interrupt(flight_interrupt()), failed);
    assert_eq!(fail().disable_i2c(), failed);
    assert_eq!(fail().set_offset(MagOffset::default()), failed);
    assert_eq!(fail().clear_request(), failed);
    assert_eq!(fail().read_sample().map(|_| ()), failed);
    let mut read_back_fails = Magnetometer::new(FailingBus { remaining: 1 });
    assert_eq!(read_back_fails.set_offset(MagOffset::default()), failed);
}

proptest! {
    #[test]
    fn a_sample_less_its_offset_is_restored_exactly(
        field in prop::array::uniform3(-16_000_i16..16_000),
        offset in prop::array::uniform3(-16_000_i16..16_000),
    ) {
        let mut output = field;
        for (count, offset) in output.iter_mut().zip(offset) {
            *count -= offset;
        }
        let restored = MagCounts(output).with_offset_restored(MagOffset(offset));
        prop_assert_eq!(restored, MagCounts(field));
    }
}
