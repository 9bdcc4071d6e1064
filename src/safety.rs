//! What stands between the control logic and the motors.

mod arming;
mod motor_gate;

pub use arming::{Arming, ArmingEvent, Refusal};
pub use motor_gate::{MotorGate, MotorOutput};

use crate::airframe::MotorShares;
use crate::math::Vec3;

/// Cosine of the tilt beyond which arming is refused: 60 degrees.
///
/// A drone that lies on its side, or whose chips are mounted another way than face down, would
/// turn over.
const LEAST_UPRIGHT: f32 = 0.5;

/// The arming state, and the gate that follows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Safety {
    arming: Arming,
    gate: MotorGate,
}

/// What the gate made of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// What is to be written to the motors.
    pub output: MotorOutput,
    /// The command that was applied until now.
    pub before: MotorShares,
    /// The command was not finite: the applied one stays.
    pub refused: bool,
}

impl Safety {
    /// Not calibrated, with so many motors that stand.
    #[must_use]
    pub fn new(motors: usize) -> Self {
        Self {
            arming: Arming::default(),
            gate: MotorGate::new(motors),
        }
    }

    /// The arming state.
    #[must_use]
    pub fn arming(&self) -> Arming {
        self.arming
    }

    /// True where motors follow the control logic.
    #[must_use]
    pub fn is_armed(&self) -> bool {
        self.arming == Arming::Armed
    }

    /// The command that the motors hold.
    #[must_use]
    pub fn applied(&self) -> &MotorShares {
        self.gate.applied()
    }

    /// Arms, unless the drone is tilted; `down` points down, of length 1, in body axes.
    ///
    /// # Errors
    /// Why it is refused.
    pub fn arm(&mut self, down: Vec3) -> Result<Option<Arming>, Refusal> {
        if self.arming == Arming::Disarmed && down.z < LEAST_UPRIGHT {
            return Err(Refusal::Tilted);
        }
        self.on_event(ArmingEvent::Arm)
    }

    /// Moves the arming state; the new one where it differs.
    ///
    /// # Errors
    /// Why an arm command is refused.
    pub fn on_event(&mut self, event: ArmingEvent) -> Result<Option<Arming>, Refusal> {
        let arming = self.arming.after(event)?;
        let differs = arming != self.arming;
        self.arming = arming;
        Ok(differs.then_some(arming))
    }

    /// Lets a command pass, as the arming state allows.
    pub fn pass(&mut self, command: &MotorShares) -> Passed {
        let (before, refused) = (*self.gate.applied(), self.gate.refused());
        let output = self.gate.pass(self.arming, command);
        Passed {
            output,
            before,
            refused: self.gate.refused() != refused,
        }
    }
}
