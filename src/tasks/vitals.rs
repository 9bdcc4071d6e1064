//! Whether the watchdog is fed: by evidence that the firmware flies, not by habit.
//!
//! A timer that comes and does nothing else would feed a watchdog for ever. So each task that
//! others rely on gives a [`Sign`] when it runs, and the failsafe's task asks [`Vitals`] for all of
//! them. What a missing one ends is a drone that nobody steers, or soon would not.

use core::sync::atomic::{AtomicU8, Ordering};

use crate::app::{Autopilot, Recorder};
use crate::config::LIMITS;
use crate::graph::ControlLogic;
use crate::reset::Sign;
use crate::time::{Duration, Instant, micros, span};

/// How long a task may be away: three beats of the link, the rarest.
pub const LONGEST_ABSENCE: Duration = micros(3_000_000);

/// Signs given since they were taken last, from any task.
#[derive(Debug, Default)]
pub struct Signs(AtomicU8);

impl Signs {
    /// None given.
    #[must_use]
    pub const fn new() -> Self {
        Self(AtomicU8::new(0))
    }

    /// The task behind a sign runs.
    pub fn give(&self, sign: Sign) {
        self.0.fetch_or(bit(sign), Ordering::Relaxed);
    }
}

fn bit(sign: Sign) -> u8 {
    1 << (sign as u8)
}

/// What the autopilot says of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Evidence {
    /// Until when its last run counts.
    pub controlled_until: Instant,
    /// Its sensor is alive, or it knows that it is not.
    pub senses: bool,
}

impl Evidence {
    /// What it says at an instant.
    #[must_use]
    pub fn of<R: Recorder, L: ControlLogic>(pilot: &Autopilot<R, L>, now: Instant) -> Self {
        Self {
            controlled_until: pilot.deadline() + LIMITS.hyperperiod,
            senses: pilot.senses(now),
        }
    }
}

/// When each task was seen last.
#[derive(Debug)]
pub struct Vitals([(Sign, Instant); Self::TASKS.len()]);

impl Vitals {
    /// Tasks that give signs.
    const TASKS: [Sign; 3] = [Sign::Chips, Sign::Link, Sign::Idle];

    /// Absences are counted from an instant.
    #[must_use]
    pub fn new(from: Instant) -> Self {
        Self(Self::TASKS.map(|sign| (sign, from)))
    }

    /// Takes the signs given since the last look.
    ///
    /// # Errors
    /// The first sign that is missing: the watchdog is not to be fed.
    pub fn look(&mut self, now: Instant, signs: &Signs, evidence: Evidence) -> Result<(), Sign> {
        let given = signs.0.swap(0, Ordering::Relaxed);
        for (sign, seen) in &mut self.0 {
            if given & bit(*sign) != 0 {
                *seen = now;
            }
        }
        if now > evidence.controlled_until {
            return Err(Sign::Control);
        }
        if !evidence.senses {
            return Err(Sign::Sensors);
        }
        let absent = |(_, seen): &&(Sign, Instant)| span(*seen, now) > LONGEST_ABSENCE;
        match self.0.iter().find(absent) {
            Some((sign, _)) => Err(*sign),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;

    const PAST: u64 = LONGEST_ABSENCE.ticks() + 1;

    #[test]
    fn the_watchdog_is_fed_where_nothing_is_missing() {
        let every = [Sign::Chips, Sign::Link, Sign::Idle];
        // (run counts until, senses, signs given, looked at) to the missing sign.
        let table = [
            ((PAST, true, &every[..], PAST), Ok(())),
            ((PAST, true, &[], PAST - 1), Ok(())),
            ((PAST - 1, true, &every, PAST), Err(Sign::Control)),
            ((PAST - 1, false, &[], PAST), Err(Sign::Control)),
            ((PAST, false, &every, PAST), Err(Sign::Sensors)),
            ((PAST, true, &every[1..], PAST), Err(Sign::Chips)),
            (
                (PAST, true, &[Sign::Chips, Sign::Idle], PAST),
                Err(Sign::Link),
            ),
            ((PAST, true, &every[..2], PAST), Err(Sign::Idle)),
            ((PAST, true, &[], PAST), Err(Sign::Chips)),
        ];
        for ((until, senses, given, now), expected) in table {
            let (mut vitals, signs) = (Vitals::new(at_micros(0)), Signs::new());
            given.iter().for_each(|sign| signs.give(*sign));
            let evidence = Evidence {
                controlled_until: at_micros(until),
                senses,
            };
            let found = vitals.look(at_micros(now), &signs, evidence);
            assert_eq!(found, expected, "{until} {senses} {given:?} {now}");
        }
    }

    #[test]
    fn a_sign_counts_once_and_a_task_that_is_back_is_believed() {
        let (mut vitals, signs) = (Vitals::new(at_micros(0)), Signs::new());
        let evidence = Evidence {
            controlled_until: at_micros(2 * PAST),
            senses: true,
        };
        let mut look = |now, given: &[Sign]| {
            given.iter().for_each(|sign| signs.give(*sign));
            vitals.look(at_micros(now), &signs, evidence)
        };
        let every = [Sign::Chips, Sign::Link, Sign::Idle];
        assert_eq!(look(10, &every), Ok(()));
        assert_eq!(look(10 + PAST, &every[..2]), Err(Sign::Idle));
        assert_eq!(look(20 + PAST, &every[2..]), Ok(()));
    }
}
