//! Accelerometer of the LSM303AGR: exact bytes of every operation, failures.

mod common;

use common::{FailingBus, checked, on_bus, reads, writes};
use embedded_hal::spi::ErrorKind;
use reflex_drivers::{
    Chip, Error,
    lsm303agr::{
        AccelDataRate, AccelFullScale, AccelInterrupt, AccelMode, AccelOutput, AccelPin,
        AccelThreshold, Accelerometer, Axes, HighPass, HighPassCorner, HighPassMode, Status,
        ThresholdDuration,
    },
};

const CHIP: Chip = Chip::Lsm303agrAccelerometer;

/// As the firmware uses it: code 5, slowest corner, re-armed by reading.
fn flight_interrupt() -> AccelInterrupt {
    AccelInterrupt {
        high_pass: Some(HighPass {
            mode: HighPassMode::ResetByReading,
            corner: HighPassCorner::FourHundredth,
        }),
        axes: Axes::ALL,
        threshold: AccelThreshold::from_code(5).unwrap(),
        duration: ThresholdDuration::IMMEDIATE,
        latch: true,
        pin: AccelPin::Threshold,
    }
}

const FLIGHT_REGISTERS: [(u8, u8); 6] = [
    (0x21, 0x31),
    (0x24, 0x08),
    (0x32, 5),
    (0x33, 0),
    (0x30, 0x2A),
    (0x22, 0x40),
];

#[test]
fn identity_is_read_from_0x0f_and_another_chip_is_refused() {
    on_bus(&[reads(0x8F, &[0x33])], |bus| {
        Accelerometer::new(bus).check_identity().unwrap()
    });
    on_bus(&[reads(0x8F, &[0x32])], |bus| {
        assert_eq!(
            Accelerometer::new(bus).check_identity(),
            Err(Error::WrongIdentity {
                chip: CHIP,
                expected: 0x33,
                found: 0x32
            })
        );
    });
}

#[test]
fn output_set_by_the_crate_is_verified_by_reading_only() {
    let output = AccelOutput {
        data_rate: AccelDataRate::Hz100,
        full_scale: AccelFullScale::G4,
        mode: AccelMode::HighResolution,
    };
    on_bus(&[reads(0xA0, &[0x57]), reads(0xA3, &[0x99])], |bus| {
        Accelerometer::new(bus).verify_output(output).unwrap();
    });
    on_bus(&[reads(0xA0, &[0x57]), reads(0xA3, &[0x98])], |bus| {
        assert_eq!(
            Accelerometer::new(bus).verify_output(output),
            Err(Error::ReadBack {
                chip: CHIP,
                register: 0x23,
                wrote: 0x99,
                read: 0x98
            })
        );
    });
}

#[test]
fn every_output_setting_has_its_register_values() {
    use AccelDataRate::{Hz1, Hz10, Hz25, Hz50, Hz200, Hz400, Hz1344};
    use AccelFullScale::{G2, G4, G8, G16};
    use AccelMode::{HighResolution, LowPower, Normal};
    let cases = [
        (Hz1, G2, Normal, 0x17, 0x81),
        (Hz10, G8, LowPower, 0x2F, 0xA1),
        (Hz25, G16, HighResolution, 0x37, 0xB9),
        (Hz50, G4, Normal, 0x47, 0x91),
        (Hz200, G4, Normal, 0x67, 0x91),
        (Hz400, G4, Normal, 0x77, 0x91),
        (Hz1344, G4, Normal, 0x97, 0x91),
    ];
    for (data_rate, full_scale, mode, reg1, reg4) in cases {
        on_bus(&[reads(0xA0, &[reg1]), reads(0xA3, &[reg4])], |bus| {
            let output = AccelOutput {
                data_rate,
                full_scale,
                mode,
            };
            Accelerometer::new(bus).verify_output(output).unwrap();
        });
    }
}

#[test]
fn interrupt_is_configured_checked_rearmed_and_cleared_in_this_order() {
    let mut frames: Vec<_> = FLIGHT_REGISTERS
        .iter()
        .map(|&(address, value)| checked(address, value))
        .collect();
    frames.push(reads(0xA6, &[0x00]));
    frames.push(reads(0xB1, &[0x6A]));
    on_bus(&frames, |bus| {
        Accelerometer::new(bus)
            .configure_interrupt(flight_interrupt())
            .unwrap();
    });
}

#[test]
fn every_choice_of_the_interrupt_lands_in_its_bits() {
    let interrupt = AccelInterrupt {
        high_pass: Some(HighPass {
            mode: HighPassMode::ResetAtInterrupt,
            corner: HighPassCorner::Hundredth,
        }),
        axes: Axes {
            x: false,
            y: true,
            z: false,
        },
        threshold: AccelThreshold::MAX,
        duration: ThresholdDuration::samples(127).unwrap(),
        latch: false,
        pin: AccelPin::DataReadyAndThreshold,
    };
    let expected = [
        (0x21, 0xD1),
        (0x24, 0),
        (0x32, 0x7F),
        (0x33, 0x7F),
        (0x30, 8),
        (0x22, 0x50),
    ];
    let frames = expected.map(|(address, value)| reads(0x80 | address, &[value]));
    on_bus(&frames, |bus| {
        Accelerometer::new(bus).verify_interrupt(interrupt).unwrap()
    });

    let modes = [
        (None, 0x00),
        (
            Some((HighPassMode::ResetByReading, HighPassCorner::Fiftieth)),
            0x01,
        ),
        (
            Some((HighPassMode::Reference, HighPassCorner::TwoHundredth)),
            0x61,
        ),
        (
            Some((HighPassMode::Normal, HighPassCorner::FourHundredth)),
            0xB1,
        ),
    ];
    for (choice, reg2) in modes {
        let high_pass = choice.map(|(mode, corner)| HighPass { mode, corner });
        on_bus(&[reads(0xA1, &[!reg2])], |bus| {
            let interrupt = AccelInterrupt {
                high_pass,
                ..flight_interrupt()
            };
            assert_eq!(
                Accelerometer::new(bus).verify_interrupt(interrupt),
                Err(Error::ReadBack {
                    chip: CHIP,
                    register: 0x21,
                    wrote: reg2,
                    read: !reg2
                })
            );
        });
    }
}

#[test]
fn a_register_that_does_not_hold_its_value_is_named_when_configuring_and_when_verifying() {
    for (bad, &(register, value)) in FLIGHT_REGISTERS.iter().enumerate() {
        let mismatch = Error::ReadBack {
            chip: CHIP,
            register,
            wrote: value,
            read: value ^ 0x80,
        };
        let good = &FLIGHT_REGISTERS[..bad];

        let mut frames: Vec<_> = good.iter().map(|&(a, v)| checked(a, v)).collect();
        frames.push(writes(&[register, value]));
        frames.push(reads(0x80 | register, &[value ^ 0x80]));
        on_bus(&frames, |bus| {
            let result = Accelerometer::new(bus).configure_interrupt(flight_interrupt());
            assert_eq!(result, Err(mismatch));
        });

        let mut frames: Vec<_> = good.iter().map(|&(a, v)| reads(0x80 | a, &[v])).collect();
        frames.push(reads(0x80 | register, &[value ^ 0x80]));
        on_bus(&frames, |bus| {
            let result = Accelerometer::new(bus).verify_interrupt(flight_interrupt());
            assert_eq!(result, Err(mismatch));
        });
    }
}

#[test]
fn threshold_is_written_and_read_back() {
    let threshold = AccelThreshold::from_code(0x2B).unwrap();
    on_bus(&[checked(0x32, 0x2B)], |bus| {
        Accelerometer::new(bus).set_threshold(threshold).unwrap();
    });
    on_bus(&[writes(&[0x32, 0x2B]), reads(0xB2, &[0x00])], |bus| {
        assert_eq!(
            Accelerometer::new(bus).set_threshold(threshold),
            Err(Error::ReadBack {
                chip: CHIP,
                register: 0x32,
                wrote: 0x2B,
                read: 0
            })
        );
    });
}

#[test]
fn the_pin_is_routed_by_ctrl_reg3() {
    let routes = [
        (AccelPin::Nothing, 0x00),
        (AccelPin::DataReady, 0x10),
        (AccelPin::Threshold, 0x40),
        (AccelPin::DataReadyAndThreshold, 0x50),
    ];
    for (pin, bits) in routes {
        on_bus(&[checked(0x22, bits)], |bus| {
            Accelerometer::new(bus).set_pin(pin).unwrap()
        });
    }
}

#[test]
fn rearming_reads_reference_and_clearing_reads_the_source() {
    let frames = [
        reads(0xA6, &[0x55]),
        reads(0xB1, &[0x4A]),
        reads(0xA7, &[0x8F]),
    ];
    on_bus(&frames, |bus| {
        let mut chip = Accelerometer::new(bus);
        chip.rearm().unwrap();
        chip.clear_request().unwrap();
        assert!(chip.status().unwrap().new_sample());
    });
    assert!(!Status(0x77).new_sample());
}

#[test]
fn a_bus_error_at_any_transaction_ends_the_call_with_that_error() {
    let failed = Err(Error::Bus(ErrorKind::Overrun));
    let fail = || Accelerometer::new(FailingBus { remaining: 0 });
    assert_eq!(fail().check_identity(), failed);
    assert_eq!(fail().configure_interrupt(flight_interrupt()), failed);
    assert_eq!(fail().verify_interrupt(flight_interrupt()), failed);
    assert_eq!(fail().set_threshold(AccelThreshold::MAX), failed);
    assert_eq!(fail().rearm(), failed);
    assert_eq!(fail().clear_request(), failed);
    assert_eq!(fail().read_sample().map(|_| ()), failed);
    assert_eq!(fail().status().map(|_| ()), failed);
    let mut read_back_fails = Accelerometer::new(FailingBus { remaining: 1 });
    assert_eq!(read_back_fails.set_threshold(AccelThreshold::MAX), failed);
}
