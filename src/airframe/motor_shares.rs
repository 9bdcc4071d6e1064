//! One number for each motor, however many there are.

use core::fmt;
use core::ops::{Deref, DerefMut};

use crate::settings::{FEWEST_MOTORS, MOST_MOTORS};

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
    #[inline(always)]
    pub fn map(&self, of: impl Fn(f32) -> f32) -> Self {
        self.zip(self, |share, _| of(share))
    }

    /// What becomes of each share beside another's.
    #[must_use]
    #[inline(always)]
    pub fn zip(&self, other: &Self, of: impl Fn(f32, f32) -> f32) -> Self {
        let mut zipped = *self;
        let ([first, rest], [others, others_rest]) =
            (halves_mut(&mut zipped.shares), halves(&other.shares));
        let put = |(share, other): (&mut f32, &f32)| *share = of(*share, *other);
        first.iter_mut().zip(others).for_each(put);
        rest.iter_mut()
            .zip(others_rest)
            .take(self.beyond())
            .for_each(put);
        zipped
    }

    /// What all shares come to, one after the other, each beside another's.
    #[must_use]
    #[inline(always)]
    pub fn fold<T>(&self, other: &Self, start: T, of: impl Fn(T, f32, f32) -> T) -> T {
        let ([first, rest], [others, others_rest]) = (halves(&self.shares), halves(&other.shares));
        let take = |so_far, (share, other): (&f32, &f32)| of(so_far, *share, *other);
        let so_far = first.iter().zip(others).fold(start, take);
        let rest = rest.iter().zip(others_rest).take(self.beyond());
        rest.fold(so_far, take)
    }

    /// Motors behind the first four, which every airframe has.
    fn beyond(&self) -> usize {
        usize::from(self.count).saturating_sub(FEWEST_MOTORS)
    }
}

/// Those that every airframe has, so that loops over them are straight lines, and the others.
#[inline(always)]
fn halves(shares: &[f32; MOST_MOTORS]) -> [&[f32]; 2] {
    let (first, rest) = shares.split_at(FEWEST_MOTORS);
    [first, rest]
}

/// As [`halves`].
#[inline(always)]
fn halves_mut(shares: &mut [f32; MOST_MOTORS]) -> [&mut [f32]; 2] {
    let (first, rest) = shares.split_at_mut(FEWEST_MOTORS);
    [first, rest]
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
