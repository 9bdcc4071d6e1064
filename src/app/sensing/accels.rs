//! The accelerometers of two chips against each other.
//!
//! They are shaken alike and sampled apart, so that only means compare. Where those differ, the
//! one that is further from 1 g in the mean is wrong: in flight a body is pushed with 1 g in the
//! mean, whatever it does meanwhile. A wrong direction of the right size is not told apart, nor
//! anything where the second chip does not deliver.

use crate::math::Vec3;
use crate::sensors::GRAVITY;
use crate::time::{Instant, seconds, span};

/// Mean difference (m/s2) from which on one is wrong. Strong vibration, sampled ten times a
/// second, leaves 2 m/s2 of noise in the mean.
const APART: f32 = 0.7 * GRAVITY;
/// They agree again below this.
const AGREED: f32 = 0.4 * GRAVITY;
/// Time (s) over which means are taken.
const AVERAGED: f32 = 5.0;
/// A sample stands for the time since the one before, in s, and for no more than this.
const LONGEST: f32 = 0.2;

/// Cosine of 15 degrees. Zero-g offsets (0.05 g a chip) part the two by 5 degrees.
const SAME_WAY: f32 = 0.966;
/// Sine of a tilt (11 degrees) at which a turn about the vertical shows.
const TILTED: f32 = 0.2;
/// A force that is as near to 1 g (m/s2) is gravity, more or less.
const NEAR_G: f32 = 1.0;
/// So many pairs in a row decide.
const PAIRS: u8 = 3;

/// Means of both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Accels {
    difference: Vec3,
    /// Mean of each one's size beyond 1 g, in m/s2.
    beyond: [f32; 2],
    apart: bool,
    /// Pairs in a row, before arming, of which the second says that gravity is elsewhere.
    aslant: u8,
    at: Option<Instant>,
}

impl Accels {
    /// Takes a sample of the second, and the newest of the first; true where they part.
    pub(super) fn take(&mut self, at: Instant, first: Vec3, second: Vec3) -> bool {
        let since = self.at.replace(at).map(|before| seconds(span(before, at)));
        let share = since.unwrap_or_default().min(LONGEST) * (1.0 / AVERAGED);
        self.difference += (second - first - self.difference) * share;
        for (mean, force) in self.beyond.iter_mut().zip([first, second]) {
            *mean += (force.norm() - GRAVITY - *mean) * share;
        }
        let before = self.apart;
        let off = self.difference.max_norm();
        self.apart = off > if before { AGREED } else { APART };
        self.apart && !before
    }

    /// Takes the gravity that both feel of a drone whose motors stand, while it rests or is handled.
    ///
    /// A second chip that is turned about the vertical agrees while the drone is level: only a tilt
    /// shows it, and only a tilt shows that it is right again.
    pub(super) fn compare(&mut self, first: Vec3, second: Vec3) {
        let (one, other) = (first.norm(), second.norm());
        if (one - GRAVITY).abs() > NEAR_G || (other - GRAVITY).abs() > NEAR_G {
            return;
        }
        let tilted = first.x.abs() > TILTED * one || first.y.abs() > TILTED * one;
        if first.dot(second) < SAME_WAY * one * other {
            self.aslant = self.aslant.saturating_add(1);
        } else if tilted || self.aslant < PAIRS {
            self.aslant = 0;
        }
    }

    /// True where the second is not mounted as is said.
    pub(super) fn is_second_aslant(&self) -> bool {
        self.aslant >= PAIRS
    }

    /// True where one of them is wrong.
    pub(super) fn are_apart(&self) -> bool {
        self.apart
    }

    /// False where the first is the wrong one.
    pub(super) fn trusts_first(&self) -> bool {
        let [first, second] = self.beyond;
        !self.apart || first.abs() <= second.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;

    const REST: Vec3 = Vec3::new(0.0, 0.0, -GRAVITY);

    /// After 8 s of ten samples each, shaken by an amount: is one wrong, is the first trusted?
    fn after(first: Vec3, second: Vec3, shaken: f32) -> (bool, bool) {
        let mut accels = Accels::default();
        for sample in 0..80u32 {
            let [here, there] = [11, 17].map(|beat| {
                Vec3::new(shaken, -shaken, shaken) * ((sample * beat % 7) as f32 / 3.0 - 1.0)
            });
            let at = at_micros(u64::from(sample) * 100_000);
            accels.take(at, first + here, second + there);
        }
        (accels.are_apart(), accels.trusts_first())
    }

    #[test]
    fn an_offset_of_one_g_is_found_within_eight_seconds_and_whose_it_is() {
        for offset in [
            Vec3::new(GRAVITY, 0.0, 0.0),
            Vec3::new(0.0, 0.0, -GRAVITY),
            Vec3::new(0.0, -GRAVITY, 0.0),
        ] {
            assert_eq!(after(REST + offset, REST, 0.0), (true, false), "{offset:?}");
            assert_eq!(after(REST, REST + offset, 0.0), (true, true), "{offset:?}");
        }
    }

    #[test]
    fn a_chip_that_is_turned_is_found_upside_down_at_once_and_by_90_degrees_once_tilted() {
        let tilted = Vec3::new(-0.3, 0.0, -0.95) * GRAVITY;
        let aslant = |pairs: &[(Vec3, Vec3)]| {
            let mut accels = Accels::default();
            for (first, second) in pairs {
                (0..4).for_each(|_| accels.compare(*first, *second));
            }
            accels.is_second_aslant()
        };
        let yawed = |felt: Vec3| Vec3::new(-felt.y, felt.x, felt.z);
        assert!(!aslant(&[(REST, REST), (tilted, tilted)]));
        assert!(aslant(&[(REST, -REST)]));
        assert!(!aslant(&[(REST, yawed(REST))]));
        let shown = [
            (REST, yawed(REST)),
            (tilted, yawed(tilted)),
            (REST, yawed(REST)),
        ];
        assert!(aslant(&shown));
        assert!(!aslant(&[(tilted, yawed(tilted)), (tilted, tilted)]));
        // Thrown about, neither feels gravity.
        assert!(!aslant(&[(tilted * 1.5, yawed(tilted) * 1.5)]));
    }

    #[test]
    fn shaking_alone_parts_nothing() {
        assert_eq!(after(REST, REST, 10.0), (false, true));
    }
}
