//! One number for each motor, however many there are.

use core::fmt;
use core::ops::{Deref, DerefMut};

use crate::settings::MOST_MOTORS;

/// One share of full scale per motor, in the order of the outputs; a slice to whoever reads it.
#[derive(Clone, Copy, Default)]
pub struct MotorShares {
    shares: [f32; MOST_MOTORS],
    count: u8,
}

impl MotorShares {
    /// The same share for so many motors, [`MOST_MOTORS`] at most.
    #[must_use]
    pub const fn all(share: f32, count: usize) -> Self {
        let count = if count < MOST_MOTORS {
            count
        } else {
            MOST_MOTORS
        };
        Self {
            shares: [share; MOST_MOTORS],
            count: count as u8,
        }
    }

    /// The first so many of some numbers, [`MOST_MOTORS`] at most.
    #[must_use]
    pub const fn first(shares: [f32; MOST_MOTORS], count: usize) -> Self {
        Self {
            shares,
            ..Self::all(0.0, count)
        }
    }

    /// What becomes of each share.
    #[must_use]
    pub fn map(&self, mut of: impl FnMut(f32) -> f32) -> Self {
        let mut mapped = *self;
        mapped.iter_mut().for_each(|share| *share = of(*share));
        mapped
    }
}

impl Deref for MotorShares {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        self.shares
            .get(..usize::from(self.count))
            .unwrap_or_default()
    }
}

impl DerefMut for MotorShares {
    fn deref_mut(&mut self) -> &mut [f32] {
        let count = usize::from(self.count);
        self.shares.get_mut(..count).unwrap_or_default()
    }
}

impl PartialEq for MotorShares {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl fmt::Debug for MotorShares {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}
