//! The reference board's wiring: crystal, buses, interrupt lines, motors.
//!
//! What `src/board/reflex_f427` tells the firmware is said here once more, by the schematic: the
//! emulator finds a firmware that uses another pin.

use chip_models::{DIES, OfDies};

use crate::motors::MOTORS;

/// Crystal on the oscillator pins, in Hz.
pub(super) const CRYSTAL_HZ: u64 = 8_000_000;

/// Timers whose channels 1 to 4 drive motors, in the order of the motors.
pub(super) const MOTOR_TIMERS: [&str; 2] = ["TIM3", "TIM4"];

/// Port of every interrupt line, and its number in SYSCFG_EXTICR.
pub(super) const LINE_PORT: &str = "GPIOC";
pub(super) const LINE_PORT_NUMBER: usize = 2;

/// The inertial sensor's bus, its port with the pins of clock and data, which resistors pull up, and
/// the stream of DMA1 that serves it.
pub(super) const IMU_BUS: &str = "I2C1";
pub(super) const IMU_PORT: &str = "GPIOB";
pub(super) const IMU_SCL: u8 = 8;
pub(super) const IMU_SDA: u8 = 9;
pub(super) const IMU_STREAM: usize = 0;

/// Places of SPI1 and USART2 among the emulator's: the bus of the other chips, and the link.
pub(super) const CHIPS_SPI: usize = 0;
pub(super) const LINK_USART: usize = 1;

/// The converter of the battery, ADC1, and the channels of its pins PC3 and PC5.
pub(super) const BATTERY_ADC: usize = 0;
pub(super) const BATTERY_CHANNELS: [u8; 2] = [13, 15];

/// Chip selects of the dies with clocks of their own.
pub(super) const SELECTS: OfDies<Wire> = [
    Wire::new("accelerometer select", "GPIOA", 4, Use::Output),
    Wire::new("magnetometer select", "GPIOC", 4, Use::Output),
];

/// An interrupt line from a sensor to the processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SensorLine {
    /// MPU6050 INT on PC0.
    ImuReady,
    /// LSM303AGR INT_1_XL on PC1.
    AccelThreshold,
    /// LSM303AGR INT_MAG on PC2.
    MagEvent,
}

impl SensorLine {
    /// Every line, in the order of its pin.
    pub const ALL: [Self; 1 + DIES.len()] = [Self::ImuReady, Self::AccelThreshold, Self::MagEvent];

    /// The line of each die with a clock of its own.
    pub const OF_DIES: OfDies<Self> = [Self::AccelThreshold, Self::MagEvent];

    /// The pin of `LINE_PORT` that the line is wired to, and with it its EXTI line.
    pub const fn pin(self) -> u8 {
        match self {
            Self::ImuReady => 0,
            Self::AccelThreshold => 1,
            Self::MagEvent => 2,
        }
    }

    /// The wire that is the line.
    pub(super) const fn wire(self) -> Wire {
        Wire::new(self.name(), LINE_PORT, self.pin(), Use::Input)
    }

    /// The chip and pin that drive the line, as the datasheets name them.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ImuReady => "MPU6050 INT",
            Self::AccelThreshold => "LSM303AGR INT_1_XL",
            Self::MagEvent => "LSM303AGR INT_MAG",
        }
    }
}

/// How a pin must be configured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    Input,
    Output,
    /// Alternate function, and whether its output stage is open drain.
    Alternate {
        number: u64,
        open_drain: bool,
    },
}

/// A wire: what it is, and the pin it ends at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wire {
    pub(super) signal: &'static str,
    pub(super) port: &'static str,
    pub(super) pin: u8,
    pub(super) uses: Use,
}

impl Wire {
    const fn new(signal: &'static str, port: &'static str, pin: u8, uses: Use) -> Self {
        Self {
            signal,
            port,
            pin,
            uses,
        }
    }
}

const fn function(number: u64) -> Use {
    Use::Alternate {
        number,
        open_drain: false,
    }
}

const I2C: Use = Use::Alternate {
    number: 4,
    open_drain: true,
};

/// Wires of the buses and the link.
const BUSES: [Wire; 7] = [
    Wire::new("SPI1_SCK", "GPIOA", 5, function(5)),
    Wire::new("SPI1_MISO", "GPIOA", 6, function(5)),
    Wire::new("SPI1_MOSI", "GPIOA", 7, function(5)),
    Wire::new("I2C1_SCL", IMU_PORT, IMU_SCL, I2C),
    Wire::new("I2C1_SDA", IMU_PORT, IMU_SDA, I2C),
    Wire::new("USART2_TX", "GPIOD", 5, function(7)),
    Wire::new("USART2_RX", "GPIOD", 6, function(7)),
];

/// Wires of which the firmware configures the pin, but for those of motors.
pub(super) fn wires() -> impl Iterator<Item = Wire> {
    let lines = SensorLine::ALL.map(SensorLine::wire);
    BUSES.into_iter().chain(SELECTS).chain(lines)
}

/// Motors 1 to 4 leave on PC6 to PC9, motors 5 to 8 on PD12 to PD15.
pub(super) fn motor_wire(motor: usize) -> Wire {
    const SIGNALS: [&str; MOTORS] = [
        "TIM3_CH1", "TIM3_CH2", "TIM3_CH3", "TIM3_CH4", "TIM4_CH1", "TIM4_CH2", "TIM4_CH3",
        "TIM4_CH4",
    ];
    let (port, pin) = match motor {
        0..4 => ("GPIOC", 6 + motor as u8),
        _ => ("GPIOD", 8 + motor as u8),
    };
    Wire::new(SIGNALS[motor], port, pin, function(2))
}
