//! The accelerometers of two chips against each other.
//!
//! They are shaken alike and sampled apart, so that only means compare. Where those differ, the
//! one that is further from 1 g in the mean is wrong: in flight a body is pushed with 1 g in the
//! mean, whatever it does meanwhile. A wrong direction of the right size is not told apart, nor
//! anything where the second chip does not deliver.

use crate::math::Vec3;
use crate::sensors::GRAVITY;

/// Mean difference (m/s2) from which on one is wrong: half of 1 g.
const APART: f32 = 0.5 * GRAVITY;
/// They agree again below this.
const AGREED: f32 = 0.3 * GRAVITY;
/// Share with which a sample enters the means: ten a second come at least, for 2 s.
const SHARE: f32 = 0.05;

/// Means of both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Accels {
    difference: Vec3,
    /// Mean of each one's size beyond 1 g, in m/s2.
    beyond: [f32; 2],
    apart: bool,
}

impl Accels {
    /// Takes a sample of the second, and the newest of the first; true where they part.
    pub(super) fn take(&mut self, first: Vec3, second: Vec3) -> bool {
        self.difference += (second - first - self.difference) * SHARE;
        for (mean, force) in self.beyond.iter_mut().zip([first, second]) {
            *mean += (force.norm() - GRAVITY - *mean) * SHARE;
        }
        let before = self.apart;
        let off = self.difference.max_norm();
        self.apart = off > if before { AGREED } else { APART };
        self.apart && !before
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

    const REST: Vec3 = Vec3::new(0.0, 0.0, -GRAVITY);

    /// After 2 s of ten samples each, shaken by an amount: is one wrong, is the first trusted?
    fn after(first: Vec3, second: Vec3, shaken: f32) -> (bool, bool) {
        let mut accels = Accels::default();
        for sample in 0..20u32 {
            let [here, there] = [11, 17].map(|beat| {
                Vec3::new(shaken, -shaken, shaken) * ((sample * beat % 7) as f32 / 3.0 - 1.0)
            });
            accels.take(first + here, second + there);
        }
        (accels.are_apart(), accels.trusts_first())
    }

    #[test]
    fn an_offset_of_one_g_is_found_within_two_seconds_and_whose_it_is() {
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
    fn shaking_alone_parts_nothing() {
        assert_eq!(after(REST, REST, 10.0), (false, true));
    }
}
