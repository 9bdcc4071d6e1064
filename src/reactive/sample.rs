//! What an input delivers: something whose change has a size.

use crate::airframe::MotorShares;
use crate::math::{Vec3, max};

/// A value that can be held against another of its kind.
pub trait Sample: Copy {
    /// The size of the change since `reference`, at least zero, in the input's unit.
    #[must_use]
    fn change_since(&self, reference: &Self) -> f32;
}

/// Three axes compare as the chips do: any of them past the threshold.
impl Sample for Vec3 {
    fn change_since(&self, reference: &Self) -> f32 {
        let change = *self - *reference;
        [change.x, change.y, change.z].into_iter().fold(0.0, larger)
    }
}

/// A motor vector changes as much as the motor that changes most.
impl Sample for MotorShares {
    fn change_since(&self, reference: &Self) -> f32 {
        self.fold_with(reference, 0.0, |most, share, before| {
            larger(most, share - before)
        })
    }
}

/// The larger of two sizes; that of a change that is no number does not count.
fn larger(most: f32, change: f32) -> f32 {
    max(change.abs(), most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_as_large_as_that_of_the_axis_that_changed_most() {
        let before = Vec3::new(1.0, 2.0, 3.0);
        for (axis, size) in [(0, 0.5), (1, -0.75), (2, 4.0)] {
            let mut after = before.to_array();
            after[axis] += size;
            let [x, y, z] = after;
            assert_eq!(Vec3::new(x, y, z).change_since(&before), size.abs());
        }
    }

    #[test]
    fn what_is_no_number_hides_no_change() {
        let broken = Vec3::new(f32::NAN, 0.5, f32::NAN);
        assert_eq!(broken.change_since(&Vec3::ZERO), 0.5);
    }
}
