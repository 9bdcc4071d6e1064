//! What the pilot is told: states, refusals, silences, with their reasons.

use super::demand::Silence;
use crate::battery::BatteryState;
use crate::link::{Notice, Severity};
use crate::safety::{Check, FlightEvent, FlightState};
use crate::settings::MOST_MOTORS;

/// The state of the flight changed, and why.
pub(super) const fn flight(state: FlightState, event: FlightEvent) -> Notice {
    use FlightEvent as On;
    let severity = match (state, event) {
        (FlightState::Descending | FlightState::Blind, _)
        | (_, On::Upset | On::Unanswered | On::NotFinite | On::ImuLost | On::BatteryEmpty) => {
            Severity::Critical
        }
        (FlightState::Waiting, _) | (_, On::TimeUp) => Severity::Warning,
        _ => Severity::Info,
    };
    Notice::new(severity, state.name(), event.name())
}

/// Motors were not armed: one of the checks that failed.
pub(super) const fn not_armed(check: Check) -> Notice {
    Notice::new(Severity::Warning, "not armed", check.text())
}

/// Motors were not disarmed.
pub(super) const NOT_DISARMED: Notice = Notice::new(
    Severity::Warning,
    "not disarmed",
    "in the air, needs force (21196)",
);

/// Something was measured at rest.
pub(super) const CALIBRATED: Notice = Notice::new(Severity::Info, "calibrated", "in force");

/// Why nothing was measured.
pub(super) const CALIBRATE_ARMED: Notice = not_calibrated("motors may turn");
/// As above.
pub(super) const CALIBRATE_MOVING: Notice = not_calibrated("keep still and ask again");
/// As above.
pub(super) const CALIBRATE_SLANTED: Notice = not_calibrated("further than 0.1 g from level");

const fn not_calibrated(why: &'static str) -> Notice {
    Notice::new(Severity::Warning, "not calibrated", why)
}

/// Something that the drone is flown by stopped.
pub(super) const fn silent(silence: Silence) -> Notice {
    let why = match silence {
        Silence::Setpoint => "no setpoints",
        Silence::Goal => "no goals, the last one is held",
        Silence::Place => "no places, level instead of a goal",
    };
    Notice::new(Severity::Warning, "silent", why)
}

/// A motor gives no lift.
pub(super) fn motor_lost(motor: u8) -> Notice {
    const NUMBERS: [&str; MOST_MOTORS] = ["1", "2", "3", "4", "5", "6", "7", "8"];
    let number = NUMBERS.get(usize::from(motor)).copied();
    Notice::new(Severity::Critical, "no lift, motor", number.unwrap_or("?"))
}

/// The body turns the other way.
pub(super) const CONTRARY: Notice = Notice::new(
    Severity::Critical,
    "turns the wrong way",
    "check axes, motor order",
);

/// The battery is fuller or emptier than it was.
pub(super) const fn battery(state: BatteryState) -> Notice {
    let (severity, why) = match state {
        BatteryState::Unmeasured => (Severity::Info, "not measured"),
        BatteryState::Good => (Severity::Info, "good"),
        BatteryState::Low => (Severity::Warning, "low, land"),
        BatteryState::Critical => (Severity::Critical, "nearly empty"),
    };
    Notice::new(severity, "battery", why)
}

/// The voltage is lower than any load explains, or gone.
pub(super) const BATTERY_COLLAPSED: Notice =
    Notice::new(Severity::Critical, "battery", "collapsed, land");

/// The source of places moved its frame.
pub(super) const PLACE_RESET: Notice =
    Notice::new(Severity::Info, "places reset", "the goal moves along");

/// A place was left out, and the ones like it may follow.
pub(super) const PLACE_JUMPED: Notice = Notice::new(Severity::Warning, "place jumped", "not used");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_notice_fits_into_one_message() {
        let flights = FlightState::ALL.into_iter().flat_map(|state| {
            let events = FlightEvent::ALL.into_iter();
            events.map(move |event| flight(state, event))
        });
        let silences = [Silence::Setpoint, Silence::Goal, Silence::Place].map(silent);
        let all = flights
            .chain(Check::ALL.map(not_armed))
            .chain(silences)
            .chain((0..=8).map(motor_lost))
            .chain([
                NOT_DISARMED,
                CONTRARY,
                PLACE_RESET,
                PLACE_JUMPED,
                BATTERY_COLLAPSED,
            ])
            .chain([
                CALIBRATED,
                CALIBRATE_ARMED,
                CALIBRATE_MOVING,
                CALIBRATE_SLANTED,
            ]);
        for notice in all {
            let line: Vec<u8> = notice.line().collect();
            assert!(
                line.is_ascii() && line.len() <= Notice::LONGEST,
                "{notice:?}"
            );
        }
    }
}
