//! MPU6050: the exact bytes of every operation, and its failures.

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use embedded_hal_mock::eh1::{
    delay::NoopDelay,
    i2c::{Mock, Transaction},
};
use reflex_drivers::{
    Chip, Error,
    legacy_hal::Lent,
    mpu6050::{
        ADDRESS, AccelRange, BURST_LENGTH, BURST_START, GyroRange, ImuBurst, ImuConfig,
        InterruptPin, InterruptSource, InterruptStatus, LowPass, MotionDecrement, MotionDetector,
        MotionHighPass, MotionThreshold, Mpu6050, RESET_STEPS,
    },
};

/// Registers and values of [`ImuConfig::FLIGHT`], in the order of writing.
const FLIGHT_REGISTERS: [(u8, u8); 11] = [
    (0x6B, 0x01),
    (0x6C, 0x00),
    (0x19, 0),
    (0x1A, 2),
    (0x1B, 0x18),
    (0x1C, 0x18),
    (0x1F, 0),
    (0x20, 0),
    (0x69, 0),
    (0x37, 0x00),
    (0x38, 0x01),
];

const MOTION: MotionDetector = MotionDetector {
    high_pass: MotionHighPass::Hold,
    threshold: MotionThreshold::MAX,
    duration_ms: 3,
    decrement: MotionDecrement::Two,
};

fn write(register: u8, value: u8) -> Transaction {
    Transaction::write(ADDRESS, vec![register, value])
}

fn read(register: u8, value: u8) -> Transaction {
    Transaction::write_read(ADDRESS, vec![register], vec![value])
}

fn on_bus(transactions: &[Transaction], test: impl FnOnce(Mpu6050<Mock>)) {
    let mut bus = Mock::new(transactions);
    test(Mpu6050::new(bus.clone(), ADDRESS));
    bus.done();
}

#[test]
fn identity_is_read_from_0x75_and_another_chip_is_refused() {
    on_bus(&[read(0x75, 0x68)], |mut chip| {
        chip.check_identity().unwrap()
    });
    on_bus(&[read(0x75, 0x70)], |mut chip| {
        assert_eq!(
            chip.check_identity(),
            Err(Error::WrongIdentity {
                chip: Chip::Mpu6050,
                expected: 0x68,
                found: 0x70
            })
        );
    });
}

#[test]
fn configuring_writes_all_registers_and_then_reads_all_of_them() {
    let writes = FLIGHT_REGISTERS
        .iter()
        .map(|&(register, value)| write(register, value));
    let reads = FLIGHT_REGISTERS
        .iter()
        .map(|&(register, value)| read(register, value));
    let transactions: Vec<_> = writes.chain(reads).collect();
    on_bus(&transactions, |mut chip| {
        chip.configure(&ImuConfig::FLIGHT).unwrap()
    });
}

#[test]
fn a_register_that_does_not_hold_its_value_is_named() {
    for (bad, &(register, value)) in FLIGHT_REGISTERS.iter().enumerate() {
        let mut transactions: Vec<_> = FLIGHT_REGISTERS[..bad]
            .iter()
            .map(|&(register, value)| read(register, value))
            .collect();
        transactions.push(read(register, value ^ 0x40));
        on_bus(&transactions, |mut chip| {
            assert_eq!(
                chip.verify(&ImuConfig::FLIGHT),
                Err(Error::ReadBack {
                    chip: Chip::Mpu6050,
                    register,
                    wrote: value,
                    read: value ^ 0x40
                })
            );
        });
    }
}

#[test]
fn every_choice_lands_in_its_register() {
    let config = ImuConfig {
        gyro_range: GyroRange::Dps500,
        accel_range: AccelRange::G4,
        low_pass: LowPass::Hz256,
        rate_divider: 7,
        motion: Some(MOTION),
        interrupt: InterruptSource::DataReadyAndMotion,
        pin: InterruptPin::HeldUntilStatusRead,
    };
    let expected = [
        read(0x6B, 0x01),
        read(0x6C, 0x00),
        read(0x19, 7),
        read(0x1A, 0),
        read(0x1B, 0x08),
        read(0x1C, 0x0F),
        read(0x1F, 0xFF),
        read(0x20, 3),
        read(0x69, 2),
        read(0x37, 0x20),
        read(0x38, 0x41),
    ];
    on_bus(&expected, |mut chip| chip.verify(&config).unwrap());
}

/// Verifies a configuration whose register `index` shall hold `value`, and holds something else.
fn expect_code(config: ImuConfig, index: usize, value: u8) {
    let register = FLIGHT_REGISTERS[index].0;
    let mut bus: Vec<_> = FLIGHT_REGISTERS[..index]
        .iter()
        .map(|&(r, v)| read(r, v))
        .collect();
    bus.push(read(register, !value));
    on_bus(&bus, |mut chip| {
        let wrong = Error::ReadBack {
            chip: Chip::Mpu6050,
            register,
            wrote: value,
            read: !value,
        };
        assert_eq!(chip.verify(&config), Err(wrong));
    });
}

#[test]
fn every_low_pass_and_gyro_range_has_its_code() {
    use GyroRange::{Dps250, Dps500, Dps1000, Dps2000};
    use LowPass::{Hz5, Hz10, Hz20, Hz42, Hz98, Hz188, Hz256};
    let flight = ImuConfig::FLIGHT;
    for (code, low_pass) in (0..).zip([Hz256, Hz188, Hz98, Hz42, Hz20, Hz10, Hz5]) {
        expect_code(ImuConfig { low_pass, ..flight }, 3, code);
    }
    for (code, gyro_range) in (0..).zip([Dps250, Dps500, Dps1000, Dps2000]) {
        expect_code(
            ImuConfig {
                gyro_range,
                ..flight
            },
            4,
            code << 3,
        );
    }
}

#[test]
fn every_motion_high_pass_and_accelerometer_range_has_its_code() {
    use MotionHighPass::{Hold, Hz0_63, Hz1_25, Hz2_5, Hz5, Reset};
    let flight = ImuConfig::FLIGHT;
    let codes = [
        (0, Reset),
        (1, Hz5),
        (2, Hz2_5),
        (3, Hz1_25),
        (4, Hz0_63),
        (7, Hold),
    ];
    for (code, high_pass) in codes {
        let motion = Some(MotionDetector {
            high_pass,
            ..MOTION
        });
        expect_code(ImuConfig { motion, ..flight }, 5, 0x18 | code);
    }
    let finest = ImuConfig {
        accel_range: AccelRange::G2,
        motion: Some(MOTION),
        ..flight
    };
    expect_code(finest, 5, 0x07);
}

#[test]
fn rearming_resets_the_high_pass_and_sets_it_again_in_two_calls_and_keeps_the_range() {
    let config = ImuConfig {
        motion: Some(MOTION),
        ..ImuConfig::FLIGHT
    };
    on_bus(&[write(0x1C, 0x18), read(0x1C, 0x18)], |mut chip| {
        chip.release_motion_reference(&config).unwrap();
    });
    on_bus(&[write(0x1C, 0x1F), read(0x1C, 0x1F)], |mut chip| {
        chip.take_motion_reference(&config).unwrap();
    });
}

#[test]
fn the_burst_is_fifteen_bytes_from_0x3a() {
    assert_eq!((BURST_START, BURST_LENGTH), (0x3A, 15));
    let burst = ImuBurst::from_bytes(&[
        0x41, 0x08, 0x00, 0xF8, 0x00, 0, 1, 0xF1, 0x60, 0, 164, 0xFF, 92, 0x80, 0,
    ]);
    assert!(burst.interrupt_status.data_ready() && burst.interrupt_status.motion());
    assert_eq!(burst.accel, [2048, -2048, 1]);
    assert_eq!(burst.temperature, -3744);
    assert_eq!(burst.gyro, [164, -164, i16::MIN]);

    let [x, y, _] = burst.specific_force(AccelRange::G16);
    assert_eq!((x.0, y.0), (9.806_65, -9.806_65));
    let [x, y, _] = burst.angular_rate(GyroRange::Dps2000);
    assert!((x.0 - 10.0_f32.to_radians()).abs() < 1.0e-6 && x.0 == -y.0);
    assert!((burst.die_temperature().0 - 25.52).abs() < 0.01);

    assert!(!InterruptStatus(0x3E).data_ready() && !InterruptStatus(0x3E).motion());
}

#[test]
fn a_bus_error_ends_the_call_with_that_error() {
    let error = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
    let failed = Err(Error::Bus(error));
    let read_fails = |register| read(register, 0).with_error(error);
    on_bus(&[read_fails(0x75)], |mut chip| {
        assert_eq!(chip.check_identity(), failed)
    });
    on_bus(&[read_fails(0x6B)], |mut chip| {
        assert_eq!(chip.verify(&ImuConfig::FLIGHT), failed);
    });
    on_bus(&[write(0x6B, 1).with_error(error)], |mut chip| {
        assert_eq!(chip.configure(&ImuConfig::FLIGHT), failed);
    });
    on_bus(&[write(0x1C, 0x18), read_fails(0x1C)], |mut chip| {
        assert_eq!(chip.release_motion_reference(&ImuConfig::FLIGHT), failed);
    });
}

#[test]
fn the_crate_mpu6050_runs_on_a_lent_bus_and_leaves_it_usable() {
    let mut bus = Mock::new(&[
        write(0x6B, 0x01),
        read(0x75, 0x68),
        read(0x1C, 0x00),
        write(0x1C, 0x00),
        read(0x1B, 0x00),
        write(0x1B, 0x00),
        read(0x1C, 0x00),
        write(0x1C, 0x00),
        read(0x75, 0x68),
    ]);
    let mut lent = bus.clone();
    let mut delay = NoopDelay::new();
    mpu6050::Mpu6050::new(Lent(&mut lent))
        .init(&mut Lent(&mut delay))
        .unwrap();
    Mpu6050::new(lent, ADDRESS).check_identity().unwrap();
    bus.done();
}

#[test]
fn a_reset_is_the_chip_first_and_its_signal_paths_then() {
    on_bus(&[write(0x6B, 0x80), write(0x68, 0x07)], |mut chip| {
        for step in 0..RESET_STEPS {
            chip.reset(step).unwrap();
        }
        chip.reset(RESET_STEPS).unwrap();
    });
}
