//! What the ground station knows of the drone's place: late, noisy and adrift.

use std::collections::VecDeque;

use nalgebra::Vector3;
use rand_distr::{Distribution, StandardNormal};
use random_streams::{Generator, generator};
use reflex_config::plant::Tracking;

/// Keeps this noise apart from that of the sensors and of the wind of the same seed.
const STREAM: u64 = 0x5354_4154;
/// The same of the drift, which is not drawn where there is none.
const DRIFT_STREAM: u64 = 0x4452_4946;

/// A place and a velocity, north, east, down.
pub(super) type Seen = (Vector3<f64>, Vector3<f64>);

/// Tracks one drone.
pub(super) struct Tracker {
    tracking: Tracking,
    first_ns: u64,
    noise: Generator,
    wander: Generator,
    /// m off, slowly changing.
    drift: Vector3<f64>,
    /// What was true, back to what is reported now.
    past: VecDeque<(u64, Seen)>,
    reports: u64,
}

impl Tracker {
    /// One whose first report is due at an instant.
    pub(super) fn new(tracking: &Tracking, first_ns: u64, seed: u64) -> Self {
        Self {
            tracking: tracking.clone(),
            first_ns,
            noise: generator(seed, STREAM),
            wander: generator(seed, DRIFT_STREAM),
            drift: Vector3::zeros(),
            past: VecDeque::new(),
            reports: 0,
        }
    }

    /// Time between two reports, s.
    pub(super) fn period_s(&self) -> f64 {
        1.0 / self.tracking.rate_hz
    }

    /// Sees the drone as it is, and reports where one is due.
    pub(super) fn look(&mut self, at_ns: u64, truth: Seen) -> Option<Seen> {
        let delay_ns = (self.tracking.delay_s * 1e9) as u64;
        self.past.push_back((at_ns, truth));
        while self
            .past
            .get(1)
            .is_some_and(|next| next.0 + delay_ns <= at_ns)
        {
            self.past.pop_front();
        }
        let period_ns = 1e9 / self.tracking.rate_hz;
        if at_ns < self.first_ns + (self.reports as f64 * period_ns) as u64 {
            return None;
        }
        self.reports += 1;
        self.wander();
        let (_, (position, velocity)) = *self.past.front()?;
        let position = position + self.drift;
        Some((
            blurred(&mut self.noise, &position, self.tracking.noise_m),
            blurred(&mut self.noise, &velocity, self.tracking.noise_m_s),
        ))
    }

    /// A Gauss-Markov process from nothing: places count from where the drone starts.
    fn wander(&mut self) {
        let Tracking {
            drift_m, drift_s, ..
        } = self.tracking;
        if drift_m > 0.0 {
            let kept = (-self.period_s() / drift_s).exp();
            let kick = drift_m * (1.0 - kept * kept).sqrt();
            self.drift = blurred(&mut self.wander, &(self.drift * kept), kick);
        }
    }
}

fn blurred(chance: &mut Generator, exact: &Vector3<f64>, deviation: f64) -> Vector3<f64> {
    exact.map(|axis| {
        let noise: f64 = StandardNormal.sample(chance);
        axis + deviation * noise
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRACKING: Tracking = Tracking {
        rate_hz: 5.0,
        delay_s: 0.0,
        noise_m: 0.0,
        noise_m_s: 0.0,
        drift_m: 0.0,
        drift_s: 60.0,
    };

    /// Reports of a drone that flies north at 1 m/s, asked for every 10 ms.
    fn reports(tracking: &Tracking, seconds: u64) -> Vec<(f64, Seen)> {
        let mut tracker = Tracker::new(tracking, 500_000_000, 1);
        let look = |tick: u64| {
            let at_s = tick as f64 / 100.0;
            let truth = (Vector3::x() * at_s, Vector3::x());
            Some((at_s, tracker.look(tick * 10_000_000, truth)?))
        };
        (0..seconds * 100).filter_map(look).collect()
    }

    #[test]
    fn reports_come_at_their_rate_and_are_as_old_as_the_delay() {
        let late = Tracking {
            delay_s: 0.12,
            ..TRACKING
        };
        for (tracking, age_s) in [(TRACKING, 0.0), (late, 0.12)] {
            let reports = reports(&tracking, 4);
            assert_eq!((reports.len(), reports[0].0), (18, 0.5));
            for (at_s, (position, velocity)) in reports {
                assert!(
                    (at_s - position.x - age_s).abs() < 1e-9,
                    "{at_s} {position}"
                );
                assert_eq!(velocity, Vector3::x());
            }
        }
    }

    #[test]
    fn drift_is_slow_and_as_large_as_stated_in_the_long_run() {
        let adrift = Tracking {
            drift_m: 1.0,
            drift_s: 10.0,
            ..TRACKING
        };
        let off: Vec<f64> = (reports(&adrift, 20_000).iter())
            .map(|(at_s, (position, _))| position.x - at_s)
            .collect();
        let mean = off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64;
        assert!((0.8..1.2).contains(&mean.sqrt()), "{mean}");
        let step = off
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).powi(2))
            .sum::<f64>();
        let step = (step / off.len() as f64).sqrt();
        assert!((0.15..0.25).contains(&step), "{step}");
    }
}
