//! The owner of the chips that interrupt by themselves: samples first, then orders.

use reflex_drivers::orders::{Obeyed, Sample};

use super::{Board, Lock, Task, follow};
use crate::app::{Autopilot, ChipOrder, Fault, OrderError, Recorder};
use crate::graph::ControlLogic;
use crate::sensors::{ChipSample, Input};
use crate::time::Instant;

/// The chips of a board that interrupt by themselves.
pub trait Chips {
    /// Reads the sample of an input that an interrupt announced, and lets the pin fall.
    ///
    /// # Errors
    /// The bus's.
    fn fetch(&mut self, input: Input) -> Result<Sample, OrderError>;

    /// Carries out an order and checks it.
    ///
    /// # Errors
    /// The bus's, a register that does not hold what was written, a chip that is not there.
    fn execute(&mut self, order: ChipOrder) -> Result<Obeyed, OrderError>;
}

/// Pieces of work that the owner does before tasks of its priority get their turn.
const MOST_AT_ONCE: usize = 8;

/// Interrupts whose sample is still to be fetched: the latest of each input.
///
/// One place per input is a bounded queue that cannot overflow: a second interrupt before the
/// fetch is about the sample that the same fetch reads.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fetches([Option<Instant>; Input::COUNT]);

impl Fetches {
    /// Asks for the sample of an interrupt, with its stamp.
    pub(super) fn ask(&mut self, input: Input, at: Instant) {
        if let Some(place) = self.0.get_mut(input as usize) {
            *place = Some(at);
        }
    }

    /// Takes the next one: which input, and the stamp.
    pub fn take(&mut self) -> Option<(Input, Instant)> {
        let mut places = Input::ALL.into_iter().zip(&mut self.0);
        places.find_map(|(input, place)| Some((input, place.take()?)))
    }
}

/// The task of a sensor's interrupt: asks the owner for the sample.
pub fn announced(
    board: &mut impl Board,
    fetches: &mut impl Lock<Target = Fetches>,
    input: Input,
    at: Instant,
) {
    fetches.lock(|fetches| fetches.ask(input, at));
    board.raise(Task::Chips);
}

/// What the owner does next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work {
    /// Reads the sample of an interrupt with this stamp.
    Fetch(Input, Instant),
    /// Carries an order out.
    Order(ChipOrder),
}

/// What work on the bus led to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Done {
    /// The sample of an interrupt with this stamp.
    Fetched(Input, Instant, Result<Sample, OrderError>),
    /// An order, and the chip's answer.
    Ordered(ChipOrder, Result<Obeyed, OrderError>),
}

impl Work {
    /// Samples come first, then orders; `None` where there is nothing to do.
    pub fn next<R: Recorder, L: ControlLogic>(
        fetches: &mut impl Lock<Target = Fetches>,
        pilot: &mut impl Lock<Target = Autopilot<R, L>>,
    ) -> Option<Self> {
        if let Some((input, at)) = fetches.lock(Fetches::take) {
            return Some(Self::Fetch(input, at));
        }
        pilot.lock(Autopilot::next_order).map(Self::Order)
    }

    /// Does it, on the bus.
    pub fn carry_out(self, chips: &mut impl Chips) -> Done {
        match self {
            Self::Fetch(input, at) => Done::Fetched(input, at, chips.fetch(input)),
            Self::Order(order) => Done::Ordered(order, chips.execute(order)),
        }
    }
}

impl Done {
    /// Brings it to the autopilot.
    ///
    /// # Errors
    /// The order's: the owner then waits to be raised.
    pub fn report<R: Recorder, L: ControlLogic>(
        self,
        board: &mut impl Board,
        pilot: &mut impl Lock<Target = Autopilot<R, L>>,
    ) -> Result<(), OrderError> {
        pilot.lock(|pilot| match self {
            Self::Fetched(input, at, Ok(sample)) => {
                follow(board, pilot.on_chip(at, &ChipSample::of(input, sample)));
                Ok(())
            }
            Self::Fetched(_, at, Err(_)) => {
                pilot.on_fault(at, Fault::ChipBus);
                Ok(())
            }
            Self::Ordered(order, result) => {
                let at = board.now();
                if let Ok(Obeyed {
                    sample: Some(sample),
                    ..
                }) = result
                {
                    follow(
                        board,
                        pilot.on_chip(at, &ChipSample::of(order.input, sample)),
                    );
                }
                pilot.on_order_done(at, order, result.map(|obeyed| obeyed.setting));
                result.map(|_| ())
            }
        })
    }
}

/// The owner's task: works until nothing is left; after a failure it waits to be raised.
pub fn serve<R: Recorder, L: ControlLogic>(
    board: &mut impl Board,
    fetches: &mut impl Lock<Target = Fetches>,
    pilot: &mut impl Lock<Target = Autopilot<R, L>>,
    chips: &mut impl Chips,
) {
    for _ in 0..MOST_AT_ONCE {
        let Some(work) = Work::next(fetches, pilot) else {
            return;
        };
        if work.carry_out(chips).report(board, pilot).is_err() {
            return;
        }
    }
    board.raise(Task::Chips);
}
