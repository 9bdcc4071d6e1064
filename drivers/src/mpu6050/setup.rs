//! Plain configuration of the chip and the register values that follow from it.

use super::{
    MotionDetector,
    register::{
        ACCEL_CONFIG, CONFIG, GYRO_CONFIG, INT_ENABLE, INT_PIN_CFG, MOT_DETECT_CTRL, MOT_DUR,
        MOT_THR, PWR_MGMT_1, PWR_MGMT_2, SMPLRT_DIV,
    },
};
use crate::quantity::{MetersPerSecondSquared, RadiansPerSecond, STANDARD_GRAVITY};

/// Awake, on the PLL of the gyro's X axis: steadier than the oscillator.
const AWAKE_ON_GYRO_CLOCK: u8 = 0x01;

/// Range of the gyro.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum GyroRange {
    /// +-250 deg/s.
    Dps250,
    /// +-500 deg/s.
    Dps500,
    /// +-1000 deg/s.
    Dps1000,
    /// +-2000 deg/s.
    Dps2000,
}

impl GyroRange {
    /// One count.
    #[must_use]
    pub const fn count_step(self) -> RadiansPerSecond {
        let counts_per_degree = match self {
            Self::Dps250 => 131.0,
            Self::Dps500 => 65.5,
            Self::Dps1000 => 32.8,
            Self::Dps2000 => 16.4,
        };
        RadiansPerSecond(core::f32::consts::PI / 180.0 / counts_per_degree)
    }

    const fn bits(self) -> u8 {
        (self as u8) << 3
    }
}

/// Range of the accelerometer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum AccelRange {
    /// +-2 g.
    G2,
    /// +-4 g.
    G4,
    /// +-8 g.
    G8,
    /// +-16 g.
    G16,
}

impl AccelRange {
    /// One count.
    #[must_use]
    pub const fn count_step(self) -> MetersPerSecondSquared {
        let counts_per_g = match self {
            Self::G2 => 16384.0,
            Self::G4 => 8192.0,
            Self::G8 => 4096.0,
            Self::G16 => 2048.0,
        };
        MetersPerSecondSquared(STANDARD_GRAVITY / counts_per_g)
    }

    pub(super) const fn bits(self) -> u8 {
        (self as u8) << 3
    }
}

/// Low-pass filter (DLPF_CFG), named by the gyro's bandwidth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum LowPass {
    /// 256 Hz; the gyro then samples at 8 kHz.
    Hz256,
    /// 188 Hz.
    Hz188,
    /// 98 Hz.
    Hz98,
    /// 42 Hz.
    Hz42,
    /// 20 Hz.
    Hz20,
    /// 10 Hz.
    Hz10,
    /// 5 Hz.
    Hz5,
}

/// What drives the INT pin, active high and push-pull.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum InterruptSource {
    /// A new sample.
    DataReady,
    /// The motion detector.
    Motion,
    /// Both.
    DataReadyAndMotion,
}

/// How long the INT pin stays high.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum InterruptPin {
    /// 50 us.
    Pulse,
    /// Until INT_STATUS is read.
    HeldUntilStatusRead,
}

/// The whole configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct ImuConfig {
    /// Range of the gyro.
    pub gyro_range: GyroRange,
    /// Range of the accelerometer.
    pub accel_range: AccelRange,
    /// Low-pass filter of both.
    pub low_pass: LowPass,
    /// SMPLRT_DIV: the sample rate is the gyro's rate divided by this plus one.
    pub rate_divider: u8,
    /// Motion detector; `None` zeroes its registers, so that it never fires.
    pub motion: Option<MotionDetector>,
    /// What drives the INT pin.
    pub interrupt: InterruptSource,
    /// How long it stays high.
    pub pin: InterruptPin,
}

impl ImuConfig {
    /// +-2000 deg/s, +-16 g, 98 Hz, a 50 us pulse at 1 kHz, no motion detector.
    pub const FLIGHT: Self = Self {
        gyro_range: GyroRange::Dps2000,
        accel_range: AccelRange::G16,
        low_pass: LowPass::Hz98,
        rate_divider: 0,
        motion: None,
        interrupt: InterruptSource::DataReady,
        pin: InterruptPin::Pulse,
    };

    /// Addresses and values in the order of writing: awake first, pin last.
    pub fn registers(&self) -> [(u8, u8); 11] {
        let [threshold, duration, control] = self.motion.map_or([0; 3], MotionDetector::bytes);
        [
            (PWR_MGMT_1, AWAKE_ON_GYRO_CLOCK),
            (PWR_MGMT_2, 0),
            (SMPLRT_DIV, self.rate_divider),
            (CONFIG, self.low_pass as u8),
            (GYRO_CONFIG, self.gyro_range.bits()),
            (ACCEL_CONFIG, self.accel_config()),
            (MOT_THR, threshold),
            (MOT_DUR, duration),
            (MOT_DETECT_CTRL, control),
            (INT_PIN_CFG, self.pin_config()),
            (INT_ENABLE, self.interrupt_enable()),
        ]
    }

    pub(super) fn accel_config(&self) -> u8 {
        self.accel_range.bits() | self.motion.map_or(0, |motion| motion.high_pass.bits())
    }

    const fn pin_config(&self) -> u8 {
        match self.pin {
            InterruptPin::Pulse => 0x00,
            InterruptPin::HeldUntilStatusRead => 0x20,
        }
    }

    const fn interrupt_enable(&self) -> u8 {
        match self.interrupt {
            InterruptSource::DataReady => 0x01,
            InterruptSource::Motion => 0x40,
            InterruptSource::DataReadyAndMotion => 0x41,
        }
    }
}
