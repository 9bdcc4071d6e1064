//! The MPU6050's start and repair, with their lines in the log.
//!
//! Its samples come by [`super::i2c::Engine`].

use reflex::tasks::imu::{Configure, Remedy};
use reflex::tasks::mpu6050::{CONFIG, Sensor};
use reflex_drivers::Error;
use reflex_drivers::legacy_hal::Lent;
use reflex_drivers::mpu6050::{ADDRESS, Difference, Mpu6050};

use super::i2c::{Bus, BusError};
use crate::board::clock::{Delay, sleep};

/// Wakes the chip and configures it, for the first time; 100 ms of that is the crate's wait.
///
/// A chip that does not answer, or another one, is named in the log: the autopilot does not arm
/// without samples, and [`repair`] is tried again.
pub fn start(bus: &mut Bus) {
    let woken = mpu6050::Mpu6050::new(Lent(bus)).init(&mut Lent(&mut Delay));
    match woken {
        Ok(()) => {}
        Err(mpu6050::Mpu6050Error::I2c(error)) => {
            return defmt::error!("MPU6050 does not answer ({}): it is tried again", error);
        }
        Err(mpu6050::Mpu6050Error::InvalidChipId(id)) => {
            return defmt::error!(
                "MPU6050 has identity {=u8:#x}, not 0x68: check the part",
                id
            );
        }
    }
    if let Err(error) = Mpu6050::new(bus, ADDRESS).configure(&CONFIG) {
        defmt::error!("MPU6050 is not configured ({}): it is tried again", error);
    }
}

/// What a repair came to.
pub type Repaired = Result<(), Error<BusError>>;

/// Frees the bus and configures the chip anew, in under 5 ms where it need not be reset before; says
/// what is still wrong.
///
/// `failed` keeps the outcome, so that only the first of many failures in a row is logged.
pub async fn repair(bus: &mut Bus, remedy: Remedy, failed: &mut bool) -> Repaired {
    let recovery = bus.revive();
    if recovery.clocks != 1 && !*failed {
        defmt::warn!("I2C: {}", recovery);
    }
    let mut result = match recovery.is_free() {
        true => Ok(()),
        false => Err(Error::Bus(BusError::Timeout)),
    };
    if result.is_ok() && remedy == Remedy::Reset {
        defmt::warn!("MPU6050 is reset");
        let (steps, wait) = <Sensor as Configure<Bus>>::RESET;
        for step in 0..steps {
            result = result.and(Sensor::reset(bus, step));
            sleep(wait).await;
        }
    }
    let result = result.and_then(|()| Sensor::configure(bus));
    match result {
        Ok(()) => defmt::info!("MPU6050 configured anew"),
        Err(error) if !*failed => defmt::error!("MPU6050: {}; tried again", error),
        Err(_) => {}
    }
    *failed = result.is_err();
    result
}

/// Names the register that a check found changed.
pub fn warn(difference: &Difference) {
    defmt::warn!(
        "MPU6050: register {=u8:#x} holds {=u8:#x}, not {=u8:#x}: configured anew",
        difference.register,
        difference.held,
        difference.expected
    );
}
