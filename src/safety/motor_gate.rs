//! The one place that can make a motor output.

use crate::airframe::MotorShares;
use crate::config::MOTOR_TEST_SHARE;
use crate::control::MotorTest;
use crate::math::between;

/// A whole motor vector that passed the gate. Nothing else can be written to the motors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorOutput {
    shares: MotorShares,
}

impl MotorOutput {
    /// One share of full scale per motor, 0 to 1; all zero while disarmed.
    #[must_use]
    pub fn share(&self) -> MotorShares {
        self.shares
    }
}

/// Lets commands pass while armed, and remembers the one that is applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorGate {
    applied: MotorShares,
    refused_in_a_row: u32,
}

impl MotorGate {
    /// The gate to so many motors, which stand.
    #[must_use]
    pub const fn new(motors: usize) -> Self {
        Self {
            applied: MotorShares::all(0.0, motors),
            refused_in_a_row: 0,
        }
    }

    /// The output for a command: the command while armed, stopped motors otherwise.
    ///
    /// A command with a value that is not finite is refused as a whole and counted; the applied
    /// one stays. Critical for safety: beside [`Self::test`] the only constructor of [`MotorOutput`].
    pub fn pass(&mut self, armed: bool, command: &MotorShares) -> MotorOutput {
        let finite = command.iter().all(|share| share.is_finite());
        if !armed {
            self.applied = MotorShares::all(0.0, command.len());
        } else if finite {
            self.applied = command.map(|share| between(share, 0.0, 1.0));
        }
        self.refused_in_a_row = if finite {
            0
        } else {
            self.refused_in_a_row.saturating_add(1)
        };
        MotorOutput {
            shares: self.applied,
        }
    }

    /// The output for a test of one motor: it turns slowly, the others stand.
    pub fn test(&mut self, test: &MotorTest) -> MotorOutput {
        let mut shares = MotorShares::all(0.0, self.applied.len());
        if let Some(share) = shares.get_mut(usize::from(test.motor)) {
            *share = between(test.share, 0.0, MOTOR_TEST_SHARE);
        }
        self.applied = shares;
        MotorOutput { shares }
    }

    /// The command that the motors hold.
    #[must_use]
    pub fn applied(&self) -> &MotorShares {
        &self.applied
    }

    /// How many commands were refused since the last that was finite.
    #[must_use]
    pub fn refused_in_a_row(&self) -> u32 {
        self.refused_in_a_row
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_passes_unless_armed() {
        let mut gate = MotorGate::new(4);
        let mut passes = |armed| gate.pass(armed, &MotorShares::all(0.7, 4)).share();
        for (armed, passed) in [(false, 0.0), (true, 0.7), (false, 0.0)] {
            assert_eq!(passes(armed), MotorShares::all(passed, 4));
        }
    }

    #[test]
    fn a_test_turns_one_motor_slowly_and_no_other() {
        for motor in 0..5 {
            let mut gate = MotorGate::new(4);
            let test = MotorTest {
                motor,
                share: 0.9,
                length: crate::time::micros(0),
            };
            let output = gate.test(&test).share();
            for (place, share) in output.iter().enumerate() {
                let expected = if place == usize::from(motor) {
                    MOTOR_TEST_SHARE
                } else {
                    0.0
                };
                assert_eq!(*share, expected, "{place} of a test of {motor}");
            }
        }
    }

    #[test]
    fn a_command_that_is_not_finite_leaves_the_applied_one() {
        let mut gate = MotorGate::new(4);
        gate.pass(true, &MotorShares::all(0.3, 4));
        let mut broken = MotorShares::all(0.3, 4);
        broken[1] = f32::NAN;
        for refused in 1..4 {
            let passed = gate.pass(true, &broken).share();
            assert_eq!(passed, MotorShares::all(0.3, 4));
            assert_eq!(gate.refused_in_a_row(), refused);
        }
        gate.pass(true, &MotorShares::all(0.3, 4));
        assert_eq!(gate.refused_in_a_row(), 0);
    }
}
