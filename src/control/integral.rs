//! An integral term behind motors that cannot give all that is asked.

use crate::math::{between, max, min};

/// The term after a step, within a limit; while the motors saturate, it only shrinks.
///
/// Then it ends at zero. Autopilots of short steps compare signs: a step against the integral
/// counts, and passes zero by no more than itself. A rare run's step would pass it by what gathered
/// in the whole stretch, to where the same rule holds it fast.
pub(in crate::control) fn stepped(integral: f32, step: f32, limit: f32, saturated: bool) -> f32 {
    let [low, high] = if saturated {
        [min(integral, 0.0), max(integral, 0.0)]
    } else {
        [-limit, limit]
    };
    between(integral + step, low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LIMIT: f32 = 0.5;

    /// After a step that came in so many parts.
    fn after(integral: f32, step: f32, parts: u16, saturated: bool) -> f32 {
        let part = step / f32::from(parts);
        (0..parts).fold(integral, |integral, _| {
            stepped(integral, part, LIMIT, saturated)
        })
    }

    proptest! {
        #[test]
        fn one_step_is_worth_as_much_as_its_parts(
            integral in -LIMIT..LIMIT, step in -1.0f32..1.0, parts in 2u16..100, saturated: bool
        ) {
            let (rarely, often) = (
                after(integral, step, 1, saturated),
                after(integral, step, parts, saturated),
            );
            prop_assert!((rarely - often).abs() < 1e-5, "{rarely} {often}");
        }

        #[test]
        fn behind_saturated_motors_it_neither_grows_nor_turns(
            integral in -LIMIT..LIMIT, step in -1.0f32..1.0
        ) {
            let stepped = stepped(integral, step, LIMIT, true);
            prop_assert!(stepped.abs() <= integral.abs() && stepped * integral >= 0.0);
        }
    }
}
