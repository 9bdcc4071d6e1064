//! What a board does around the autopilot, over the traits of embedded-hal.
//!
//! A board stamps interrupts, moves bytes and calls the autopilot. What it does with those bytes,
//! when it repairs a chip and how it carries out an order is the same on every board, and is here.
//!
//! | module | task |
//! |---|---|
//! | [`control`] | the end of a hyperperiod, the failsafe |
//! | [`imu`] | samples, silence and registers of the inertial sensor |
//! | [`chips`] | the owner of the chips that interrupt by themselves |
//! | [`drivers`] | which of their drivers delivers which input |
//! | [`link`] | bytes in, frames out |
//! | [`store`] | what a restart must not forget |
//! | [`vitals`] | whether the watchdog is fed |
//!
//! A module named by a part number gives `imu` what it needs of that chip. Nothing here reads a
//! clock, knows a vector or logs: [`Board`] and [`Lock`] are what a task needs of its board, and
//! what a board may log is returned.

pub mod chips;
pub mod control;
pub mod drivers;
pub mod imu;
pub mod link;
pub mod mpu6050;
pub mod store;
pub mod vitals;

use crate::reactive::Next;
use crate::time::Instant;

/// A task that another one raises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// [`control::hyperperiod`].
    Hyperperiod,
    /// [`chips::serve`].
    Chips,
    /// Has the inertial sensor configured anew: [`imu::Configure`].
    RepairImu,
    /// What waits for the processor to be idle: refits, the log and the store.
    Idle,
}

/// The board that a task runs on.
pub trait Board {
    /// The present time.
    fn now(&mut self) -> Instant;

    /// Has a task run as soon as its priority allows. Raised twice before it runs, it runs once.
    fn raise(&mut self, task: Task);

    /// Raises the end of the hyperperiod at this instant, unless an earlier call is still awaited.
    fn raise_hyperperiod_at(&mut self, at: Instant);
}

/// A resource that tasks share: each uses it for one short step at a time.
pub trait Lock {
    /// The resource.
    type Target;

    /// Takes a step during which no other task uses the resource.
    fn lock<T>(&mut self, step: impl FnOnce(&mut Self::Target) -> T) -> T;
}

/// A resource that no other task can use meanwhile.
#[derive(Debug)]
pub struct Unshared<'a, T>(pub &'a mut T);

impl<T> Lock for Unshared<'_, T> {
    type Target = T;

    fn lock<R>(&mut self, step: impl FnOnce(&mut T) -> R) -> R {
        step(self.0)
    }
}

/// Does what a sample or a message asked for.
pub fn follow(board: &mut impl Board, next: Next) {
    match next {
        Next::Wait => {}
        Next::Hyperperiod => board.raise(Task::Hyperperiod),
        // Where one is awaited already, that one or the failsafe ends this one too.
        Next::HyperperiodAt(at) => board.raise_hyperperiod_at(at),
    }
}

#[cfg(test)]
mod tests;
