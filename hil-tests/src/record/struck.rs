//! The emulated board's chips, which break when a script says so.

use std::sync::PoisonError;

use chip_models::{Mpu6050, OwnClock, SharedChips};
use emulated_board::emulated::EmulatedBoard;
use emulated_board::{Board, Fault, Observer};

use crate::faults::{Strikes, Struck};

/// Runs to an instant; chips break on the way.
///
/// # Errors
/// A fault of the board.
pub(crate) fn run_struck(
    board: &mut EmulatedBoard,
    chips: &mut SharedChips,
    strikes: &mut Strikes,
    until_ns: u64,
    observer: &mut dyn Observer,
) -> Result<(), Fault> {
    while let Some(strike) = strikes.before(until_ns) {
        board.run_until(strike.at_ns, observer)?;
        strike.strike(board.now_ns(), &mut Shared(chips));
    }
    board.run_until(until_ns, observer)
}

/// A chip that panicked is reported by that panic, not by its lock.
struct Shared<'c>(&'c SharedChips);

impl Struck for Shared<'_> {
    fn imu(&mut self, work: &mut dyn FnMut(&mut Mpu6050)) {
        let mut chip = self.0.imu.lock().unwrap_or_else(PoisonError::into_inner);
        work(&mut chip);
    }

    fn die(&mut self, place: usize, work: &mut dyn FnMut(&mut dyn OwnClock)) {
        let die = self.0.dies[place].lock();
        work(die.unwrap_or_else(PoisonError::into_inner).as_mut());
    }
}
