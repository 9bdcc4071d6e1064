//! Control: at the end of a hyperperiod, and where nothing else led to a run.

use super::imu::Guarded;
use super::{Board, Lock, Task};
use crate::app::{Autopilot, Recorder};
use crate::graph::ControlLogic;
use crate::safety::MotorOutput;
use crate::time::{Duration, Instant, micros};

/// The shortest sleep of the failsafe's task: other tasks get their turn.
const SHORTEST_SLEEP: Duration = micros(500);

/// The longest sleep of the failsafe's task, and so the longest time between two feeds of a
/// watchdog.
pub const LONGEST_SLEEP: Duration = micros(100_000);

/// The outputs to the motors.
pub trait Motors {
    /// Applies a command at once.
    fn write(&mut self, output: &MotorOutput);
}

/// The hyperperiod's end: propagates, writes the motors; the chips' thresholds follow.
pub fn hyperperiod<R: Recorder, L: ControlLogic>(
    board: &mut impl Board,
    pilot: &mut impl Lock<Target = Autopilot<R, L>>,
    motors: &mut impl Lock<Target: Motors>,
) {
    if let Some(output) = pilot.lock(|pilot| pilot.on_hyperperiod(board.now())) {
        motors.lock(|motors| motors.write(&output));
        board.raise(Task::Chips);
    }
}

/// Runs control where nothing else did and looks after the inertial sensor; says when to be
/// called next, after [`LONGEST_SLEEP`] at the latest.
pub fn failsafe<R: Recorder, L: ControlLogic>(
    board: &mut impl Board,
    pilot: &mut impl Lock<Target = Autopilot<R, L>>,
    motors: &mut impl Lock<Target: Motors>,
    imu: &mut impl Lock<Target: Guarded>,
) -> Instant {
    let time = board.now();
    let due = pilot.lock(|pilot| pilot.deadline() <= time);
    if due && let Some(output) = pilot.lock(|pilot| pilot.on_timer(time)) {
        motors.lock(|motors| motors.write(&output));
    }
    board.raise(Task::Chips);
    board.raise(Task::Idle);
    if imu.lock(|imu| imu.guard().is_silent(time)) {
        board.raise(Task::RepairImu);
    }
    let deadline = pilot.lock(|pilot| pilot.deadline());
    deadline.clamp(time + SHORTEST_SLEEP, time + LONGEST_SLEEP)
}
