//! What an input delivers: something whose change has a size.

use crate::airframe::MotorShares;
use crate::math::Vec3;

/// A value that can be held against another of its kind.
pub trait Sample: Copy {
    /// The size of the change since `reference`, at least zero, in the input's unit.
    #[must_use]
    fn change_since(&self, reference: &Self) -> f32;
}

/// Three axes compare as the chips do: any of them past the threshold.
impl Sample for Vec3 {
    fn change_since(&self, reference: &Self) -> f32 {
        (*self - *reference).max_norm()
    }
}

/// A motor vector changes as much as the motor that changes most.
impl Sample for MotorShares {
    fn change_since(&self, reference: &Self) -> f32 {
        self.iter()
            .zip(reference)
            .fold(0.0, |most: f32, (share, before)| {
                most.max((share - before).abs())
            })
    }
}
