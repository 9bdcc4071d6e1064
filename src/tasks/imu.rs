//! The inertial sensor: its samples, its silence, its registers.
//!
//! A sensor that lost its registers in a supply dip samples on, but not as configured. Reading all
//! of them back takes longer than a sample, so a few are read behind a burst, in turn.

use core::fmt::Debug;

use super::{Board, Lock, Task, follow};
use crate::app::{Autopilot, Fault, Recorder};
use crate::graph::ControlLogic;
use crate::sensors::ImuReading;
use crate::time::{Duration, Instant, micros, span};

/// Without a burst for this long the sensor counts as silent.
const SILENCE: Duration = micros(20_000);

/// A check is begun this long after the burst's interrupt at the latest: it then ends before
/// the next burst, at 1 kHz with an oscillator 5 % fast. The longest, 8 bytes on the bus and one
/// of margin, takes 203 us.
const LATEST_CHECK: Duration = micros(600);

/// An inertial sensor, on whatever bus.
pub trait Imu {
    /// The bytes of one sample.
    type Burst;
    /// Some registers that are read at once.
    type Check: Copy + Debug + 'static;
    /// What such registers hold.
    type Held;
    /// A register that does not hold what it should.
    type Difference;

    /// All checks, to be taken in turn.
    const CHECKS: &'static [Self::Check];

    /// Decodes a burst; `None` where it repeats an old sample.
    fn reading(burst: &Self::Burst) -> Option<ImuReading>;

    /// The first register read that does not hold what was configured.
    fn difference(check: Self::Check, held: &Self::Held) -> Option<Self::Difference>;
}

/// An inertial sensor that is configured over a bus `B`: I2C, or a device on SPI.
pub trait Configure<B>: Imu {
    /// What can go wrong.
    type Error;

    /// Configures the sensor anew, in under 5 ms, and checks all of it.
    ///
    /// # Errors
    /// The bus's, another chip, a register that does not hold what was written.
    fn configure(bus: &mut B) -> Result<(), Self::Error>;
}

/// What a transaction with the sensor led to.
#[derive(Debug)]
pub enum Report<I: Imu> {
    /// A burst, with the stamp of its interrupt.
    Burst(Instant, I::Burst),
    /// What the registers of a check hold.
    Check(I::Check, I::Held),
    /// A transaction was cut off.
    Fault(Instant, Fault),
}

/// Takes what came from the sensor; a register that differs is returned, for the log.
pub fn received<I: Imu, R: Recorder, L: ControlLogic>(
    board: &mut impl Board,
    pilot: &mut impl Lock<Target = Autopilot<R, L>>,
    report: &Report<I>,
) -> Option<I::Difference> {
    match report {
        Report::Burst(at, burst) => match I::reading(burst) {
            Some(reading) => {
                let (next, chips) =
                    pilot.lock(|pilot| (pilot.on_imu(*at, &reading), pilot.are_chips_due(*at)));
                follow(board, next);
                if chips {
                    board.raise(Task::Chips);
                }
            }
            None => pilot.lock(|pilot| pilot.on_fault(*at, Fault::ImuStale)),
        },
        Report::Fault(at, fault) => pilot.lock(|pilot| pilot.on_fault(*at, *fault)),
        Report::Check(check, held) => {
            let difference = I::difference(*check, held)?;
            pilot.lock(|pilot| pilot.on_fault(board.now(), Fault::ImuConfiguration));
            board.raise(Task::RepairImu);
            return Some(difference);
        }
    }
    None
}

/// When the sensor was heard, and which registers are checked next.
#[derive(Debug)]
pub struct Guard<I: Imu> {
    heard: Instant,
    turn: usize,
    check_due: bool,
    sensor: core::marker::PhantomData<I>,
}

/// Who keeps the guard: the owner of the sensor's bus.
pub trait Guarded {
    /// The sensor.
    type Imu: Imu;

    /// Its guard.
    fn guard(&mut self) -> &mut Guard<Self::Imu>;
}

impl<I: Imu> Guarded for Guard<I> {
    type Imu = I;

    fn guard(&mut self) -> &mut Self {
        self
    }
}

impl<I: Imu> Guard<I> {
    /// Silence is counted from an instant.
    #[must_use]
    pub fn new(from: Instant) -> Self {
        Self {
            heard: from,
            turn: 0,
            check_due: false,
            sensor: core::marker::PhantomData,
        }
    }

    /// A burst was received, or the bus came back from a repair.
    pub fn hear(&mut self, at: Instant) {
        self.heard = at;
    }

    /// True where bursts have stopped coming. Also has a check read behind the next one.
    pub fn is_silent(&mut self, now: Instant) -> bool {
        self.check_due = true;
        span(self.heard, now) > SILENCE
    }

    /// The check to be read behind the burst of an interrupt at `at`, where one is due and ends
    /// before the next burst. The clock is read only where one is due.
    pub fn check(&mut self, at: Instant, now: impl FnOnce() -> Instant) -> Option<I::Check> {
        if !self.check_due || span(at, now()) >= LATEST_CHECK {
            return None;
        }
        let check = I::CHECKS.get(self.turn)?;
        self.check_due = false;
        self.turn = (self.turn + 1) % I::CHECKS.len();
        Some(*check)
    }
}
