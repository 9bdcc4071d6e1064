//! What a run leaves behind: load, stack, link, and gaps of the model.

use crate::Tally;

/// Results that are known only once a run has ended.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// How long the board ran, in ns.
    pub ended_ns: u64,
    /// Instructions executed, over time.
    pub load: Load,
    /// Stack used and reserved.
    pub stack: StackUse,
    /// Traffic on the link.
    pub link: LinkUse,
    /// Time between two pulses of motor 1, in ns; none when it stands still.
    pub motor_period_ns: Option<u64>,
    /// Frames of the firmware's log that could not be decoded.
    pub damaged_log_frames: u64,
    /// Registers the firmware used that no model answers for.
    ///
    /// Each is `INSTANCE.REGISTER`. They read and keep what was written.
    pub unmodelled: Vec<String>,
    /// The instructions, where they were counted.
    pub tally: Option<Tally>,
}

/// Bytes that crossed the link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkUse {
    /// Bytes the firmware received.
    pub received: u64,
    /// Bytes the firmware sent.
    pub sent: u64,
    /// Bytes sent to the firmware before its receiver was enabled: lost.
    pub lost: u64,
    /// Bytes scheduled but not yet sent to the firmware.
    pub waiting: u64,
}

/// Stack, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StackUse {
    /// Deepest use: the high-water mark.
    pub used: u32,
    /// Reserved for it.
    pub available: u32,
}

/// Cycles that silicon takes to enter an exception, of a Cortex-M4 whose memory has no wait states.
pub const ENTRY_CYCLES: u64 = 12;
/// Those to leave it.
pub const EXIT_CYCLES: u64 = 10;
/// Both. One exception that follows another at once takes 6 in place of them (ARM 100166, 3.9), and is not told
/// apart: this is the most.
pub const EXCEPTION_CYCLES: u64 = ENTRY_CYCLES + EXIT_CYCLES;

/// How many instructions were executed when.
///
/// A sleeping core executes none, so instructions over the rate are the time
/// it was busy. The emulated core enters and leaves exceptions for nothing:
/// they are counted, and charged apart.
#[derive(Clone, Debug)]
pub struct Load {
    /// Instructions the core executes in a second without sleep.
    pub instructions_per_second: u64,
    /// In order of time.
    pub samples: Vec<LoadSample>,
}

/// What the core had done by an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadSample {
    /// ns.
    pub at_ns: u64,
    /// Instructions executed.
    pub instructions: u64,
    /// Exceptions entered.
    pub exceptions: u64,
}

impl Load {
    /// Instructions executed from reset to the end of the run.
    pub fn instructions(&self) -> u64 {
        self.samples.last().map_or(0, |last| last.instructions)
    }

    /// Share of the time from `from_ns` to the end that the core was awake.
    ///
    /// Counted from the first sample at or after `from_ns`; 0 when there is
    /// no time left after it.
    pub fn busy_fraction(&self, from_ns: u64) -> f64 {
        self.per_second(from_ns, |sample| sample.instructions) / self.instructions_per_second as f64
    }

    /// The same with the cycles that its exceptions take on silicon, at most 1.
    pub fn busy_with_exceptions(&self, from_ns: u64) -> f64 {
        let cycles = self.exceptions_per_second(from_ns) * EXCEPTION_CYCLES as f64;
        (self.busy_fraction(from_ns) + cycles / self.instructions_per_second as f64).min(1.0)
    }

    /// Exceptions entered a second in that time.
    pub fn exceptions_per_second(&self, from_ns: u64) -> f64 {
        self.per_second(from_ns, |sample| sample.exceptions)
    }

    fn per_second(&self, from_ns: u64, count: impl Fn(&LoadSample) -> u64) -> f64 {
        let from = self.samples.iter().find(|sample| sample.at_ns >= from_ns);
        let (Some(start), Some(end)) = (from, self.samples.last()) else {
            return 0.0;
        };
        if end.at_ns == start.at_ns {
            return 0.0;
        }
        (count(end) - count(start)) as f64 / ((end.at_ns - start.at_ns) as f64 * 1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_busy_fraction_can_leave_the_start_out() {
        let load = Load {
            instructions_per_second: 1_000,
            samples: [(0, 0, 0), (1, 1_000, 4), (3, 1_500, 14)]
                .map(|(second, instructions, exceptions)| LoadSample {
                    at_ns: second * 1_000_000_000,
                    instructions,
                    exceptions,
                })
                .into(),
        };
        assert_eq!(load.busy_fraction(0), 0.5);
        assert_eq!(load.busy_fraction(1), 0.25);
        assert_eq!(load.busy_fraction(3_000_000_000), 0.0);
        assert_eq!(load.busy_fraction(9_000_000_000), 0.0);
        assert_eq!(load.exceptions_per_second(1), 5.0);
        assert_eq!(load.busy_with_exceptions(1), 0.25 + 5.0 * 22.0 / 1_000.0);
    }
}
