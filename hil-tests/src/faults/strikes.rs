//! What happens to chips at an instant, on either tier.

use std::collections::VecDeque;

use chip_models::{Mpu6050, OwnClock};

use super::kinds::{Chip, Effect};
use super::script::Script;

/// The MPU6050's register of the gyroscope's range.
const GYRO_CONFIG: u8 = 0x1B;

/// Chips that can be struck, wherever they are.
pub trait Struck {
    /// Works on the inertial sensor.
    fn imu(&mut self, work: &mut dyn FnMut(&mut Mpu6050));
    /// Works on a die with a clock of its own, by its place.
    fn die(&mut self, place: usize, work: &mut dyn FnMut(&mut dyn OwnClock));
}

/// One thing that happens to a chip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strike {
    /// When, ns from the start.
    pub at_ns: u64,
    what: What,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    BrownOut(Chip),
    FlippedBit(Chip, u8),
    /// The chip's clock is faster by this share from now on.
    Rate(Chip, f64),
}

/// Those of a flight that are still to come, in order of time.
#[derive(Clone, Debug, Default)]
pub struct Strikes(VecDeque<Strike>);

impl Strikes {
    /// Those of a script.
    #[must_use]
    pub fn of(script: &Script) -> Self {
        let mut strikes = Vec::new();
        for fault in script.iter() {
            let mut add = |at_ns, what| strikes.push(Strike { at_ns, what });
            match fault.effect {
                Effect::BrownOut(chip) => add(fault.from_ns, What::BrownOut(chip)),
                Effect::FlippedBit(chip, bit) => add(fault.from_ns, What::FlippedBit(chip, bit)),
                Effect::Rate(chip, share) => {
                    add(fault.from_ns, What::Rate(chip, share));
                    add(fault.until_ns, What::Rate(chip, 0.0));
                }
                _ => {}
            }
        }
        strikes.sort_by_key(|strike| strike.at_ns);
        Self(strikes.into())
    }

    /// Takes the next one, where it comes before an instant.
    pub fn before(&mut self, until_ns: u64) -> Option<Strike> {
        self.0.pop_front_if(|strike| strike.at_ns < until_ns)
    }
}

impl Strike {
    /// It happens, now.
    pub fn strike(self, now_ns: u64, chips: &mut impl Struck) {
        match self.what {
            What::BrownOut(Chip::Imu) => chips.imu(&mut |imu| imu.brown_out(now_ns)),
            What::BrownOut(Chip::Die(place)) => {
                chips.die(place, &mut |die| die.brown_out(now_ns));
            }
            What::FlippedBit(Chip::Imu, bit) => chips.imu(&mut |imu| {
                let value = imu.register(GYRO_CONFIG) ^ (1 << bit);
                imu.corrupt(now_ns, GYRO_CONFIG, value);
            }),
            What::FlippedBit(Chip::Die(place), bit) => {
                chips.die(place, &mut |die| die.flip_threshold_bit(now_ns, bit));
            }
            What::Rate(Chip::Imu, share) => chips.imu(&mut |imu| imu.hurry(now_ns, share)),
            What::Rate(Chip::Die(place), share) => {
                chips.die(place, &mut |die| die.hurry(now_ns, share));
            }
        }
    }
}
