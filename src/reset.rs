//! Why the processor started anew, and the last words of what ran before.
//!
//! Whatever ends the firmware leaves a few words in memory that a reset keeps. The next start
//! finds them, tells them and hands them on as a part of [`Reset`]: a drone that fell out of the
//! air by itself is not to be armed as if nothing had been.

use reflex_settings::bytes::{CHECKSUM, Vec, put, take};

use crate::numbered::numbered;

numbered! {
    /// What reset the processor.
    ResetCause {
        /// The supply came up.
        PowerOn,
        /// The supply sagged below the brown-out level and came back.
        BrownOut,
        /// A button or a probe pulled the reset pin.
        Pin,
        /// A program, or a probe, asked for it.
        Software,
        /// The watchdog was not fed.
        Watchdog,
        /// Another reason, which this firmware gives no occasion for.
        Other,
    }
}

numbered! {
    /// What must be seen for the watchdog to be fed.
    Sign {
        /// Control ran when it had to.
        Control,
        /// Samples come, or their silence was noticed.
        Sensors,
        /// The task of the chips runs.
        Chips,
        /// The link's task runs.
        Link,
        /// Idle gets its turn.
        Idle,
    }
}

numbered! {
    /// How the firmware ended.
    Ending {
        /// It panicked.
        Panic,
        /// The processor refused an instruction or an access.
        HardFault,
        /// The stack grew out of its memory.
        StackOverflow,
        /// The crystal stopped.
        ClockLost,
        /// An interrupt came that has no task.
        Unhandled,
        /// A sign of life was missing, so that the watchdog was not fed.
        Starved(Sign in Sign::ALL),
    }
}

numbered! {
    /// How the drone flew.
    Mode {
        /// Motors stood.
        Ground,
        /// Control ran by the clock, to learn.
        WarmUp,
        /// Control ran when a change called for it.
        Reactive,
        /// Control ran by the clock, for a reason.
        Fallback,
        /// Control ran without an inertial sensor.
        Blind,
        /// Control ran by the clock, by choice.
        Periodic,
    }
}

/// What was known when the firmware ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LastWords {
    /// How it ended.
    pub ending: Ending,
    /// How the drone flew, as the failsafe's task saw it last: at most 0.1 s before.
    pub mode: Mode,
    /// The exception whose task was active, by its number; 0 in idle.
    pub exception: u8,
    /// Address of the instruction.
    pub program_counter: u32,
    /// Address that its function would have returned to.
    pub link_register: u32,
    /// Address of a panic's place in the source; otherwise 0.
    pub place: u32,
}

/// Told from memory that holds anything.
const MAGIC: [u8; 4] = *b"RFLW";

impl LastWords {
    /// Length in bytes.
    pub const LENGTH: usize = 24;

    /// The words with a magic before and a checksum behind them.
    #[must_use]
    #[inline(never)] // In several places, none of them fast.
    pub fn to_bytes(&self) -> [u8; Self::LENGTH] {
        let mut bytes: Vec<u8, { Self::LENGTH }> = Vec::new();
        put(&mut bytes, &MAGIC);
        let (ending, mode) = (self.ending.number(), self.mode.number());
        put(&mut bytes, &[ending, mode, self.exception, 0]);
        put(&mut bytes, &self.program_counter.to_le_bytes());
        put(&mut bytes, &self.link_register.to_le_bytes());
        put(&mut bytes, &self.place.to_le_bytes());
        let checksum = CHECKSUM.checksum(&bytes);
        put(&mut bytes, &checksum.to_le_bytes());
        bytes.into_array().unwrap_or([0; Self::LENGTH])
    }

    /// Reads them; `None` where nothing, or something damaged, was left.
    #[must_use]
    #[inline(never)]
    pub fn from_bytes(bytes: &[u8; Self::LENGTH]) -> Option<Self> {
        let (mut content, checksum) = bytes.split_last_chunk()?;
        let expected = CHECKSUM.checksum(content);
        if take(&mut content) != Some(MAGIC) || expected != u32::from_le_bytes(*checksum) {
            return None;
        }
        let [ending, mode, exception, _] = take(&mut content)?;
        let mut word = || take(&mut content).map(u32::from_le_bytes);
        Some(Self {
            ending: Ending::from_number(ending)?,
            mode: Mode::from_number(mode)?,
            exception,
            program_counter: word()?,
            link_register: word()?,
            place: word()?,
        })
    }
}

/// What a start is told about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reset {
    /// What reset the processor.
    pub cause: ResetCause,
    /// What the firmware before it left.
    pub last_words: Option<LastWords>,
    /// The supply in mV below which the processor is held in reset, where the option bytes set one.
    pub brown_out_mv: Option<u16>,
}

impl Reset {
    /// True where nobody asked for it: arming waits for somebody to take note.
    #[must_use]
    pub fn is_unexpected(&self) -> bool {
        let asked_for = match self.cause {
            ResetCause::PowerOn | ResetCause::Pin | ResetCause::Software => true,
            ResetCause::BrownOut | ResetCause::Watchdog | ResetCause::Other => false,
        };
        !asked_for || self.last_words.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORDS: LastWords = LastWords {
        ending: Ending::Starved(Sign::Link),
        mode: Mode::Reactive,
        exception: 36,
        program_counter: 0x0800_1234,
        link_register: 0x0800_5679,
        place: 0x0802_0000,
    };

    #[test]
    fn last_words_survive_as_bytes() {
        for ending in Ending::ALL {
            for mode in Mode::ALL {
                let words = LastWords {
                    ending,
                    mode,
                    ..WORDS
                };
                assert_eq!(LastWords::from_bytes(&words.to_bytes()), Some(words));
            }
        }
    }

    #[test]
    fn memory_after_a_power_cut_holds_no_words() {
        assert_eq!(LastWords::from_bytes(&[0; LastWords::LENGTH]), None);
        assert_eq!(LastWords::from_bytes(&[0xFF; LastWords::LENGTH]), None);
        for bit in 0..LastWords::LENGTH * 8 {
            let mut bytes = WORDS.to_bytes();
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(LastWords::from_bytes(&bytes), None, "bit {bit}");
        }
    }

    #[test]
    fn a_reset_that_nobody_asked_for_or_that_left_words_is_unexpected() {
        let expected = [
            (ResetCause::PowerOn, false),
            (ResetCause::BrownOut, true),
            (ResetCause::Pin, false),
            (ResetCause::Software, false),
            (ResetCause::Watchdog, true),
            (ResetCause::Other, true),
        ];
        assert_eq!(expected.map(|(cause, _)| cause), ResetCause::ALL);
        for (cause, unexpected) in expected {
            let mut reset = Reset {
                cause,
                last_words: None,
                brown_out_mv: None,
            };
            assert_eq!(reset.is_unexpected(), unexpected, "{cause:?}");
            reset.last_words = Some(WORDS);
            assert!(reset.is_unexpected(), "{cause:?}");
        }
    }
}
