//! Sets of values that changed, as marks in one word.

use core::ops::{BitOr, BitOrAssign};

/// A set of up to 32 values that changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dirty(u32);

impl Dirty {
    /// Nothing changed.
    pub const CLEAN: Self = Self(0);

    /// The set of one value; `number` counts from 0 to 31.
    #[must_use]
    pub const fn bit(number: u32) -> Self {
        Self(1 << number)
    }

    /// Both sets together, also in constants.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// True where some value of `of` changed.
    #[must_use]
    pub const fn any(self, of: Self) -> bool {
        self.0 & of.0 != 0
    }

    /// True where every value of `of` changed.
    #[must_use]
    pub const fn all(self, of: Self) -> bool {
        self.0 & of.0 == of.0
    }

    /// The set, leaving nothing behind.
    #[must_use]
    pub const fn take(&mut self) -> Self {
        core::mem::replace(self, Self::CLEAN)
    }
}

impl BitOr for Dirty {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        self.or(other)
    }
}

impl BitOrAssign for Dirty {
    fn bitor_assign(&mut self, other: Self) {
        *self = self.or(other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taking_a_set_leaves_it_clean() {
        let mut dirty = Dirty::bit(3) | Dirty::bit(31);
        assert!(dirty.any(Dirty::bit(31)));
        assert!(!dirty.all(Dirty::bit(31).or(Dirty::bit(0))));
        assert!(dirty.take().all(Dirty::bit(3)));
        assert_eq!(dirty, Dirty::CLEAN);
    }
}
