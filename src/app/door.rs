//! The small types of the door: faults, and orders to the chips.

use crate::numbered::numbered;

numbered! {
    /// What can go wrong outside the portable code.
    Fault {
        /// The MPU6050's bus reported an error, or hung and was recovered.
        ImuBus,
        /// A sample was due before the one before had been received: a slow or hung bus.
        ImuOverrun,
        /// A burst repeated an old sample.
        ImuStale,
        /// A sample's stamp went back, or came over 20 ms behind the one before.
        ImuJump,
        /// The MPU6050's configuration is not what was written.
        ImuConfiguration,
        /// No MPU6050 sample for two failsafe periods.
        ImuSilent,
        /// The MPU6050 repeated one sample, bit by bit, for two failsafe periods.
        ImuStuck,
        /// A run began a hyperperiod or more after it was due.
        LateRun,
        /// An order to the LSM303AGR failed, on the bus or at the read-back.
        ChipBus,
        /// The LSM303AGR's accelerometer did not answer for two failsafe periods.
        AccelSilent,
        /// The LSM303AGR's magnetometer did not answer for two failsafe periods.
        MagSilent,
        /// The LSM303AGR's accelerometer repeats one sample, bit by bit.
        AccelStuck,
        /// The LSM303AGR's magnetometer repeats one sample, bit by bit.
        MagStuck,
        /// A setpoint, a goal, a pose or a model with a value that is not finite: not used.
        NotFinite,
        /// The control logic came to a command that is not finite: the applied one stayed.
        Command,
        /// The link's ring was overtaken: bytes were lost.
        LinkOverrun,
        /// A frame of the link was malformed, cut off or refused.
        LinkFrame,
        /// A goal that the logic cannot fly to, or without a fresh place: not used.
        Goal,
    }
}

/// What the LSM303AGR shall do next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum ChipOrder {
    /// Interrupt at every accelerometer sample.
    AccelDataReady,
    /// Interrupt past this threshold code, 1 to 127; read back and check.
    AccelThreshold(u8),
    /// Make the present accelerometer sample the reference, and deliver it.
    AccelRearm,
    /// Interrupt at every magnetometer sample.
    MagDataReady,
    /// Interrupt past this threshold code; read back and check.
    MagThreshold(u16),
    /// Make the present magnetometer sample the reference, and deliver it.
    MagRearm,
    /// Deliver an accelerometer sample and check the programmed threshold.
    AccelHeartbeat,
    /// Deliver a magnetometer sample and check the programmed threshold.
    MagHeartbeat,
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
