//! What a script does to the wires between the processor and its sensors.
//!
//! A [`BusFault`] disturbs one thing from an instant until another. The models ask a [`Script`] of
//! them what holds now, so a run with the same script is the same run.

use super::reflex_f427::SensorLine;

/// How long a deaf line hears nothing at least, in ns.
const DEAF_NS: u64 = 1_000_000;

/// One disturbance, and when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BusFault {
    /// What is disturbed.
    pub what: Disturbance,
    /// From when on, in ns of the board's time.
    pub from_ns: u64,
    /// Until when, in ns; `u64::MAX` for ever.
    pub until_ns: u64,
}

/// What can be wrong with the inertial sensor's bus, its DMA stream, or an interrupt line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// Nobody acknowledges an address or a written byte.
    NoAcknowledge,
    /// Every byte ends with a bus error that the transfer does not notice (ES0206, 2.10.1).
    BusError,
    /// Another master wins at the first one that is sent.
    ArbitrationLost,
    /// SDA is shorted to ground.
    DataHeld,
    /// A chip that lost count holds SDA until it has seen so many clocks.
    DataHeldByChip {
        /// Clocks until it lets go.
        clocks: u8,
    },
    /// SCL is held low.
    ClockHeld,
    /// Chips stretch the clock: all takes so many percent of its time.
    Stretched {
        /// 100 is no stretching.
        percent: u32,
    },
    /// The DMA serves the bus late: its flags, and its stop, come late by as much.
    DmaLate {
        /// How late, in ns.
        by_ns: u64,
    },
    /// The DMA's next access fails: the stream ends with its error flag.
    DmaError,
    /// An interrupt line is stuck.
    LineHeld {
        /// Which one.
        line: SensorLine,
        /// At which level.
        high: bool,
    },
    /// An interrupt line is deaf in so many of a hundred milliseconds, evenly spread: edges are lost, or come late.
    LineDeaf {
        /// Which one.
        line: SensorLine,
        /// Of a hundred.
        percent: u32,
    },
    /// An interrupt line picks up a square wave.
    LineStorm {
        /// Which one.
        line: SensorLine,
        /// Time from one rising edge to the next, in ns.
        period_ns: u64,
    },
}

impl BusFault {
    fn holds(&self, at_ns: u64) -> bool {
        (self.from_ns..self.until_ns).contains(&at_ns)
    }
}

/// All disturbances of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct Script(Vec<BusFault>);

impl From<&[BusFault]> for Script {
    fn from(faults: &[BusFault]) -> Self {
        Self(faults.to_vec())
    }
}

impl Script {
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Every instant at which something begins or ends.
    pub(super) fn changes(&self) -> impl Iterator<Item = u64> {
        let ends = self
            .0
            .iter()
            .flat_map(|fault| [fault.from_ns, fault.until_ns]);
        ends.filter(|&at_ns| at_ns != u64::MAX)
    }

    /// Whether such a disturbance holds now.
    pub(super) fn has(&self, what: Disturbance, at_ns: u64) -> bool {
        self.now(at_ns).any(|held| held == what)
    }

    /// How late the DMA is now, in ns.
    pub(super) fn dma_delay(&self, at_ns: u64) -> Option<u64> {
        self.now(at_ns).find_map(|what| match what {
            Disturbance::DmaLate { by_ns } => Some(by_ns),
            _ => None,
        })
    }

    /// Clocks that a chip needs which lost count at this instant.
    pub(super) fn lost_count(&self, at_ns: u64) -> Option<u8> {
        let mut begun = self.0.iter().filter(|fault| fault.from_ns == at_ns);
        begun.find_map(|fault| match fault.what {
            Disturbance::DataHeldByChip { clocks } => Some(clocks),
            _ => None,
        })
    }

    /// When something on the bus that takes so long is over; never where the clock is held for ever.
    pub(super) fn end_of(&self, from_ns: u64, duration_ns: u64) -> Option<u64> {
        let (mut now, mut left) = (from_ns, duration_ns);
        loop {
            let percent = self.slowness(now);
            let until = self.changes().filter(|&at| at > now).min();
            let ends = percent.map(|percent| now + left * u64::from(percent) / 100);
            match (ends, until) {
                (Some(ends), Some(until)) if ends > until => {
                    let passed = (until - now) * 100 / u64::from(percent.unwrap_or(100));
                    (now, left) = (until, left - passed.min(left));
                }
                (Some(ends), _) => return Some(ends),
                (None, Some(until)) => now = until,
                (None, None) => return None,
            }
        }
    }

    /// Percent of its time that a clock takes; none where SCL is held.
    fn slowness(&self, at_ns: u64) -> Option<u32> {
        self.now(at_ns).try_fold(100, |slowest, what| match what {
            Disturbance::ClockHeld => None,
            Disturbance::Stretched { percent } => Some(slowest.max(percent.max(1))),
            _ => Some(slowest),
        })
    }

    /// The level of an interrupt line whose chip drives it so, and when it changes by the script.
    pub(super) fn line(&self, line: SensorLine, driven: bool, at_ns: u64) -> (bool, u64) {
        let (mut level, mut next_ns) = (driven, u64::MAX);
        for fault in &self.0 {
            match fault.what {
                Disturbance::LineHeld { line: of, high } if of == line => {
                    if fault.holds(at_ns) {
                        level = high;
                    }
                }
                Disturbance::LineDeaf { line: of, percent } if of == line => {
                    if fault.holds(at_ns) {
                        let windows = (at_ns - fault.from_ns) / DEAF_NS;
                        let lost = |windows: u64| windows * u64::from(percent) / 100;
                        level &= lost(windows + 1) == lost(windows);
                        next_ns = next_ns.min(fault.from_ns + (windows + 1) * DEAF_NS);
                    }
                }
                Disturbance::LineStorm {
                    line: of,
                    period_ns,
                } if of == line => {
                    if fault.holds(at_ns) {
                        let half = (period_ns / 2).max(1);
                        let halves = (at_ns - fault.from_ns) / half;
                        level |= halves.is_multiple_of(2);
                        next_ns = next_ns.min(fault.from_ns + (halves + 1) * half);
                    }
                }
                _ => continue,
            }
            let ends = [fault.from_ns, fault.until_ns].into_iter();
            next_ns = ends.filter(|&at| at > at_ns).fold(next_ns, u64::min);
        }
        (level, next_ns)
    }

    fn now(&self, at_ns: u64) -> impl Iterator<Item = Disturbance> {
        let held = self.0.iter().filter(move |fault| fault.holds(at_ns));
        held.map(|fault| fault.what)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn script(faults: &[(Disturbance, u64, u64)]) -> Script {
        let fault = |&(what, from_ns, until_ns): &_| BusFault {
            what,
            from_ns,
            until_ns,
        };
        Script(faults.iter().map(fault).collect())
    }

    #[test]
    fn what_is_stretched_takes_longer_only_while_it_is() {
        let script = script(&[(Disturbance::Stretched { percent: 250 }, 100, 200)]);
        assert_eq!(script.end_of(0, 50), Some(50));
        assert_eq!(script.end_of(100, 40), Some(200));
        assert_eq!(script.end_of(50, 100), Some(210), "50 + 40 + 10 of 100");
        assert_eq!(script.end_of(200, 50), Some(250));
    }

    #[test]
    fn a_held_clock_adds_the_time_that_it_is_held() {
        let held = [(Disturbance::ClockHeld, 100, 200)];
        assert_eq!(script(&held).end_of(50, 100), Some(250));
        assert_eq!(script(&held).end_of(150, 10), Some(210));
        let for_ever = script(&[(Disturbance::ClockHeld, 100, u64::MAX)]);
        assert_eq!(for_ever.end_of(50, 50), Some(100));
        assert_eq!(for_ever.end_of(50, 51), None);
    }

    #[test]
    fn a_line_is_held_or_storms_and_is_its_chips_otherwise() {
        let line = SensorLine::ImuReady;
        let high = true;
        let held = script(&[(Disturbance::LineHeld { line, high }, 10, 20)]);
        assert_eq!(held.line(line, false, 0), (false, 10));
        assert_eq!(held.line(line, false, 10), (true, 20));
        assert_eq!(held.line(line, false, 20), (false, u64::MAX));
        assert_eq!(
            held.line(SensorLine::MagEvent, false, 10),
            (false, u64::MAX)
        );

        let percent = 50;
        let deaf = script(&[(Disturbance::LineDeaf { line, percent }, 0, 4 * DEAF_NS)]);
        let heard = [0, 1, 2, 3, 4].map(|window| deaf.line(line, true, window * DEAF_NS).0);
        assert_eq!(heard, [true, false, true, false, true]);
        assert!(!deaf.line(line, false, 0).0, "deaf, not ringing");

        let period_ns = 10;
        let storm = script(&[(Disturbance::LineStorm { line, period_ns }, 100, 125)]);
        let levels = [99, 100, 105, 110, 115, 120, 125].map(|at| storm.line(line, false, at).0);
        assert_eq!(levels, [false, true, false, true, false, true, false]);
        assert_eq!(storm.line(line, false, 107).1, 110);
        assert_eq!(storm.line(line, false, 121).1, 125);
        assert!(storm.line(line, true, 107).0, "the chip's own pulse");
    }
}
