//! The board as its tasks see it: its clock, and what they raised.

use reflex::safety::MotorOutput;
use reflex::tasks::control::Motors;
use reflex::tasks::{Board, Task};
use reflex::time::Instant;

/// The present time and the tasks that were raised in the present event.
#[derive(Debug)]
pub(super) struct Vectors {
    pub(super) now: Instant,
    pub(super) hyperperiod: bool,
    pub(super) hyperperiod_at: Option<Instant>,
    pub(super) chips: bool,
    pub(super) repair_imu: bool,
    pub(super) idle: bool,
}

impl Vectors {
    /// Nothing was raised yet.
    pub(super) fn at(now: Instant) -> Self {
        Self {
            now,
            hyperperiod: false,
            hyperperiod_at: None,
            chips: false,
            repair_imu: false,
            idle: false,
        }
    }

    /// What was raised; nothing is raised any more.
    pub(super) fn take(&mut self) -> Self {
        let now = self.now;
        std::mem::replace(self, Self::at(now))
    }
}

impl Board for Vectors {
    fn now(&mut self) -> Instant {
        self.now
    }

    fn raise(&mut self, task: Task) {
        match task {
            Task::Hyperperiod => self.hyperperiod = true,
            Task::Chips => self.chips = true,
            Task::RepairImu => self.repair_imu = true,
            Task::Idle => self.idle = true,
        }
    }

    fn raise_hyperperiod_at(&mut self, at: Instant) {
        self.hyperperiod_at.get_or_insert(at);
    }
}

/// The motors: no timer is played, only whether a command was written.
#[derive(Debug, Default)]
pub(super) struct Outputs {
    pub(super) written: bool,
}

impl Motors for Outputs {
    fn write(&mut self, _: &MotorOutput) {
        self.written = true;
    }
}
