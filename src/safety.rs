//! What stands between the control logic and the motors.

mod checks;
mod flight_state;
mod ground;
mod hold;
mod motor_gate;
mod seen;
mod watch;

pub use checks::{Check, Checks};
pub use flight_state::{FlightEvent, FlightState, InTheAir};
pub use motor_gate::{MotorGate, MotorOutput};
pub use seen::Seen;

use crate::airframe::MotorShares;
use crate::config::MOTOR_TEST_TIME;
use crate::control::MotorTest;
use crate::time::Instant;
use crate::units::Thrust;
use watch::Watch;

/// The state of the flight, the gate that follows it, and the watch for its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Safety {
    state: FlightState,
    gate: MotorGate,
    watch: Watch,
    test: Option<MotorTest>,
    /// Motors that were lost since the start, a bit for each.
    lost: u8,
}

/// What the gate made of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// What is to be written to the motors.
    pub output: MotorOutput,
    /// The command that was applied until now.
    pub before: MotorShares,
    /// How many commands in a row, with this one, were refused because they were not finite.
    pub refused: u32,
}

impl Safety {
    /// Not calibrated, with so many motors that stand.
    #[must_use]
    pub fn new(motors: usize) -> Self {
        Self {
            state: FlightState::Calibrating,
            gate: MotorGate::new(motors),
            watch: Watch::default(),
            test: None,
            lost: 0,
        }
    }

    /// The state of the flight.
    #[must_use]
    pub fn state(&self) -> FlightState {
        self.state
    }

    /// True where motors follow the control logic.
    #[must_use]
    pub fn is_armed(&self) -> bool {
        self.state.is_armed()
    }

    /// The command that the motors hold.
    #[must_use]
    pub fn applied(&self) -> &MotorShares {
        self.gate.applied()
    }

    /// Moves the state; the new one where it differs.
    ///
    /// # Errors
    /// A disarm in the air without force.
    pub fn on_event(
        &mut self,
        event: FlightEvent,
        now: Instant,
    ) -> Result<Option<FlightState>, InTheAir> {
        let state = self.state.after(event)?;
        let differs = state != self.state;
        if differs {
            self.state = state;
            self.watch.begin(state, now);
        }
        Ok(differs.then_some(state))
    }

    /// A motor of the airframe is to be tested: what [`FlightState::Testing`] turns.
    pub fn plan_test(&mut self, now: Instant, test: &MotorTest) {
        self.test = Some(*test);
        self.watch.begin_test(now, test.length.min(MOTOR_TEST_TIME));
    }

    /// What a run sees; an event where it ends the state.
    pub fn watch(&mut self, seen: &Seen) -> Option<FlightEvent> {
        self.watch.take(self.state, seen)
    }

    /// A motor was lost, from 0; how many are left.
    pub fn lose(&mut self, motor: u8) -> u32 {
        self.lost |= 1u8.checked_shl(u32::from(motor)).unwrap_or(0);
        (self.applied().len() as u32).saturating_sub(self.lost.count_ones())
    }

    /// True once a motor was lost.
    #[must_use]
    pub fn has_lost_motors(&self) -> bool {
        self.lost != 0
    }

    /// Lets a command pass, as the state allows.
    pub fn pass(&mut self, command: &MotorShares) -> Passed {
        let before = *self.gate.applied();
        let tested = self.test.filter(|_| self.state == FlightState::Testing);
        Passed {
            output: match &tested {
                Some(test) => self.gate.test(test),
                None => self.gate.pass(self.is_armed(), command),
            },
            before,
            refused: self.gate.refused_in_a_row(),
        }
    }

    /// True where the drone has left the ground for certain.
    #[must_use]
    pub fn flies(&self) -> bool {
        self.watch.flies()
    }

    /// The thrust of a drone without pilot and place, which sinks so fast (m/s), if that is known:
    /// in [`FlightState::Waiting`] it stays, in [`FlightState::Descending`] it comes down.
    pub fn thrust_alone(&mut self, now: Instant, sinking: Option<f32>) -> Thrust {
        self.watch.thrust_alone(self.state, now, sinking)
    }
}
