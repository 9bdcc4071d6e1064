//! The burst that carries one sample, from INT_STATUS to the angular rate.

use super::{AccelRange, GyroRange, register::INT_STATUS};
use crate::quantity::{Celsius, MetersPerSecondSquared, RadiansPerSecond};

/// First register of the burst.
pub const BURST_START: u8 = INT_STATUS;
/// Bytes of the burst: registers 0x3A to 0x48.
pub const BURST_LENGTH: usize = 15;

/// INT_STATUS: what happened since it was read last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct InterruptStatus(pub u8);

impl InterruptStatus {
    /// A new sample was there when the burst began.
    #[must_use]
    pub const fn data_ready(self) -> bool {
        self.0 & 0x01 != 0
    }

    /// The motion detector fired.
    #[must_use]
    pub const fn motion(self) -> bool {
        self.0 & 0x40 != 0
    }
}

/// One burst, decoded: counts as the chip sent them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct ImuBurst {
    /// INT_STATUS at the burst's begin.
    pub interrupt_status: InterruptStatus,
    /// Acceleration along x, y, z.
    pub accel: [i16; 3],
    /// Die temperature.
    pub temperature: i16,
    /// Angular rate about x, y, z.
    pub gyro: [i16; 3],
}

impl ImuBurst {
    /// Decodes the registers 0x3A to 0x48; every bit pattern is a valid burst.
    #[must_use]
    pub const fn from_bytes(bytes: &[u8; BURST_LENGTH]) -> Self {
        let [
            status,
            axh,
            axl,
            ayh,
            ayl,
            azh,
            azl,
            th,
            tl,
            gxh,
            gxl,
            gyh,
            gyl,
            gzh,
            gzl,
        ] = *bytes;
        Self {
            interrupt_status: InterruptStatus(status),
            accel: [word(axh, axl), word(ayh, ayl), word(azh, azl)],
            temperature: word(th, tl),
            gyro: [word(gxh, gxl), word(gyh, gyl), word(gzh, gzl)],
        }
    }

    /// Specific force along the chip's axes.
    #[must_use]
    pub fn specific_force(&self, range: AccelRange) -> [MetersPerSecondSquared; 3] {
        let step = range.count_step().0;
        self.accel
            .map(|count| MetersPerSecondSquared(f32::from(count) * step))
    }

    /// Angular rate about the chip's axes.
    #[must_use]
    pub fn angular_rate(&self, range: GyroRange) -> [RadiansPerSecond; 3] {
        let step = range.count_step().0;
        self.gyro
            .map(|count| RadiansPerSecond(f32::from(count) * step))
    }

    /// Die temperature (RM-MPU-6000A, 4.18).
    #[must_use]
    pub fn die_temperature(&self) -> Celsius {
        Celsius(f32::from(self.temperature) / 340.0 + 36.53)
    }
}

const fn word(high: u8, low: u8) -> i16 {
    i16::from_be_bytes([high, low])
}
