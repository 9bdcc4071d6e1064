//! What stands between the control logic and the motors.

mod checks;
mod flight_state;
mod motor_gate;
mod watch;

pub use checks::{Check, Checks};
pub use flight_state::{FlightEvent, FlightState, InTheAir};
pub use motor_gate::{MotorGate, MotorOutput};
pub use watch::Seen;

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

    /// The mean thrust that was flown: about that of hovering.
    #[must_use]
    pub fn mean_thrust(&self) -> Thrust {
        self.watch.mean_thrust()
    }

    /// The thrust of a descent that sees no place.
    #[must_use]
    pub fn descent_thrust(&self) -> Thrust {
        self.watch.descent_thrust()
    }
}
