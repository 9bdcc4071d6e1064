//! One number for each motor, however many there are.

use core::fmt;
use core::num::NonZeroU32;
use core::ops::{Deref, DerefMut};

use crate::settings::{FEWEST_MOTORS, MOST_MOTORS};

/// One share of full scale per motor, in the order of the outputs. Readers see it as a slice.
#[derive(Clone, Copy)]
pub struct MotorShares {
    shares: [f32; MOST_MOTORS],
    /// A whole word and never zero, so that copies and options of it take few instructions.
    count: NonZeroU32,
}

impl MotorShares {
    /// The same share for so many motors, 1 to [`MOST_MOTORS`].
    #[must_use]
    pub const fn all(share: f32, count: usize) -> Self {
        let mut shares = [0.0; MOST_MOTORS];
        let (mut left, mut given) = (shares.as_mut_slice(), 0);
        while let [first, rest @ ..] = left
            && given < count
        {
            *first = share;
            given += 1;
            left = rest;
        }
        Self {
            shares,
            count: counted(given),
        }
    }

    /// Folds the shares beside those of as many other motors.
    ///
    /// Every sample does this: the first four, which every airframe has, are straight lines.
    #[inline]
    #[must_use]
    pub fn fold_with<T>(&self, other: &Self, start: T, fold: impl Fn(T, f32, f32) -> T) -> T {
        let (first, rest) = self.shares.split_at(FEWEST_MOTORS);
        let (others, other_rest) = other.shares.split_at(FEWEST_MOTORS);
        let both = |so_far, (share, other): (&f32, &f32)| fold(so_far, *share, *other);
        let so_far = first.iter().zip(others).fold(start, both);
        if self.count() == FEWEST_MOTORS {
            return so_far;
        }
        // Where there is no motor, both are zero.
        rest.iter().zip(other_rest).fold(so_far, both)
    }

    const fn count(&self) -> usize {
        self.count.get() as usize
    }

    /// Each share after a change.
    #[must_use]
    pub fn map(mut self, change: impl Fn(f32) -> f32) -> Self {
        self.iter_mut().for_each(|share| *share = change(*share));
        self
    }
}

/// The shares of up to [`MOST_MOTORS`] motors.
impl<const N: usize> From<[f32; N]> for MotorShares {
    fn from(of_each: [f32; N]) -> Self {
        const { assert!(0 < N && N <= MOST_MOTORS) }
        let mut shares = [0.0; MOST_MOTORS];
        for (share, of_motor) in shares.iter_mut().zip(of_each) {
            *share = of_motor;
        }
        Self {
            shares,
            count: counted(N),
        }
    }
}

/// Motors as a number; there is one at least.
const fn counted(motors: usize) -> NonZeroU32 {
    match NonZeroU32::new(motors as u32) {
        Some(count) => count,
        None => NonZeroU32::MIN,
    }
}

impl Deref for MotorShares {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        self.shares.get(..self.count()).unwrap_or_default()
    }
}

impl DerefMut for MotorShares {
    fn deref_mut(&mut self) -> &mut [f32] {
        let count = self.count();
        self.shares.get_mut(..count).unwrap_or_default()
    }
}

impl PartialEq for MotorShares {
    fn eq(&self, other: &Self) -> bool {
        if self.first() != other.first() {
            return false;
        }
        // Commands seldom repeat: a look at one motor settles most.
        core::hint::cold_path();
        **self == **other
    }
}

impl fmt::Debug for MotorShares {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}
