//! The small types of the door: faults, and orders to the chips.

use crate::numbered::numbered;
use crate::sensors::Input;

numbered! {
    /// What can go wrong outside the portable code.
    Fault {
        /// The inertial sensor's bus reported an error, or hung and was recovered.
        ImuBus,
        /// A sample was due before the one before had been received: a slow or hung bus.
        ImuOverrun,
        /// A sample was read twice.
        ImuStale,
        /// A sample's stamp went back, or came over 20 ms behind the one before.
        ImuJump,
        /// The inertial sensor's configuration is not what was written.
        ImuConfiguration,
        /// No sample of the inertial sensor for two failsafe periods.
        ImuSilent,
        /// The inertial sensor repeated one sample, bit by bit, for two failsafe periods.
        ImuStuck,
        /// A run began a hyperperiod or more after it was due.
        LateRun,
        /// An order to a chip failed, on the bus or at the read-back.
        ChipBus,
        /// The accelerometer that compares did not answer for two failsafe periods.
        AccelSilent,
        /// The magnetometer that compares did not answer for two failsafe periods.
        MagSilent,
        /// The accelerometer that compares repeats one sample, bit by bit.
        AccelStuck,
        /// The magnetometer that compares repeats one sample, bit by bit.
        MagStuck,
        /// A setpoint, a goal, a pose or a model with a value that is not finite: not used.
        NotFinite,
        /// The control logic computed a command that is not finite: the applied one stayed.
        Command,
        /// The link's ring was overtaken: bytes were lost.
        LinkOverrun,
        /// A frame of the link was malformed, cut off or refused.
        LinkFrame,
        /// A goal that the logic cannot fly to, or without a fresh place: not used.
        Goal,
    }
}

impl Fault {
    /// The sensor behind an input fell silent.
    pub(super) fn silent(input: Input) -> Self {
        match input {
            Input::Gyro | Input::Accel | Input::Turned | Input::Command => Self::ImuSilent,
            Input::ChipAccel => Self::AccelSilent,
            Input::ChipMag => Self::MagSilent,
        }
    }

    /// The sensor behind an input repeats one sample.
    pub(super) fn stuck(input: Input) -> Self {
        match input {
            Input::Gyro | Input::Accel | Input::Turned | Input::Command => Self::ImuStuck,
            Input::ChipAccel => Self::AccelStuck,
            Input::ChipMag => Self::MagStuck,
        }
    }
}

/// An order to a chip that interrupts by itself: what it shall do next.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct ChipOrder {
    /// The input that the chip delivers.
    pub input: Input,
    /// What it shall do.
    pub action: ChipAction,
}

/// What a chip can be ordered to do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum ChipAction {
    /// Interrupt at every sample.
    DataReady,
    /// Interrupt past this change since the reference, in the input's SI unit; read back and
    /// check. The chip's driver rounds it down; it has a chip that cannot hold so fine a
    /// threshold interrupt at every sample.
    Threshold(f32),
    /// Make the present sample the reference, and deliver it.
    Rearm,
    /// Deliver a sample and check what is programmed.
    Heartbeat,
}

/// What a chip interrupts for: its answer to an order.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum ChipSetting {
    /// Every sample, which also serves every threshold below `finest`.
    EverySample {
        /// The finest threshold that the chip holds, in the input's SI unit.
        finest: f32,
    },
    /// A change past `level`, which serves every threshold from `level` to below `next`.
    PastThreshold {
        /// The threshold that was programmed, in the input's SI unit.
        level: f32,
        /// The next one that the chip holds; infinite behind its largest.
        next: f32,
    },
}

impl ChipSetting {
    /// True where the chip compares.
    #[must_use]
    pub fn compares(self) -> bool {
        matches!(self, Self::PastThreshold { .. })
    }

    /// True where this setting is also the one for another threshold.
    #[must_use]
    pub fn serves(self, threshold: f32) -> bool {
        match self {
            Self::EverySample { finest } => threshold < finest,
            Self::PastThreshold { level, next } => (level..next).contains(&threshold),
        }
    }
}

/// Why an order failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum OrderError {
    /// The bus reported an error.
    Bus,
    /// A register does not hold what was written.
    ReadBack {
        /// Its address.
        register: u8,
        /// What was written.
        wrote: u8,
        /// What it holds.
        read: u8,
    },
    /// The chip is not the one expected.
    Identity,
}
