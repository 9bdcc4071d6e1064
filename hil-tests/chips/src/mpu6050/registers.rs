//! Register map of the MPU6050 and what its configuration means.
//!
//! Source: RM-MPU-6000A rev. 4.2, and rev. 3.2 for the motion detector, whose
//! bits later revisions hide (ACCEL_HPF, MOT_DUR, MOT_DETECT_CTRL and STATUS).

use crate::register_file::{Map, RegisterFile};

pub const SMPLRT_DIV: u8 = 0x19;
pub const CONFIG: u8 = 0x1A;
pub const GYRO_CONFIG: u8 = 0x1B;
pub const ACCEL_CONFIG: u8 = 0x1C;
pub const MOT_THR: u8 = 0x1F;
pub const MOT_DUR: u8 = 0x20;
pub const INT_PIN_CFG: u8 = 0x37;
pub const INT_ENABLE: u8 = 0x38;
pub const INT_STATUS: u8 = 0x3A;
pub const ACCEL_XOUT_H: u8 = 0x3B;
pub const GYRO_ZOUT_L: u8 = 0x48;
pub const MOT_DETECT_STATUS: u8 = 0x61;
pub const SIGNAL_PATH_RESET: u8 = 0x68;
pub const MOT_DETECT_CTRL: u8 = 0x69;
pub const USER_CTRL: u8 = 0x6A;
pub const PWR_MGMT_1: u8 = 0x6B;
pub const PWR_MGMT_2: u8 = 0x6C;
pub const WHO_AM_I: u8 = 0x75;

/// WHO_AM_I: the I2C address with the AD0 bit taken as zero.
pub const IDENTITY: u8 = 0x68;
/// INT_ENABLE and INT_STATUS: a new set of samples.
pub const DATA_READY: u8 = 0x01;
/// INT_ENABLE and INT_STATUS: the motion counter reached its duration.
pub const MOTION: u8 = 0x40;

const SLEEP: u8 = 0x40;
const DEVICE_RESET: u8 = 0x80;
const SIGNAL_RESET: u8 = 0x01;

/// The map of the MPU6050, as far as it is modelled.
#[derive(Clone, Debug)]
pub struct Mpu6050Map;

/// The registers that a master sees.
pub type Registers = RegisterFile<Mpu6050Map>;

impl Map for Mpu6050Map {
    const ADDRESSES: u8 = 0x7F;

    /// Asleep.
    const AT_RESET: &'static [(u8, u8)] = &[(PWR_MGMT_1, SLEEP), (WHO_AM_I, IDENTITY)];

    fn writable(address: u8) -> u8 {
        match address {
            0x0D..=0x19 | 0x1D..=0x35 => 0xFF,
            CONFIG => 0x3F,
            GYRO_CONFIG => 0xF8,
            ACCEL_CONFIG => 0xFF,
            INT_PIN_CFG => 0xFE,
            INT_ENABLE => 0xF9,
            0x63..=0x67 => 0xFF,
            // SIGNAL_PATH_RESET and the reset bits of the others clear themselves.
            MOT_DETECT_CTRL => 0x3F,
            USER_CTRL => 0xF0,
            PWR_MGMT_1 => 0x6F,
            PWR_MGMT_2 => 0xFF,
            0x6D..=0x71 => 0xFF,
            _ => 0,
        }
    }
}

/// What a write asks for beyond storing the byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Nothing: the byte is stored.
    None,
    /// PWR_MGMT_1: all registers back to their reset values.
    DeviceReset,
    /// USER_CTRL or SIGNAL_PATH_RESET: filters and sensor registers cleared.
    SignalReset,
}

/// The self-clearing commands in a write.
pub fn command(address: u8, value: u8) -> Command {
    match address {
        PWR_MGMT_1 if value & DEVICE_RESET != 0 => Command::DeviceReset,
        USER_CTRL if value & SIGNAL_RESET != 0 => Command::SignalReset,
        SIGNAL_PATH_RESET if value & 0x07 != 0 => Command::SignalReset,
        _ => Command::None,
    }
}

/// Where the chip takes its clock from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClockSource {
    /// Internal 8 MHz relaxation oscillator; also where no clock is wired.
    Relaxation,
    /// A PLL locked to one of the gyroscopes.
    Gyro,
    /// CLKSEL 7: the clock stands and nothing is sampled.
    Stopped,
}

/// The configuration that sampling and motion detection work with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Not in sleep.
    pub awake: bool,
    /// Source of the internal clock.
    pub clock: ClockSource,
    /// DLPF_CFG, 0..=6; the reserved 7 acts as 0.
    pub low_pass: u8,
    /// Internal 8 kHz ticks per output sample.
    pub divider: u64,
    /// Counts per degree per second.
    pub gyro_counts: f64,
    /// Counts per g.
    pub accel_counts: f64,
    /// ACCEL_HPF, 0..=7.
    pub high_pass: u8,
    /// PWR_MGMT_2: standby bits XA YA ZA XG YG ZG, bit 5 first.
    pub standby: u8,
    /// PWR_MGMT_1: the temperature sensor is off.
    pub temperature_off: bool,
}

impl Setup {
    /// Reads the configuration out of the registers.
    pub fn of(registers: &Registers) -> Self {
        let power = registers.get(PWR_MGMT_1);
        let low_pass = registers.get(CONFIG) & 0x07;
        let low_pass = if low_pass == 7 { 0 } else { low_pass };
        let rate_divider = u64::from(registers.get(SMPLRT_DIV)) + 1;
        Self {
            awake: power & SLEEP == 0,
            clock: match power & 0x07 {
                1..=3 => ClockSource::Gyro,
                7 => ClockSource::Stopped,
                _ => ClockSource::Relaxation,
            },
            low_pass,
            // The gyroscope's output rate is 8 kHz without the filter, else 1 kHz.
            divider: rate_divider * if low_pass == 0 { 1 } else { 8 },
            gyro_counts: [131.0, 65.5, 32.8, 16.4][range(registers, GYRO_CONFIG)],
            accel_counts: [16_384.0, 8_192.0, 4_096.0, 2_048.0][range(registers, ACCEL_CONFIG)],
            high_pass: registers.get(ACCEL_CONFIG) & 0x07,
            standby: registers.get(PWR_MGMT_2) & 0x3F,
            temperature_off: power & 0x08 != 0,
        }
    }
}

fn range(registers: &Registers, address: u8) -> usize {
    usize::from(registers.get(address) >> 3 & 0x03)
}
