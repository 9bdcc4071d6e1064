//! Frees an I2C bus that a chip holds low after a transfer was cut off.
//!
//! A chip that was interrupted while it sent a byte keeps SDA low until it gets the clocks it waits
//! for (UM10204, 3.1.16: nine clocks). Every clock here ends in a STOP condition with SDA low while
//! SCL is low, so that a chip which was receiving sees no further data bit it could take for a
//! byte, and one which was sending sees the STOP at the first bit it does not hold low itself,
//! the acknowledge bit at the latest. The pins must be open drain and taken from the I2C peripheral.

use embedded_hal::{
    delay::DelayNs,
    digital::{InputPin, OutputPin},
};

/// Most clocks that a recovery sends: eight data bits and the acknowledge bit.
pub const MOST_CLOCKS: u8 = 9;

/// Length of each step in microseconds: the bus then runs at 50 kHz.
///
/// UM10204 asks for 4.7 us low, 4.0 us before STOP and 4.7 us after it at the slowest bus speed.
pub const STEP_US: u32 = 5;

/// Longest duration of [`recover`] in microseconds, all of it waiting.
pub const LONGEST_US: u32 = STEP_US * (1 + 4 * MOST_CLOCKS as u32);

/// What a recovery did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Recovery {
    /// Clocks sent, 0 to [`MOST_CLOCKS`].
    pub clocks: u8,
    /// How the bus was left.
    pub bus: Bus,
}

impl Recovery {
    /// True where transfers may start again.
    #[must_use]
    pub fn is_free(self) -> bool {
        self.bus == Bus::Free
    }
}

/// State of the two lines after a recovery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Bus {
    /// Both lines are high: the bus is free.
    Free,
    /// SDA stays low after nine clocks.
    ///
    /// Power-cycle the chip or look for a short circuit.
    DataHeldLow,
    /// SCL stays low, so no clock can be sent.
    ///
    /// Power-cycle the chip or check the pull-up.
    ClockHeldLow,
}

/// Sends up to nine clocks, each ended by STOP, until SDA is released.
///
/// At least one is sent, because a chip that is in the middle of sending ones looks idle. Takes at
/// most [`LONGEST_US`]. Both lines are left released, whatever the outcome.
///
/// # Errors
/// The first error of a pin.
pub fn recover<SCL, SDA, E>(
    scl: &mut SCL,
    sda: &mut SDA,
    delay: &mut impl DelayNs,
) -> Result<Recovery, E>
where
    SCL: OutputPin<Error = E> + InputPin,
    SDA: OutputPin<Error = E> + InputPin,
{
    sda.set_high()?;
    scl.set_high()?;
    delay.delay_us(STEP_US);
    if scl.is_low()? {
        return Ok(Recovery {
            clocks: 0,
            bus: Bus::ClockHeldLow,
        });
    }
    for clocks in 1..=MOST_CLOCKS {
        clock_with_stop(scl, sda, delay)?;
        if scl.is_low()? {
            return Ok(Recovery {
                clocks,
                bus: Bus::ClockHeldLow,
            });
        }
        if sda.is_high()? {
            return Ok(Recovery {
                clocks,
                bus: Bus::Free,
            });
        }
    }
    Ok(Recovery {
        clocks: MOST_CLOCKS,
        bus: Bus::DataHeldLow,
    })
}

/// One clock with SDA low, then SDA released while SCL is high: STOP.
fn clock_with_stop<SCL, SDA, E>(
    scl: &mut SCL,
    sda: &mut SDA,
    delay: &mut impl DelayNs,
) -> Result<(), E>
where
    SCL: OutputPin<Error = E>,
    SDA: OutputPin<Error = E>,
{
    scl.set_low()?;
    delay.delay_us(STEP_US);
    // Only while SCL is low: SDA falling while it is high would be a START.
    sda.set_low()?;
    delay.delay_us(STEP_US);
    scl.set_high()?;
    delay.delay_us(STEP_US);
    sda.set_high()?;
    delay.delay_us(STEP_US);
    Ok(())
}
