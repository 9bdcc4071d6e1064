//! The small types of the door: faults, and orders to the chips.

pub use reflex_drivers::orders::{ChipAction, ChipSetting, OrderError};

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
        /// No sample of the inertial sensor for a failsafe period.
        ImuSilent,
        /// Far fewer samples of the inertial sensor came than were due.
        ImuStarved,
        /// Samples of the inertial sensor that no motion explains were dropped.
        ImuSpike,
        /// An axis of the gyroscope repeats itself to the last bit.
        GyroFrozen,
        /// An axis of the gyroscope stays at the end of its range.
        GyroRail,
        /// The gyroscope jumps as no motion does.
        GyroJumping,
        /// An axis of the inertial sensor's accelerometer repeats itself to the last bit.
        AccelFrozen,
        /// An axis of that accelerometer stays at the end of its range.
        AccelRail,
        /// That accelerometer jumps as no motion does.
        AccelJumping,
        /// Gyroscope and accelerometer contradict each other about the vertical.
        Implausible,
        /// The accelerometers of both chips contradict each other.
        AccelsApart,
        /// The magnetic field is not Earth's, or jumped: the heading is free.
        FieldBent,
        /// What passed for the gyroscope's bias is turning: calibrated anew.
        Turning,
        /// A motor gives no lift.
        MotorLost,
        /// The body turns against what motors are asked for: axes or signs of the gyroscope are
        /// wrong, or the places of the motors.
        Contrary,
        /// A run began a hyperperiod or more after it was due.
        LateRun,
        /// An order to a chip failed, on the bus or at the read-back.
        ChipBus,
        /// The chip of an input did not answer for two failsafe periods.
        ChipSilent(Input in Input::OF_CHIPS),
        /// The chip of an input repeats one sample, bit by bit.
        ChipStuck(Input in Input::OF_CHIPS),
        /// A setpoint, a goal, a pose or a model with a value that is not finite: not used.
        NotFinite,
        /// The control logic computed a command or an attitude that is not finite: it began anew.
        Command,
        /// The link's ring was overtaken: bytes were lost.
        LinkOverrun,
        /// A frame of the link was malformed, cut off or refused.
        LinkFrame,
        /// A goal that the logic cannot fly to, or without a fresh place: not used.
        Goal,
        /// Predicted commands missed twice in a row: they are foreseen exactly for a while.
        Prediction,
        /// The inertial sensor's bus flagged an error that the transfer did not notice.
        ImuGlitch,
        /// The inertial sensor's interrupt line fell silent: it is read by the clock.
        ImuLine,
        /// The inertial sensor's interrupt line told of a sample sooner than one can come.
        ImuEdge,
        /// A position was further from where motion leads than can be: not used.
        PlaceJump,
        /// The battery's voltage is lower than any load explains, or gone.
        BatteryCollapsed,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_has_the_number_of_its_place_those_of_chips_one_for_each() {
        for (place, fault) in Fault::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(fault.number()), place);
            assert_eq!(Fault::from_number(fault.number()), Some(fault));
        }
        assert_eq!(Fault::from_number(Fault::COUNT as u8), None);
        let of_chips = Input::OF_CHIPS.map(|input| Fault::ChipStuck(input).number());
        assert!(of_chips.is_sorted_by(|one, next| one + 1 == *next));
    }
}
