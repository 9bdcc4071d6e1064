//! Every code of every threshold register, from a value to it and back.
//!
//! `thresholds.rs` tests the conversion alone; here orders go through the drivers into registers.

use std::cell::RefCell;
use std::rc::Rc;

use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use reflex_drivers::{
    lsm303agr::{
        ACCELEROMETER_IDENTITY, AccelFullScale, MAG_STEP, MAGNETOMETER_IDENTITY,
        halves::{Half, Halves, Rates},
        register::{INT_THS_L_REG_M, INT1_THS_A, WHO_AM_I_A, WHO_AM_I_M},
    },
    mpu6050::{MotionThreshold, NOMINAL_MOTION_STEP},
    orders::{ChipAction, ChipSetting, ComparingSensor},
    quantity::{MetersPerSecondSquared, Seconds},
};

/// Bits of a command: read, go on to the next address.
const READ: u8 = 0x80;
const ADDRESS: u8 = 0x3F;

/// One half of a chip that holds what is written to it, and does nothing else.
#[derive(Debug)]
struct Registers {
    held: [u8; 0x80],
    /// Bits that every address of this half has.
    base: u8,
}

impl Registers {
    fn new(identity: (u8, u8), base: u8) -> Self {
        let mut held = [0; 0x80];
        held[usize::from(identity.0)] = identity.1;
        Self { held, base }
    }

    /// Moves bytes behind a command.
    fn pass(&mut self, command: u8, bytes: &mut [u8]) {
        let first = usize::from(command & ADDRESS | self.base);
        let held = &mut self.held[first..first + bytes.len()];
        if command & READ == 0 {
            held.copy_from_slice(bytes);
        } else {
            bytes.copy_from_slice(held);
        }
    }
}

/// A half's bus handle.
#[derive(Clone, Debug)]
struct Bus(Rc<RefCell<Registers>>);

impl ErrorType for Bus {
    type Error = ErrorKind;
}

impl SpiDevice for Bus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let mut registers = self.0.borrow_mut();
        match operations {
            [Operation::Write([command, values @ ..])] => {
                registers.pass(*command, &mut values.to_vec())
            }
            [Operation::TransferInPlace([command, values @ ..])] => {
                registers.pass(*command, values)
            }
            [Operation::Write([command]), Operation::Read(values)] => {
                registers.pass(*command, values)
            }
            other => panic!("{other:?}"),
        }
        Ok(())
    }
}

/// A chip, and what its halves hold.
struct Bench {
    chip: Halves<Bus, Bus>,
    accel: Bus,
    mag: Bus,
}

impl Bench {
    fn new(accel_hz: u32, longest_hold: f32) -> Self {
        let half = |identity, base| Bus(Rc::new(RefCell::new(Registers::new(identity, base))));
        let accel = half((WHO_AM_I_A, ACCELEROMETER_IDENTITY), 0);
        let mag = half((WHO_AM_I_M, MAGNETOMETER_IDENTITY), 0x40);
        let rates = Rates::from_hz(accel_hz, 100).expect("rates of the chip");
        let chip = Halves::new(accel.clone(), mag.clone(), rates, Seconds(longest_hold));
        Self { chip, accel, mag }
    }

    /// What a half does for a threshold: the level, the next one, and the code in its register.
    fn order(&mut self, half: Half, threshold: f32) -> (f32, f32, u16) {
        let order = ChipAction::Threshold(threshold);
        let setting = self
            .chip
            .half(half)
            .execute(order)
            .expect("a sound bus")
            .setting;
        let ChipSetting::PastThreshold { level, next, .. } = setting else {
            panic!("{setting:?} for {threshold}");
        };
        assert!(
            setting.serves(threshold) || threshold == f32::INFINITY,
            "{setting:?} for {threshold}"
        );
        let code = match half {
            Half::Accel => u16::from(self.accel.0.borrow().held[usize::from(INT1_THS_A)]),
            Half::Mag => {
                let first = usize::from(INT_THS_L_REG_M);
                let held = &self.mag.0.borrow().held;
                u16::from_le_bytes([held[first], held[first + 1]])
            }
        };
        (level, next, code)
    }

    /// Asks for the value of each code up to the largest, and for those beside it.
    fn every_code(&mut self, half: Half, largest: u16, step: f32) {
        let (mut level, _, finest) = self.order(half, 0.0);
        assert_eq!(finest, 1, "the finest");
        for code in 1..=largest {
            let (own, next, held) = self.order(half, level);
            assert_eq!(
                (own, held),
                (level, code),
                "{half:?}: the value of a code is its own"
            );
            assert!(
                (own / (f32::from(code) * step) - 1.0).abs() < 1e-5,
                "{half:?} {code}: {own}"
            );
            if code > 1 {
                assert_eq!(
                    self.order(half, level.next_down()).2,
                    code - 1,
                    "{half:?} {code}"
                );
            }
            if code == largest {
                assert_eq!(next, f32::INFINITY);
                break;
            }
            assert!(next > level, "{half:?} {code}: levels rise");
            for between in [level.next_up(), (level + next) / 2.0, next.next_down()] {
                let (own, _, held) = self.order(half, between);
                assert_eq!((own, held), (level, code), "{half:?}: {between}");
                assert!(
                    own <= between && between - own < 1.001 * (next - level),
                    "{half:?}: {between}"
                );
            }
            level = next;
        }
        for beyond in [level.next_up(), 1e9, f32::INFINITY] {
            assert_eq!(
                self.order(half, beyond),
                (level, f32::INFINITY, largest),
                "{half:?}: {beyond}"
            );
        }
        assert_eq!(self.order(half, f32::NEG_INFINITY).2, 1);
    }
}

#[test]
fn every_code_of_the_accelerometer_reaches_its_register_and_comes_back() {
    let step = AccelFullScale::G2.threshold_step().0;
    for hz in [400, 200, 100, 50, 25, 10] {
        // Held for so short a time that the filter forgets nothing.
        Bench::new(hz, 0.001).every_code(Half::Accel, 127, step);
    }
}

#[test]
fn codes_that_are_lowered_for_an_old_reference_reach_the_register_too() {
    let step = AccelFullScale::G2.threshold_step().0;
    // A corner of 1 Hz at 400 Hz: a change has decayed to exp(-0.63) of it.
    let kept = (-0.1 * core::f32::consts::TAU).exp();
    Bench::new(400, 0.1).every_code(Half::Accel, 127, step / kept);
}

#[test]
fn every_code_of_the_magnetometer_reaches_its_registers_and_comes_back() {
    Bench::new(100, 0.1).every_code(Half::Mag, i16::MAX as u16, MAG_STEP.0);
}

#[test]
fn the_levels_of_the_motion_detector_rise_and_serve_what_lies_between_them() {
    for step in [2.0e-3 * 9.806_65, NOMINAL_MOTION_STEP.0].map(MetersPerSecondSquared) {
        let level = |code| {
            MotionThreshold::from_code(code)
                .expect("a code")
                .level(step)
                .0
        };
        for code in 1..u8::MAX {
            assert!(level(code + 1) > level(code), "{code}");
            for between in [
                level(code),
                (level(code) + level(code + 1)) / 2.0,
                level(code + 1).next_down(),
            ] {
                let rounded = MotionThreshold::round_down(MetersPerSecondSquared(between), step);
                assert_eq!(rounded.map(MotionThreshold::code), Ok(code), "{between}");
            }
        }
    }
}
