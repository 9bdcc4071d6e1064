//! Arming and the end of a flight: one table of states and events.
//!
//! Motors follow the control logic in every state from [`FlightState::Armed`] on; before, they
//! stand, but one that is tested. `docs/safety.md` shows the table.

use crate::numbered::numbered;

numbered! {
    /// Whether motors may turn, and who says what is flown.
    FlightState {
        /// The gyroscope's bias is not known yet: the drone has not stood still.
        Calibrating,
        /// Ready to be armed.
        Disarmed,
        /// Disarmed; one motor turns slowly, so that the pilot sees which.
        Testing,
        /// Motors turn; the drone has not left the ground, or stands on it again.
        Armed,
        /// In the air, as the pilot asks.
        Flying,
        /// In the air, the pilot is silent: level, or at the last goal.
        Waiting,
        /// The drone comes down by itself.
        Descending,
        /// In the air without a gyroscope: thrust, no torque.
        Blind,
    }
}

numbered! {
    /// What may change it.
    FlightEvent {
        /// The gyroscope's bias is known.
        Calibrated,
        /// The pilot asks for motors, and every check passed.
        Arm,
        /// The pilot asks for one motor, and it is one of the airframe's.
        TestMotor,
        /// The pilot asks for no motors.
        Disarm,
        /// The pilot insists: no motors, wherever the drone is.
        ForceDisarm,
        /// The kill switch of a transmitter.
        Kill,
        /// More thrust was asked for than keeps a drone on the ground.
        TookOff,
        /// At rest, though the thrust is far too low to hover.
        Landed,
        /// Setpoints and goals stopped.
        PilotSilent,
        /// They came again.
        PilotBack,
        /// The state lasted for as long as it may.
        TimeUp,
        /// The gyroscope is lost.
        ImuLost,
        /// The gyroscope is back.
        ImuBack,
        /// The drone lies over, or follows no command.
        Upset,
        /// The body does not answer the motors: too few turn, or it turns the other way.
        Unanswered,
        /// Several commands in a row were no numbers.
        NotFinite,
        /// The battery is nearly empty.
        BatteryEmpty,
    }
}

/// A disarm in the air needs force: without, it is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InTheAir;

impl FlightState {
    /// The state after an event.
    ///
    /// # Errors
    /// The pilot asked for no motors in the air, without force.
    pub fn after(self, event: FlightEvent) -> Result<Self, InTheAir> {
        use FlightEvent as On;
        Ok(match (self, event) {
            (Self::Calibrating, On::Calibrated) => Self::Disarmed,
            (Self::Disarmed, On::Arm) => Self::Armed,
            (Self::Disarmed, On::TestMotor) => Self::Testing,
            (Self::Disarmed | Self::Armed | Self::Testing, On::ImuLost) => Self::Calibrating,
            (Self::Calibrating | Self::Disarmed, _) => self,

            (Self::Testing, On::Disarm | On::ForceDisarm | On::Kill | On::TimeUp) => Self::Disarmed,
            (Self::Testing, On::BatteryEmpty | On::PilotSilent) => Self::Disarmed,
            (Self::Testing, _) => self,

            (_, On::ForceDisarm | On::Kill) => Self::Disarmed,
            (_, On::Upset | On::Unanswered | On::NotFinite) => Self::Disarmed,
            (Self::Armed, On::Disarm | On::PilotSilent | On::TimeUp | On::BatteryEmpty) => {
                Self::Disarmed
            }
            (Self::Armed, On::TookOff) => Self::Flying,
            (Self::Armed, _) => self,

            (_, On::Disarm) => return Err(InTheAir),
            (_, On::ImuLost) => Self::Blind,
            (Self::Flying, On::Landed) => Self::Armed,
            (_, On::Landed) => Self::Disarmed,
            (Self::Flying, On::PilotSilent) => Self::Waiting,
            (Self::Flying | Self::Waiting, On::BatteryEmpty) => Self::Descending,
            (Self::Waiting, On::TimeUp) => Self::Descending,
            (Self::Descending | Self::Blind, On::TimeUp) => Self::Disarmed,
            (Self::Waiting | Self::Descending, On::PilotBack) => Self::Flying,
            (Self::Blind, On::ImuBack) => Self::Flying,
            (Self::Flying | Self::Waiting | Self::Descending | Self::Blind, _) => self,
        })
    }

    /// True where motors follow the control logic.
    #[must_use]
    pub const fn is_armed(self) -> bool {
        !matches!(self, Self::Calibrating | Self::Disarmed | Self::Testing)
    }

    /// True where the drone has left the ground.
    #[must_use]
    pub const fn is_in_the_air(self) -> bool {
        self.is_armed() && !matches!(self, Self::Armed)
    }

    /// Its name for the pilot, of at most 24 letters.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Calibrating => "calibrating",
            Self::Disarmed => "disarmed",
            Self::Testing => "testing a motor",
            Self::Armed => "armed",
            Self::Flying => "flying",
            Self::Waiting => "waiting for the pilot",
            Self::Descending => "descending",
            Self::Blind => "blind: thrust only",
        }
    }
}

impl FlightEvent {
    /// Its name for the pilot, of at most 24 letters.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Calibrated => "gyroscope calibrated",
            Self::Arm => "armed by the pilot",
            Self::TestMotor => "asked by the pilot",
            Self::Disarm => "disarmed by the pilot",
            Self::ForceDisarm => "forced by the pilot",
            Self::Kill => "kill switch",
            Self::TookOff => "took off",
            Self::Landed => "landed",
            Self::PilotSilent => "pilot silent",
            Self::PilotBack => "pilot back",
            Self::TimeUp => "time is up",
            Self::ImuLost => "gyroscope lost",
            Self::ImuBack => "gyroscope back",
            Self::Upset => "lies over, or astray",
            Self::Unanswered => "motors are not answered",
            Self::NotFinite => "commands are no numbers",
            Self::BatteryEmpty => "battery nearly empty",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    /// A row for each event, a column for each state; a dash where it stays.
    fn table() -> String {
        let mut table = String::from("| event |");
        for state in FlightState::ALL {
            write!(table, " {state:?} |").expect("a string");
        }
        table += "\n|---|";
        table += &"---|".repeat(FlightState::COUNT);
        for event in FlightEvent::ALL {
            write!(table, "\n| {event:?} |").expect("a string");
            for state in FlightState::ALL {
                let after = match state.after(event) {
                    Err(InTheAir) => "refused".to_owned(),
                    Ok(after) if after == state => "-".to_owned(),
                    Ok(after) => format!("{after:?}"),
                };
                write!(table, " {after} |").expect("a string");
            }
        }
        table + "\n"
    }

    #[test]
    fn every_pair_of_state_and_event_is_decided_as_the_page_says() {
        let table = table();
        let page = include_str!("../../docs/safety.md");
        assert!(page.contains(&table), "docs/safety.md should show\n{table}");
    }

    #[test]
    fn motors_are_never_started_but_by_the_pilot_and_always_stopped_by_force() {
        for state in FlightState::ALL {
            for event in FlightEvent::ALL {
                let armed = state.after(event).is_ok_and(FlightState::is_armed);
                assert!(!armed || state.is_armed() || event == FlightEvent::Arm);
            }
            let forced = state.after(FlightEvent::ForceDisarm);
            assert!(!forced.expect("obeyed").is_armed());
        }
    }

    #[test]
    fn every_armed_state_but_one_that_is_flown_ends_by_itself() {
        for state in FlightState::ALL {
            let mut later = state;
            for _ in 0..FlightState::COUNT {
                later = later.after(FlightEvent::PilotSilent).unwrap_or(later);
                later = later.after(FlightEvent::TimeUp).unwrap_or(later);
            }
            assert!(!later.is_armed(), "{state:?} ends in {later:?}");
        }
    }
}
