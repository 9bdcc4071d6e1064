//! Reactive dataflow: values that know whether they changed, and sets of them.
//!
//! Knows nothing of flight. A graph is a plain struct of [`Value`]s and straight-line code that
//! recomputes a value when one of its inputs is dirty; propagation stops where a value did not
//! change. No heap, no pointers, no dynamic dispatch: dirty marks are bits of one word.
//!
//! ```
//! use reflex::dataflow::{Dirty, Value};
//!
//! const A: Dirty = Dirty::bit(0);
//! const SUM: Dirty = Dirty::bit(1);
//! let (mut a, mut sum) = (Value::new(2), Value::new(5));
//!
//! let mut dirty = a.set(4, A);
//! if dirty.any(A) {
//!     dirty |= sum.set(a.get() + 3, SUM);
//! }
//! assert!(dirty.any(SUM));
//! assert_eq!(*sum.get(), 7);
//! assert!(sum.set(7, SUM).is_clean(), "an unchanged value stops propagation");
//! ```

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

    /// True where nothing changed.
    #[must_use]
    pub const fn is_clean(self) -> bool {
        self.0 == 0
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

/// A stored value: the one last propagated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Value<T>(T);

impl<T: PartialEq> Value<T> {
    /// A value that nobody was told of yet.
    pub const fn new(value: T) -> Self {
        Self(value)
    }

    /// The value last propagated.
    pub const fn get(&self) -> &T {
        &self.0
    }

    /// Takes a new value; `mark` where it differs from the stored one, else clean.
    #[must_use]
    pub fn set(&mut self, value: T, mark: Dirty) -> Dirty {
        if self.0 == value {
            return Dirty::CLEAN;
        }
        self.0 = value;
        mark
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taking_a_set_leaves_it_clean() {
        let mut dirty = Dirty::bit(3) | Dirty::bit(31);
        let taken = dirty.take();
        assert!(dirty.is_clean());
        assert!(taken.any(Dirty::bit(31)) && !taken.any(Dirty::bit(4)));
    }
}
