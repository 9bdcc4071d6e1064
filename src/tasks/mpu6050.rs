//! The MPU6050 as gyroscope and accelerometer that gate the hyperperiod.

use embedded_hal::i2c::I2c;
use reflex_drivers::Error;
use reflex_drivers::mpu6050::{
    ADDRESS, BURST_LENGTH, CHECKS, Check, Difference, ImuBurst, ImuConfig, InterruptStatus,
    LONGEST_CHECK, Mpu6050, RESET_STEPS, RESET_WAIT_US,
};

use super::imu::{Configure, Imu};
use crate::config::{IMU_MOUNTING, IMU_RATE};
use crate::math::Vec3;
use crate::sensors::ImuReading;
use crate::time::{Duration, micros};
use crate::units::{BodyRates, SpecificForce};

/// What the chip is to hold.
pub const CONFIG: ImuConfig = ImuConfig {
    // The chip divides 1 kHz; the rates that `config/` allows are its whole fractions.
    rate_divider: (1000 / IMU_RATE - 1) as u8,
    ..ImuConfig::FLIGHT
};

/// The MPU6050 at its first address.
#[derive(Clone, Copy, Debug)]
pub struct Sensor;

impl Imu for Sensor {
    type Burst = [u8; BURST_LENGTH];
    type Check = Check;
    type Held = [u8; LONGEST_CHECK];
    type Difference = Difference;

    const CHECKS: &'static [Check] = &CHECKS;

    fn is_new(burst: &Self::Burst) -> bool {
        let [status, ..] = burst;
        InterruptStatus(*status).data_ready()
    }

    fn reading(burst: &Self::Burst) -> Option<ImuReading> {
        let burst = ImuBurst::from_bytes(burst);
        if !burst.interrupt_status.data_ready() {
            return None;
        }
        let rates = burst.angular_rate(CONFIG.gyro_range).map(|axis| axis.0);
        let force = burst.specific_force(CONFIG.accel_range).map(|axis| axis.0);
        Some(ImuReading {
            rates: BodyRates(Vec3::from_array(IMU_MOUNTING.turned(rates))),
            force: SpecificForce(Vec3::from_array(IMU_MOUNTING.turned(force))),
            temperature: burst.die_temperature().0,
        })
    }

    fn difference(check: Check, held: &Self::Held) -> Option<Difference> {
        check.difference(&CONFIG, *held)
    }
}

impl<B: I2c> Configure<B> for Sensor {
    type Error = Error<B::Error>;

    const RESET: (u8, Duration) = (RESET_STEPS, micros(RESET_WAIT_US));

    fn reset(bus: &mut B, step: u8) -> Result<(), Self::Error> {
        Mpu6050::new(bus, ADDRESS).reset(step)
    }

    fn configure(bus: &mut B) -> Result<(), Self::Error> {
        let mut chip = Mpu6050::new(bus, ADDRESS);
        chip.check_identity()?;
        chip.configure(&CONFIG)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensors::GRAVITY;

    #[test]
    fn a_burst_is_decoded_in_the_order_of_the_register_map() {
        let burst = [1, 0x08, 0, 0, 0, 0xF8, 0, 9, 9, 0, 164, 0, 0, 0xFF, 0x5C];
        let reading = Sensor::reading(&burst).expect("data ready");
        assert!((reading.force.0.x - GRAVITY).abs() < 1e-4);
        assert!((reading.force.0.z + GRAVITY).abs() < 1e-4);
        assert!((reading.rates.0.x.to_degrees() - 10.0).abs() < 1e-4);
        assert!((reading.rates.0.z.to_degrees() + 10.0).abs() < 1e-4);
    }

    #[test]
    fn a_burst_without_new_data_is_no_sample() {
        assert_eq!(Sensor::reading(&[0; 15]), None);
    }

    #[test]
    fn bursts_that_differ_in_one_bit_give_readings_that_differ() {
        let burst = [1, 0x08, 0, 0, 0, 0xF8, 0, 9, 9, 0, 164, 0, 0, 0xFF, 0x5C];
        for bit in 8..15 * 8 {
            let mut other = burst;
            other[bit / 8] ^= 1 << (bit % 8);
            assert_ne!(
                Sensor::reading(&burst),
                Sensor::reading(&other),
                "bit {bit}"
            );
        }
    }
}
