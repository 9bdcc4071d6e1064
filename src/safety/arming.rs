//! The arming state: a table of (state, event) to state.

/// Whether motors may turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Arming {
    /// The gyroscope's bias is not known yet: the drone has not stood still.
    #[default]
    Calibrating,
    /// Ready to be armed.
    Disarmed,
    /// Motors follow the control logic.
    Armed,
}

/// What may change it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmingEvent {
    /// The gyroscope's bias is known.
    Calibrated,
    /// The peer asks for motors.
    Arm,
    /// The peer asks for no motors. Always obeyed.
    Disarm,
    /// The gyroscope fell silent on the ground.
    ImuLost,
}

/// Why arming was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Refusal {
    /// Keep the drone still: the gyroscope is being calibrated.
    NotCalibrated,
    /// Set the drone upright, or check how its sensors are mounted.
    Tilted,
}

impl Arming {
    /// The state after an event, or why it stays.
    ///
    /// # Errors
    /// The reason for which an arm command is refused.
    pub fn after(self, event: ArmingEvent) -> Result<Self, Refusal> {
        match (self, event) {
            (Self::Calibrating, ArmingEvent::Calibrated) => Ok(Self::Disarmed),
            (Self::Calibrating, ArmingEvent::Arm) => Err(Refusal::NotCalibrated),
            (Self::Disarmed | Self::Armed, ArmingEvent::Arm) => Ok(Self::Armed),
            (Self::Disarmed | Self::Armed, ArmingEvent::Disarm) => Ok(Self::Disarmed),
            (Self::Disarmed, ArmingEvent::ImuLost) => Ok(Self::Calibrating),
            // In the air without a gyroscope the motors are still the pilot's only hope.
            (Self::Armed, ArmingEvent::ImuLost) => Ok(Self::Armed),
            (state, ArmingEvent::Calibrated)
            | (state @ Self::Calibrating, ArmingEvent::Disarm | ArmingEvent::ImuLost) => Ok(state),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_of_state_and_event_is_decided() {
        use Arming::{Armed, Calibrating, Disarmed};
        use ArmingEvent::{Arm, Calibrated, Disarm, ImuLost};
        let table = [
            (Calibrating, Calibrated, Ok(Disarmed)),
            (Calibrating, Arm, Err(Refusal::NotCalibrated)),
            (Calibrating, Disarm, Ok(Calibrating)),
            (Calibrating, ImuLost, Ok(Calibrating)),
            (Disarmed, Calibrated, Ok(Disarmed)),
            (Disarmed, Arm, Ok(Armed)),
            (Disarmed, Disarm, Ok(Disarmed)),
            (Disarmed, ImuLost, Ok(Calibrating)),
            (Armed, Calibrated, Ok(Armed)),
            (Armed, Arm, Ok(Armed)),
            (Armed, Disarm, Ok(Disarmed)),
            (Armed, ImuLost, Ok(Armed)),
        ];
        for (state, event, after) in table {
            assert_eq!(state.after(event), after, "{state:?}, {event:?}");
        }
    }
}
