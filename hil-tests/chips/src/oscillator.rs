//! Free-running clocks: the chips' own idea of a second.

use super::noise::{self, Stream};
use super::options::ChipOptions;

/// Relative error of an oscillator: the option's, or drawn within `tolerance`.
pub fn error(options: &ChipOptions, stream: Stream, tolerance: f64) -> f64 {
    options
        .oscillator_error
        .unwrap_or_else(|| tolerance * noise::symmetric(options.seed, stream))
        .clamp(-0.5, 0.5)
}

/// How far an oscillator is off: by its own error, and by what a fault adds.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    own: f64,
    faster: f64,
}

impl Pace {
    /// A sound one with the error of its specimen.
    pub fn new(own: f64) -> Self {
        Self { own, faster: 0.0 }
    }

    /// It is faster by a share.
    pub fn hurry(&mut self, share: f64) {
        self.faster = share;
    }

    /// Its relative error.
    pub fn error(self) -> f64 {
        // To the bit its own where nothing is added.
        self.own + self.faster * (1.0 + self.own)
    }
}

/// Counts the ticks of a clock, each at an exact nanosecond.
///
/// Instants are computed from the origin, not added up, so they do not drift.
#[derive(Clone, Copy, Debug)]
pub struct Ticker {
    origin_ns: u64,
    ticks_at_origin: u64,
    ticks: u64,
    period_ns: f64,
}

impl Ticker {
    /// A clock of `rate_hz`, off by the relative `error`, started at `now_ns`.
    ///
    /// The first tick is one period later.
    pub fn start(now_ns: u64, rate_hz: f64, error: f64) -> Self {
        Self {
            origin_ns: now_ns,
            ticks_at_origin: 0,
            ticks: 0,
            period_ns: 1e9 / (rate_hz * (1.0 + error)),
        }
    }

    /// Changes the rate from the last tick on, keeping the count.
    pub fn retune(&mut self, rate_hz: f64, error: f64) {
        self.origin_ns = self.instant(self.ticks);
        self.ticks_at_origin = self.ticks;
        self.period_ns = 1e9 / (rate_hz * (1.0 + error));
    }

    /// Ticks so far.
    pub fn ticks(&self) -> u64 {
        self.ticks
    }

    /// When tick number `tick` falls, in ns; it must not precede a retuning.
    #[inline]
    pub fn instant(&self, tick: u64) -> u64 {
        let since = tick.saturating_sub(self.ticks_at_origin);
        // Rounded; `f64::round` is a call of the C library on many hosts, and this is asked often.
        self.origin_ns + (since as f64 * self.period_ns + 0.5) as u64
    }

    /// Takes the next tick if it falls at or before `now_ns`.
    #[inline]
    pub fn tick(&mut self, now_ns: u64) -> Option<u64> {
        let at_ns = self.instant(self.ticks + 1);
        if at_ns > now_ns {
            return None;
        }
        self.ticks += 1;
        Some(at_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fast_clock_ticks_more_often() {
        let mut clock = Ticker::start(0, 1000.0, 0.02);
        while clock.tick(10_000_000_000).is_some() {}
        assert_eq!(clock.ticks(), 10_200);
    }

    #[test]
    fn ticks_do_not_drift_over_an_hour() {
        let clock = Ticker::start(5, 8000.0, 0.0);
        assert_eq!(clock.instant(8000 * 3600), 3_600_000_000_005);
    }

    #[test]
    fn retuning_keeps_the_count_and_the_last_tick() {
        let mut clock = Ticker::start(0, 1000.0, 0.0);
        clock.tick(1_000_000);
        clock.retune(100.0, 0.0);
        assert_eq!(clock.tick(10_999_999), None);
        assert_eq!(clock.tick(11_000_000), Some(11_000_000));
        assert_eq!(clock.ticks(), 2);
    }

    #[test]
    fn the_error_is_drawn_from_the_seed_within_the_tolerance() {
        let draw = |seed| {
            let options = ChipOptions {
                seed,
                ..ChipOptions::default()
            };
            error(&options, Stream::Mpu6050GyroClock, 0.02)
        };
        let errors: Vec<f64> = (0..50).map(draw).collect();
        assert!(errors.iter().all(|error| error.abs() <= 0.02));
        assert!(errors.iter().any(|error| error.abs() > 0.01));
        assert_eq!(draw(9), draw(9));
    }

    #[test]
    fn a_hurried_clock_is_faster_than_its_own_error_says() {
        let mut pace = Pace::new(0.02);
        assert_eq!(pace.error(), 0.02);
        pace.hurry(0.1);
        assert!((pace.error() - 0.122).abs() < 1e-12);
    }

    #[test]
    fn a_fixed_error_is_used_as_given() {
        let options = ChipOptions {
            oscillator_error: Some(-0.03),
            ..ChipOptions::default()
        };
        assert_eq!(error(&options, Stream::Mpu6050GyroClock, 0.02), -0.03);
    }
}
