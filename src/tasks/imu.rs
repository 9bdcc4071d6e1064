//! The inertial sensor: its samples, its silence, its registers.
//!
//! A sensor that lost its registers in a supply dip samples on, but not as configured. Reading all
//! of them back takes longer than a sample, so a few are read behind a burst, in turn.

use core::fmt::Debug;

use super::{Board, Lock, Task, follow};
use crate::app::{Autopilot, Fault, Recorder};
use crate::config::IMU_RATE;
use crate::graph::ControlLogic;
use crate::sensors::ImuReading;
use crate::time::{Duration, Instant, micros, span};

/// Without a burst for this long the sensor counts as silent.
const SILENCE: Duration = micros(20_000);

/// A check is begun this long after the burst's interrupt at the latest: it then ends before
/// the next burst, at 1 kHz with an oscillator 5 % fast. The longest, 8 bytes on the bus and one
/// of margin, takes 203 us.
const LATEST_CHECK: Duration = micros(600);

/// Time between two samples, in us.
pub const SAMPLE_US: u32 = 1_000_000 / IMU_RATE;
/// An edge sooner behind the one before is no sample's, in us.
pub const SOONEST_US: u32 = SAMPLE_US * 3 / 5;
/// From an edge until the next one may come, in us: its clock may be 5 % fast.
pub const NEXT_DUE_US: u32 = SAMPLE_US * 19 / 20;
/// From an edge until the next ones count as missed, in us: one may be lost.
pub const FIRST_MISSED_US: u32 = SAMPLE_US * 5 / 2;

/// Bursts in a row that fail before the bus is repaired.
const MOST_FAILURES: u8 = 2;

/// What the sensor's interrupt line tells, or does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// A sample is there.
    Sample(Instant),
    /// Too soon for a sample, at this instant.
    TooSoon(Instant),
    /// A sample is due, and no edge has come.
    Missed {
        /// Now.
        at: Instant,
        /// The first one of a row.
        first: bool,
    },
}

/// What a repair does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// Configures the sensor anew.
    Configure,
    /// Resets the sensor and its signal paths before: it answered, and still no sample came.
    Reset,
}

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

    /// Whether a burst brought a new sample.
    fn is_new(burst: &Self::Burst) -> bool;

    /// Decodes a burst; `None` where it repeats an old sample.
    fn reading(burst: &Self::Burst) -> Option<ImuReading>;

    /// The first register read that does not hold what was configured.
    fn difference(check: Self::Check, held: &Self::Held) -> Option<Self::Difference>;
}

/// An inertial sensor that is configured over a bus `B`: I2C, or a device on SPI.
pub trait Configure<B>: Imu {
    /// What can go wrong.
    type Error;

    /// How many steps a reset takes, and how long to wait behind each.
    const RESET: (u8, Duration);

    /// One step of a reset, after which the sensor is to be configured.
    ///
    /// # Errors
    /// The bus's.
    fn reset(bus: &mut B, step: u8) -> Result<(), Self::Error>;

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
    /// A transaction was cut off, or brought nothing new; whether a repair is due.
    Fault(Instant, Fault, bool),
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
        Report::Fault(at, fault, repair) => {
            pilot.lock(|pilot| pilot.on_fault(*at, *fault));
            if *repair {
                board.raise(Task::RepairImu);
            }
        }
        Report::Check(check, held) => {
            let difference = I::difference(*check, held)?;
            pilot.lock(|pilot| pilot.on_fault(board.now(), Fault::ImuConfiguration));
            board.raise(Task::RepairImu);
            return Some(difference);
        }
    }
    None
}

/// When the sensor was heard, what fails meanwhile, and which registers are still to be checked.
#[derive(Debug)]
pub struct Guard<I: Imu> {
    heard: Instant,
    /// Bursts that failed in a row.
    failures: u8,
    /// The sensor answered to a repair since it was heard.
    answered: bool,
    /// Checks that are still to be read, each behind a burst.
    checks_due: &'static [I::Check],
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
            failures: 0,
            answered: false,
            checks_due: &[],
        }
    }

    /// A new sample was received.
    pub fn hear(&mut self, at: Instant) {
        self.heard = at;
        self.failures = 0;
        self.answered = false;
    }

    /// A burst failed on the bus; true where it is to be repaired.
    pub fn fail(&mut self) -> bool {
        self.failures += 1;
        let most = self.failures >= MOST_FAILURES;
        if most {
            self.failures = 0;
        }
        most
    }

    /// True where samples have stopped coming. Also has all checks read behind the next bursts: the
    /// sensor may have forgotten what it is to do, or how large its counts are.
    pub fn is_silent(&mut self, now: Instant) -> bool {
        if self.checks_due.is_empty() {
            self.checks_due = I::CHECKS;
        }
        span(self.heard, now) > SILENCE
    }

    /// What a repair is to do now.
    #[must_use]
    pub fn remedy(&self, now: Instant) -> Remedy {
        match self.answered && span(self.heard, now) > SILENCE {
            true => Remedy::Reset,
            false => Remedy::Configure,
        }
    }

    /// The bus came back from a repair, to which the sensor answered or not: silence is counted from
    /// here.
    pub fn repaired(&mut self, at: Instant, answered: bool) {
        self.hear(at);
        self.answered = answered;
    }

    /// The check to be read behind the burst of an interrupt at `at`, where one is due and ends
    /// before the next burst. The clock is read only where one is due.
    pub fn check(&mut self, at: Instant, now: impl FnOnce() -> Instant) -> Option<I::Check> {
        let (check, rest) = self.checks_due.split_first()?;
        if span(at, now()) >= LATEST_CHECK {
            return None;
        }
        self.checks_due = rest;
        Some(*check)
    }
}
