//! A session: chips and link frames of one flight around one booted board.

use std::sync::{Arc, Mutex, PoisonError};

use anyhow::Result;

use crate::faults::{Strikes, broken};
use crate::firmware::Firmware;
use crate::ground_station::LinkFrame;
use crate::progress::Progress;
use crate::record::{ChipState, CountedFrom, Look, Observation, OfChips, run_struck};
use crate::replay::link_frames::schedule;
use crate::replay::options::ReplayOptions;
use crate::replay::setup::{chip_options, length_ns, script};
use chip_models::SharedChips;
use emulated_board::emulated::{EmulatedBoard, Sensors};
use emulated_board::{Board, Elf, Observer, Options, Outcome, Watched};
use recorded_flights::{Flight, FlightStimulus, Setpoints, Standstill};

/// Virtual time between two looks at the chips' sample counters.
const STEP_NS: u64 = 20_000_000;

/// One replay on an emulated board, with all that belongs to it.
pub(crate) struct Session {
    board: Option<Box<EmulatedBoard>>,
    pub(super) chips: SharedChips,
    pub(super) setpoints: Setpoints,
    strikes: Strikes,
    pub(super) looks: Vec<Look>,
    at_rest: Standstill,
    end_ns: u64,
}

impl Session {
    /// Builds the chips, boots the board and schedules the link's frames.
    pub(crate) fn new(
        flight: &Flight,
        options: &ReplayOptions,
        firmware: &Firmware,
        watches: Vec<Watched>,
    ) -> Result<Self> {
        let at_rest = Standstill::default();
        let faults = script(flight, options, false)?;
        let source = broken(Arc::new(FlightStimulus::new(flight, at_rest)), &faults);
        let chips = SharedChips::feeling(&source, chip_options(flight, options));
        let elf = Arc::new(Elf::parse(firmware.bytes.clone())?);
        let board_options = Options {
            settings: Some(options.start().to_bytes()),
            watches,
            bus_faults: faults.on_wires(),
            ..Options::default()
        };
        let mut board = EmulatedBoard::boot(&elf, Sensors::from(&chips), &board_options)?;
        let end_ns = at_rest.length_ns() + length_ns(flight, options);
        let setpoints = Setpoints::of(flight);
        for LinkFrame { at_ns, bytes } in schedule(flight, &setpoints, at_rest, &faults) {
            if at_ns < end_ns {
                board.transmit(at_ns, &bytes);
            }
        }
        Ok(Self {
            board: Some(Box::new(board)),
            chips,
            setpoints,
            strikes: Strikes::of(&faults),
            looks: Vec::new(),
            at_rest,
            end_ns,
        })
    }

    /// When the log begins, in ns of the board's time.
    pub(super) fn flight_start_ns(&self) -> u64 {
        self.at_rest.length_ns()
    }

    /// Runs to the end of the flight.
    pub(crate) fn run(
        &mut self,
        observer: &mut dyn Observer,
        progress: &mut dyn Progress,
    ) -> Result<()> {
        while self.step(observer, progress)? {}
        Ok(())
    }

    /// Runs on to the next look at the chips; false at the end of the flight.
    pub(super) fn step(
        &mut self,
        observer: &mut dyn Observer,
        progress: &mut dyn Progress,
    ) -> Result<bool> {
        let Some(board) = &mut self.board else {
            return Ok(false);
        };
        let at_ns = (board.now_ns() + STEP_NS).min(self.end_ns);
        let (chips, strikes) = (&mut self.chips, &mut self.strikes);
        run_struck(board, chips, strikes, at_ns, observer)?;
        self.looks.push(Look {
            at_ns,
            chips: look_at(&self.chips),
        });
        let start_ns = self.at_rest.length_ns();
        progress.done(
            seconds(at_ns.saturating_sub(start_ns)),
            seconds(self.end_ns - start_ns),
        );
        Ok(at_ns < self.end_ns)
    }

    /// The instant reached, in ns of the board's time.
    pub(super) fn now_ns(&self) -> u64 {
        self.board
            .as_ref()
            .map_or(self.end_ns, |board| board.now_ns())
    }

    /// Counts instructions from here on; none once the board is at its end.
    pub(super) fn count(&mut self, observation: &Observation) -> Option<CountedFrom> {
        let board = self.board.as_mut()?;
        Some(CountedFrom::here(&mut **board, observation))
    }

    /// Ends the board and says what can only be measured at the end.
    pub(super) fn finish(&mut self, observation: &mut Observation) -> Result<Outcome> {
        observation.flush()?;
        self.end()
    }

    /// As [`Self::finish`], for one whose observer writes nothing.
    pub(crate) fn end(&mut self) -> Result<Outcome> {
        let board = self.board.take().expect("finished once");
        Ok(board.finish()?)
    }
}

fn look_at(chips: &SharedChips) -> OfChips<ChipState> {
    chips
        .dies
        .each_ref()
        .map(|die| ChipState::from(held(die).as_ref()))
}

/// A chip that panicked is reported by that panic, not by its lock.
fn held<T>(chip: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    chip.lock().unwrap_or_else(PoisonError::into_inner)
}

fn seconds(nanos: u64) -> f64 {
    nanos as f64 * 1e-9
}
