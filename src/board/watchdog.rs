//! The independent watchdog: resets the board when signs of life stop coming.
//!
//! It runs from its own oscillator, which is 17 to 47 kHz by the datasheet, so that a timeout of
//! 400 ms may be 272 ms: the failsafe's task feeds it more often, at least every
//! [`reflex::tasks::control::LONGEST_SLEEP`], as long as [`Vitals`] finds nothing missing.
//!
//! It goes on while a debugger halts the core, and the motors' timers stand still then: a halt at
//! a breakpoint ends in a reset. What flies must not hang on a probe.

use reflex::app::{Autopilot, Recorder};
use reflex::graph::ControlLogic;
use reflex::reset::{Ending, LastWords};
use reflex::tasks::Lock;
use reflex::tasks::vitals::{Evidence, Signs, Vitals};
use reflex::time::at_micros;
use stm32f4xx_hal::{pac, prelude::*, watchdog::IndependentWatchdog};

use super::{last_words, now};

/// Signs of life, from the tasks to the watchdog.
pub static SIGNS: Signs = Signs::new();

/// Runs, to be fed from the failsafe's task.
pub struct Watchdog {
    timer: IndependentWatchdog,
    vitals: Vitals,
    starves: bool,
}

impl Watchdog {
    /// Starts it; and has the motors' timers stand still while a debugger halts the core.
    ///
    /// Its timeout holds from the first feed on; until then it counts from its maximum. A feed
    /// within 500 us of the start would reload that maximum.
    pub fn start(iwdg: pac::IWDG, debug: &pac::DBGMCU) -> Self {
        debug.apb1_fz().modify(|_, w| {
            w.dbg_tim3_stop().set_bit().dbg_tim4_stop().set_bit();
            w.dbg_iwdg_stop().clear_bit()
        });
        let mut timer = IndependentWatchdog::new(iwdg);
        timer.start(400.millis());
        Self {
            timer,
            vitals: Vitals::new(at_micros(0)),
            starves: false,
        }
    }

    /// Feeds it, before the tasks run.
    pub fn feed(&mut self) {
        self.timer.feed();
    }

    /// Feeds it where nothing is missing; otherwise leaves to the next start what was.
    pub fn heed<R: Recorder, L: ControlLogic>(
        &mut self,
        pilot: &mut impl Lock<Target = Autopilot<R, L>>,
    ) {
        let now = now();
        let (state, evidence) = pilot.lock(|pilot| (pilot.telemetry(), Evidence::of(pilot, now)));
        last_words::note(state.mode());
        match self.vitals.look(now, &SIGNS, evidence) {
            Ok(()) => {
                if core::mem::take(&mut self.starves) {
                    last_words::leave(None);
                }
                self.timer.feed();
            }
            Err(sign) if !self.starves => {
                self.starves = true;
                let words = LastWords {
                    ending: Ending::Starved(sign),
                    mode: last_words::mode(),
                    exception: 0,
                    program_counter: 0,
                    link_register: 0,
                    place: 0,
                };
                last_words::leave(Some(&words));
                defmt::error!("watchdog not fed: {} is missing", sign);
            }
            Err(_) => {}
        }
    }
}

/// Says in the log where a debugger's halt would not do what it should, by the bits that are read
/// back: their effect only hardware shows.
pub fn warn_of_halts(debug: &pac::DBGMCU) {
    let frozen = debug.apb1_fz().read();
    let motors = frozen.dbg_tim3_stop().bit() && frozen.dbg_tim4_stop().bit();
    if !motors || frozen.dbg_iwdg_stop().bit() {
        defmt::error!("a debugger's halt would leave the motors turning");
    }
}
