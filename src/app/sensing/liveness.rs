//! Signs of life of the gating sensor: a sample that differs from the one before.
//!
//! A threshold cannot tell a steady sensor from a stuck one: neither ever changes. But no real
//! sensor repeats itself to the last bit for long, since its noise is several counts.

use crate::sensors::ImuReading;
use crate::time::{Duration, Instant, at_micros, micros, span};

/// How long the gating sensor may take to deliver its first sample.
const WAKING: Duration = micros(1_000_000);

/// Since when the gating sensor repeats itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Liveness {
    newest: ImuReading,
    changed: Option<Instant>,
    told: bool,
}

/// What a reading says about its sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sign {
    /// It is alive.
    Alive,
    /// It has repeated itself for too long; first noticed now.
    Stuck,
    /// It still does.
    StillStuck,
}

impl Liveness {
    /// Takes a reading; stuck where all have been the same for longer than `patience`.
    pub(super) fn take(&mut self, at: Instant, reading: &ImuReading, patience: Duration) -> Sign {
        let changed = *self.changed.get_or_insert(at);
        if *reading != self.newest {
            *self = Self {
                newest: *reading,
                changed: Some(at),
                told: false,
            };
        } else if span(changed, at) >= patience {
            return if core::mem::replace(&mut self.told, true) {
                Sign::StillStuck
            } else {
                Sign::Stuck
            };
        }
        Sign::Alive
    }
}

/// When the gating sensor was last heard.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Silence {
    heard: Option<Instant>,
    /// The silence was noticed and lasts.
    noticed: bool,
}

impl Silence {
    /// The gating sensor delivered a sample.
    pub(super) fn end(&mut self, at: Instant) {
        self.heard = Some(at);
        self.noticed = false;
    }

    /// True while a silence that was noticed lasts.
    pub(super) fn lasts(&self) -> bool {
        self.noticed
    }

    /// True once per silence that is longer than `patience`.
    ///
    /// At start-up the sensor is given its time to wake.
    pub(super) fn notice(&mut self, now: Instant, patience: Duration) -> bool {
        let silent = self.is_longer(now, patience);
        let noticed = silent && !self.noticed;
        self.noticed = silent;
        noticed
    }

    /// True where a silence lasts longer than `patience` and nobody noticed.
    pub(super) fn is_overlooked(&self, now: Instant, patience: Duration) -> bool {
        !self.noticed && self.is_longer(now, patience)
    }

    fn is_longer(&self, now: Instant, patience: Duration) -> bool {
        match self.heard {
            Some(at) => span(at, now) > patience,
            None => now > at_micros(0) + WAKING,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sensor_that_repeats_itself_is_told_of_once_until_it_moves() {
        let mut liveness = Liveness::default();
        let mut take = |at, count| {
            let reading = ImuReading {
                temperature: f32::from(count),
                ..ImuReading::default()
            };
            liveness.take(at_micros(at), &reading, micros(2_000))
        };
        assert_eq!(take(0, 1_i16), Sign::Alive);
        assert_eq!(take(1_000, 1), Sign::Alive);
        assert_eq!(take(2_000, 1), Sign::Stuck);
        assert_eq!(take(3_000, 1), Sign::StillStuck);
        assert_eq!(take(4_000, 2), Sign::Alive);
        assert_eq!(take(5_000, 2), Sign::Alive);
        assert_eq!(take(6_000, 2), Sign::Stuck);
    }
}
