//! The vertical acceleration, low-pass filtered: what damps the altitude hold.

use crate::estimate::Increment;
use crate::math::{Quaternion, limited};
use crate::sensors::GRAVITY;
use crate::settings::gains::cleanflight::Altitude;
use core::f32::consts::TAU;

/// The largest acceleration that is believed, in m/s2: just above 16 g, the range of accelerometers on drones.
const LARGEST: f32 = 160.0;

/// How the vertical speed changes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Climb {
    /// Upward acceleration in m/s2, filtered.
    pub acceleration: f32,
}

/// The filter after the motion since the last run; `dt` of zero advances nothing.
///
/// One pole, exact for an acceleration that was steady between the runs.
#[must_use]
pub fn climbing(
    before: &Climb,
    motion: &Increment,
    attitude: Quaternion,
    gains: &Altitude,
) -> Climb {
    if motion.dt <= 0.0 {
        return *before;
    }
    let force = attitude.to_earth(motion.velocity * (1.0 / motion.dt));
    let upward = limited(-force.z - GRAVITY, LARGEST);
    let kept = libm::expf(-TAU * gains.accel_cutoff_hz * motion.dt);
    Climb {
        acceleration: upward + (before.acceleration - upward) * kept,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::cleanflight::GAINS;
    use crate::math::Vec3;
    use proptest::prelude::*;

    fn pushed(upward: f32, dt: f32) -> Increment {
        Increment {
            velocity: Vec3::new(0.0, 0.0, -GRAVITY - upward) * dt,
            dt,
            ..Increment::default()
        }
    }

    #[test]
    fn without_time_nothing_advances() {
        let before = Climb { acceleration: 1.0 };
        let after = climbing(
            &before,
            &Increment::default(),
            Quaternion::IDENTITY,
            &GAINS.altitude,
        );
        assert_eq!(after, before);
    }

    proptest! {
        #[test]
        fn rare_steps_come_to_the_same_as_frequent_ones(upward in -5.0f32..5.0) {
            let run = |runs: u32, dt| (0..runs).fold(Climb::default(), |climb, _| {
                climbing(&climb, &pushed(upward, dt), Quaternion::IDENTITY, &GAINS.altitude)
            });
            let (often, rarely) = (run(50, 0.001), run(1, 0.05));
            prop_assert!((often.acceleration - rarely.acceleration).abs() < 1e-3);
        }

        #[test]
        fn the_acceleration_stays_bounded(force in any::<f32>(), dt in 0.0f32..1.0) {
            let motion = Increment {
                velocity: Vec3::new(0.0, force, force),
                dt,
                ..Increment::default()
            };
            let after = climbing(&Climb::default(), &motion, Quaternion::IDENTITY, &GAINS.altitude);
            prop_assert!(after.acceleration.abs() <= LARGEST);
        }
    }
}
