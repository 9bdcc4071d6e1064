//! The MPU6050's start, repair and register checks.
//!
//! Its samples come by [`super::i2c::Engine`].

use reflex::app::Fault;
use reflex::tasks::mpu6050::CONFIG;
use reflex::time::{Duration, Instant, micros, span};
use reflex_drivers::legacy_hal::Lent;
use reflex_drivers::mpu6050::{ADDRESS, Check, LONGEST_CHECK, Mpu6050};

use crate::board::clock::Delay;
use crate::board::i2c::{Bus, Engine};

/// Without a burst for this long the chip counts as silent.
const SILENCE: Duration = micros(20_000);

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

/// Frees the bus and configures the chip anew, in under 5 ms; says what is still wrong.
///
/// `failed` keeps the outcome, so that only the first of many failures in a row is logged.
pub fn repair(bus: &mut Bus, failed: &mut bool) -> Option<Fault> {
    if let Some(recovery) = bus.revive() {
        defmt::warn!("I2C: {}", recovery);
    }
    let mut chip = Mpu6050::new(bus, ADDRESS);
    let result = chip.check_identity().and_then(|()| chip.configure(&CONFIG));
    match result {
        Ok(()) => defmt::info!("MPU6050 configured anew"),
        Err(error) if !*failed => defmt::error!("MPU6050: {}; tried again", error),
        Err(_) => {}
    }
    *failed = result.is_err();
    result.is_err().then_some(Fault::ImuBus)
}

/// Whether bursts have stopped coming; also has some registers checked behind the next one.
pub fn is_silent(bus: &mut Engine, now: Instant) -> bool {
    bus.check_soon();
    span(bus.last_burst(), now) > SILENCE
}

/// Compares what a check read with what the chip is to hold; names the first difference.
#[must_use]
pub fn matches(check: Check, held: [u8; LONGEST_CHECK]) -> bool {
    let Some(difference) = check.difference(&CONFIG, held) else {
        return true;
    };
    defmt::warn!(
        "MPU6050: register {=u8:#x} holds {=u8:#x}, not {=u8:#x}: configured anew",
        difference.register,
        difference.held,
        difference.expected
    );
    false
}
