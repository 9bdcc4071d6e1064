//! The battery of a simulated flight, and when it ends the flight.

use flight_dynamics::Drone;
use reflex::battery::BatteryState;

use super::battery_report::BatteryReport;
use super::flying_board::FlyingBoard;

/// Watches one battery; instants in ns.
#[derive(Debug, Default)]
pub(super) struct BatteryWatch {
    state: BatteryState,
    low_ns: Option<u64>,
    critical_ns: Option<u64>,
    empty_ns: Option<u64>,
    ended_ns: Option<u64>,
}

impl BatteryWatch {
    /// A step of the flight has ended.
    pub(super) fn look(&mut self, now_ns: u64, board: &dyn FlyingBoard, drone: &Drone) {
        self.state = board.battery();
        let note = |instant: &mut Option<u64>, is_so: bool| {
            if is_so {
                instant.get_or_insert(now_ns);
            }
        };
        let is_empty = drone.state().state_of_charge <= 0.0;
        note(&mut self.low_ns, self.state >= BatteryState::Low);
        note(&mut self.critical_ns, self.state >= BatteryState::Critical);
        note(&mut self.empty_ns, is_empty);
        let motors_stand = is_empty || !board.telemetry().state.is_armed();
        let is_over = drone.is_on_ground() && motors_stand;
        let is_over = is_over && self.is_nearly_empty();
        note(&mut self.ended_ns, is_over);
    }

    /// The drone comes down for it, or falls: what it does from here on is no flight to be scored.
    pub(super) fn is_nearly_empty(&self) -> bool {
        self.critical_ns.or(self.empty_ns).is_some()
    }

    /// It is empty.
    pub(super) fn is_empty(&self) -> bool {
        self.empty_ns.is_some()
    }

    /// The drone stands on the ground for it.
    pub(super) fn has_ended_the_flight(&self) -> bool {
        self.ended_ns.is_some()
    }

    /// What came of it; `since_take_off_s` says when an instant was.
    pub(super) fn report(
        &self,
        drone: &Drone,
        since_take_off_s: impl Fn(u64) -> f64,
    ) -> BatteryReport {
        let when = |instant: Option<u64>| instant.map(&since_take_off_s);
        BatteryReport {
            charge: drone.state().state_of_charge,
            volts: drone.voltage(),
            state: format!("{:?}", self.state).to_lowercase(),
            low_s: when(self.low_ns),
            critical_s: when(self.critical_ns),
            empty_s: when(self.empty_ns),
            ended_s: when(self.ended_ns),
        }
    }
}
