//! Earth's field from a measured one: iron that travels with the chip bends it.

use crate::math::Vec3;
use crate::settings::Settings;

/// What the iron of a board does to a field in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iron {
    /// What magnets add, in gauss.
    pub hard: [f32; 3],
    /// Of the symmetric matrix that undoes what steel bends: xx, yy, zz.
    pub diagonal: [f32; 3],
    /// The same: xy, xz, yz.
    pub off_diagonal: [f32; 3],
}

impl Iron {
    /// No iron.
    pub const NONE: Self = Self {
        hard: [0.0; 3],
        diagonal: [1.0; 3],
        off_diagonal: [0.0; 3],
    };

    /// That of the settings.
    #[must_use]
    pub const fn of(settings: &Settings) -> Self {
        Self {
            hard: settings.hard_iron,
            diagonal: settings.soft_iron_diagonal,
            off_diagonal: settings.soft_iron_off_diagonal,
        }
    }

    /// The field without the iron.
    #[inline]
    #[must_use]
    pub fn removed(&self, field: Vec3) -> Vec3 {
        // A board without iron computes nothing.
        if *self == Self::NONE {
            return field;
        }
        let Vec3 { x, y, z } = field - Vec3::from_array(self.hard);
        let ([xx, yy, zz], [xy, xz, yz]) = (self.diagonal, self.off_diagonal);
        Vec3::new(
            xx * x + xy * y + xz * z,
            xy * x + yy * y + yz * z,
            xz * x + yz * y + zz * z,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn without_iron_a_field_keeps_its_bits() {
        let field = Vec3::new(0.2, -0.0, 0.4);
        let bits = |field: Vec3| [field.x, field.y, field.z].map(f32::to_bits);
        assert_eq!(bits(Iron::NONE.removed(field)), bits(field));
    }

    proptest! {
        /// A matrix and its inverse, of a rank-one change: I + t u u'.
        #[test]
        fn a_bent_field_is_straightened(
            hard in [-1.0_f32..1.0, -1.0..1.0, -1.0..1.0],
            along in [-1.0_f32..1.0, -1.0..1.0, -1.0..1.0],
            much in 0.0_f32..0.4,
            field in [-0.6_f32..0.6, -0.6..0.6, -0.6..0.6],
        ) {
            let (along, field) = (Vec3::from_array(along), Vec3::from_array(field));
            let [x, y, z] = [along.x, along.y, along.z];
            let share = much / (1.0 + along.dot(along));
            let iron = Iron {
                hard,
                diagonal: [1.0 + share * x * x, 1.0 + share * y * y, 1.0 + share * z * z],
                off_diagonal: [share * x * y, share * x * z, share * y * z],
            };
            let bent = field - along * (share * along.dot(field) / (1.0 + share * along.dot(along)));
            let measured = bent + Vec3::from_array(hard);
            let off = iron.removed(measured) - field;
            prop_assert!(off.norm() < 1e-5, "{off:?}");
        }
    }
}
