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

/// How many instructions were executed when.
///
/// A sleeping core executes none, so instructions over the rate are the time
/// it was busy.
#[derive(Clone, Debug)]
pub struct Load {
    /// Instructions the core executes in a second without sleep.
    pub instructions_per_second: u64,
    /// Instant in ns and instructions until then, in order of time.
    pub samples: Vec<(u64, u64)>,
}

impl Load {
    /// Instructions executed from reset to the end of the run.
    pub fn instructions(&self) -> u64 {
        self.samples.last().map_or(0, |last| last.1)
    }

    /// Share of the time from `from_ns` to the end that the core was awake.
    ///
    /// Counted from the first sample at or after `from_ns`; 0 when there is
    /// no time left after it.
    pub fn busy_fraction(&self, from_ns: u64) -> f64 {
        let from = self.samples.iter().find(|sample| sample.0 >= from_ns);
        let (Some(&(start, before)), Some(&(end, after))) = (from, self.samples.last()) else {
            return 0.0;
        };
        if end == start {
            return 0.0;
        }
        let possible = (end - start) as f64 * 1e-9 * self.instructions_per_second as f64;
        (after - before) as f64 / possible
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_busy_fraction_can_leave_the_start_out() {
        let load = Load {
            instructions_per_second: 1_000,
            samples: vec![(0, 0), (1_000_000_000, 1_000), (3_000_000_000, 1_500)],
        };
        assert_eq!(load.busy_fraction(0), 0.5);
        assert_eq!(load.busy_fraction(1), 0.25);
        assert_eq!(load.busy_fraction(3_000_000_000), 0.0);
        assert_eq!(load.busy_fraction(9_000_000_000), 0.0);
    }
}
