//! The checks before arming, each with a name that the pilot is told.

use crate::numbered::numbered;

numbered! {
    /// Something that must be right before motors may turn.
    Check {
        /// The gyroscope's bias is known.
        Calibration,
        /// The inertial sensor delivers, and what it says is possible.
        Imu,
        /// The sensors hold the configuration that was written to them.
        Configuration,
        /// The body does not turn.
        Still,
        /// The specific force at rest is gravity.
        Gravity,
        /// The inertial sensor feels gravity from below.
        ImuMounting,
        /// The other chip feels it from where the inertial sensor does.
        ChipMounting,
        /// Estimate and gravity agree about the vertical.
        Level,
        /// The body is upright.
        Tilt,
        /// A pilot says what shall be flown, now.
        Setpoint,
        /// What shall be flown asks for no thrust yet.
        Thrust,
        /// No motor is being tested.
        MotorTest,
        /// The battery, where one is measured, is good for a flight.
        Battery,
        /// No reset that nobody asked for waits to be acknowledged.
        Reset,
        /// The body answered the motors, since the start.
        Motors,
        /// Nothing that was stored is missing unknown to the pilot.
        Store,
        /// Nothing is being stored.
        Storing,
        /// What reactive control learned are numbers.
        Models,
        /// The processor runs control in time.
        Load,
    }
}

impl Check {
    /// What is wrong, and the way out, in at most 39 letters: for the pilot.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Calibration => "gyroscope not calibrated, keep still",
            Self::Imu => "inertial sensor silent or implausible",
            Self::Configuration => "a sensor lost its configuration",
            Self::Still => "drone turns, keep still",
            Self::Gravity => "accelerometer is not near 1 g",
            Self::ImuMounting => "imu feels no gravity below, mounting?",
            Self::ChipMounting => "chip and imu feel gravity apart",
            Self::Level => "level and gravity disagree, keep still",
            Self::Tilt => "tilted, set level or check mounting",
            Self::Setpoint => "no fresh setpoint, nor goal and place",
            Self::Thrust => "setpoint asks for thrust, lower it",
            Self::MotorTest => "a motor is being tested",
            Self::Battery => "battery low, charge it",
            Self::Reset => "reset by itself, disarm to acknowledge",
            Self::Motors => "motors were not answered, restart",
            Self::Store => "settings lost, disarm to acknowledge",
            Self::Storing => "settings are being stored, wait",
            Self::Models => "a learned model is no number, restart",
            Self::Load => "processor runs control late",
        }
    }
}

/// Checks that failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Checks(u32);

impl Checks {
    /// None failed.
    pub const NONE: Self = Self(0);

    /// With one more, where it did not pass.
    #[must_use]
    pub fn and(self, check: Check, passed: bool) -> Self {
        Self(self.0 | u32::from(!passed) << check.number())
    }

    /// True where none failed.
    #[must_use]
    pub const fn all_passed(self) -> bool {
        self.0 == 0
    }

    /// Those that failed, in the order in which a pilot looks after them.
    pub fn failed(self) -> impl Iterator<Item = Check> {
        let all = Check::ALL.into_iter();
        all.filter(move |check| self.0 >> check.number() & 1 == 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_a_row_for_each_and_no_other() {
        let page = include_str!("../../docs/safety.md");
        let (_, table) = page
            .split_once("| check | passes where |\n|---|---|\n")
            .expect("it");
        let rows = table.lines().take_while(|line| line.starts_with('|'));
        let names = rows.filter_map(|row| row.split(" | ").next());
        let checks = Check::ALL.map(|check| format!("| {check:?}"));
        assert_eq!(names.collect::<Vec<_>>(), checks);
    }

    #[test]
    fn those_that_failed_are_told_one_by_one() {
        let checks = Checks::NONE
            .and(Check::Tilt, false)
            .and(Check::Still, true)
            .and(Check::Load, false);
        assert!(!checks.all_passed());
        assert_eq!(
            checks.failed().collect::<Vec<_>>(),
            [Check::Tilt, Check::Load]
        );
        assert!(Checks::NONE.and(Check::Tilt, true).all_passed());
    }
}
