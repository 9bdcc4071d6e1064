//! The vertical acceleration loop, hover's thrust as learned, and the angle boost.

use super::Climb;
use crate::airframe::Mixed;
use crate::control::Setpoint;
use crate::control::integral::stepped;
use crate::control::one_pole::{along, gone, time_constant};
use crate::estimate::Increment;
use crate::math::{Quaternion, Vec3, between, limited};
use crate::sensors::GRAVITY;
use crate::settings::gains::arducopter::Gains;
use crate::units::Thrust;

/// The thrust that hover may be learned to need, as a share.
const HOVER_RANGE: [f32; 2] = [0.125, 0.6875];
/// Hover is learned below this climb rate (m/s) and above this cosine of the tilt.
///
/// The angle is 5 degrees.
const HOVERING: (f32, f32) = (0.6, 0.9962);

/// What the vertical acceleration loop remembers between runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lift {
    /// Filtered error of the vertical acceleration, in m/s2, upwards positive.
    error: f32,
    /// Integral term, as a share of thrust.
    integral: f32,
    /// Filtered thrust, 0 to 1.
    throttle: f32,
    /// Thrust that hover needs, as far as it is learned.
    hover: f32,
}

impl Lift {
    /// Before any motion, with the thrust that hover is taken to need, as a share.
    #[must_use]
    pub fn hovering(hover: f32) -> Self {
        Self {
            error: 0.0,
            integral: 0.0,
            throttle: 0.0,
            hover,
        }
    }

    /// The thrust of hover, as far as it is learned, as a share.
    #[must_use]
    pub fn hover(&self) -> f32 {
        self.hover
    }

    /// What remains on the ground: hover's thrust, but no integral.
    #[must_use]
    pub fn grounded(&self) -> Self {
        Self::hovering(self.hover)
    }
}

/// The lift after the motion since the last run, in which `asked` was in force.
///
/// Where nothing was asked, it follows the setpoint's thrust, so that altitude control begins
/// with what the motors give. The integral takes the velocity gained, not the newest force.
#[must_use]
pub fn lifted(
    lift: &Lift,
    motion: &Increment,
    attitude: Quaternion,
    asked: Option<Climb>,
    setpoint: &Setpoint,
    command: &Mixed,
    gains: &Gains,
) -> Lift {
    let dt = motion.dt;
    if dt <= 0.0 {
        return *lift;
    }
    let Some(asked) = asked else {
        let throttle = setpoint.thrust.share();
        return Lift {
            error: 0.0,
            integral: limited(
                throttle - lift.hover,
                gains.altitude.throttle_integral_limit,
            ),
            throttle,
            hover: lift.hover,
        };
    };
    let missing = asked.acceleration * dt - gained(motion, attitude);
    let error = lift.error
        + (missing / dt - lift.error) * gone(dt, time_constant(gains.altitude.error_cutoff_hz));
    let step = gains.altitude.throttle_i * missing;
    let integral = stepped(
        lift.integral,
        step,
        gains.altitude.throttle_integral_limit,
        command.saturated,
    );
    let wanted = |integral: f32| {
        let wanted = lift.hover + gains.altitude.throttle_p * error + integral;
        between(wanted, 0.0, 1.0)
    };
    let way = [wanted(lift.integral), wanted(integral)];
    let throttle = along(
        lift.throttle,
        way,
        dt,
        time_constant(gains.altitude.throttle_cutoff_hz),
    );
    let (climbing, level) = HOVERING;
    let hovers = asked.rate.abs() < climbing && attitude.down_in_body().z > level;
    let learned =
        lift.hover + (throttle - lift.hover) * (dt / (dt + gains.thrust.hover_learning_s));
    let [least, most] = HOVER_RANGE;
    Lift {
        error,
        integral,
        throttle,
        hover: if hovers {
            between(learned, least, most)
        } else {
            lift.hover
        },
    }
}

/// The upward velocity (m/s) gained in a motion, by the attitude in its middle.
fn gained(motion: &Increment, attitude: Quaternion) -> f32 {
    const MOST: Vec3 = Vec3::new(1.0, 1.0, 1.0);
    let middle = attitude.turned_by((motion.angle * -0.5).limited(MOST));
    -(middle.to_earth(motion.velocity).z + GRAVITY * motion.dt)
}

/// The thrust to give, more in a lean: altitude control's where it asks, or given.
///
/// The boost keeps the vertical part of the thrust; from 84 degrees of tilt it falls to none.
#[must_use]
pub fn boosted(
    asked: Option<Climb>,
    lift: &Lift,
    setpoint: &Setpoint,
    attitude: Quaternion,
) -> Thrust {
    let share = match asked {
        Some(_) => lift.throttle,
        None => setpoint.thrust.share(),
    };
    let level = attitude.down_in_body().z;
    let upright = between(10.0 * level, 0.0, 1.0);
    let share = share * upright / between(level, 0.1, 1.0);
    Thrust::new(between(share, 0.0, 1.0)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::{LevelFirst, Mixer};
    use crate::config::arducopter::GAINS;
    use crate::units::TorqueDemand;
    use proptest::prelude::*;

    fn with_room() -> Mixed {
        Mixer::default().mix(TorqueDemand::default(), Thrust::ZERO, &LevelFirst)
    }

    fn start() -> Lift {
        Lift::hovering(GAINS.thrust.hover)
    }

    fn level(share: f32) -> Setpoint {
        Setpoint::level(Thrust::new(share).expect("in range"))
    }

    fn accelerating(upwards: f32, dt: f32) -> Increment {
        Increment {
            velocity: Vec3::new(0.0, 0.0, -(GRAVITY + upwards) * dt),
            dt,
            ..Increment::default()
        }
    }

    fn asking(acceleration: f32) -> Option<Climb> {
        Some(Climb {
            acceleration,
            rate: 0.0,
        })
    }

    fn step(lift: &Lift, motion: &Increment, asked: Option<Climb>) -> Lift {
        let attitude = Quaternion::IDENTITY;
        lifted(
            lift,
            motion,
            attitude,
            asked,
            &level(0.5),
            &with_room(),
            &GAINS,
        )
    }

    #[test]
    fn without_time_nothing_advances() {
        let lift = step(&start(), &accelerating(0.0, 0.1), asking(1.0));
        assert_eq!(step(&lift, &Increment::default(), asking(1.0)), lift);
    }

    #[test]
    fn altitude_control_begins_with_the_thrust_that_was_flown() {
        let lift = step(&start(), &accelerating(0.0, 0.01), None);
        assert_eq!(lift.throttle, 0.5);
        let begun = step(&lift, &accelerating(0.0, 0.01), asking(0.0));
        assert!((begun.throttle - 0.5).abs() < 1e-4);
    }

    #[test]
    fn too_little_lift_is_answered_with_more_thrust() {
        let lift = step(&start(), &accelerating(0.0, 0.01), None);
        let more = step(&lift, &accelerating(0.0, 0.1), asking(2.0));
        assert!(more.throttle > 0.55);
    }

    #[test]
    fn hover_is_learned_in_level_hover_alone() {
        let mut lift = start();
        for _ in 0..10_000 {
            // A vehicle that hovers at half of its thrust.
            let upwards = GRAVITY * (lift.throttle / 0.5 - 1.0);
            lift = step(&lift, &accelerating(upwards, 0.01), asking(0.0));
        }
        assert!((lift.hover - 0.5).abs() < 0.01, "{lift:?}");
        let climbing = Some(Climb {
            acceleration: 0.0,
            rate: 1.0,
        });
        assert_eq!(
            step(&lift, &accelerating(0.0, 0.01), climbing).hover,
            lift.hover
        );
    }

    #[test]
    fn a_lean_is_boosted_and_upside_down_gives_none() {
        let tilted = |angle: f32| {
            let up = Vec3::new(0.0, -libm::sinf(angle), -libm::cosf(angle));
            let attitude = Quaternion::from_up(up).expect("a direction");
            boosted(None, &start(), &level(0.4), attitude).share()
        };
        assert!((tilted(0.0) - 0.4).abs() < 1e-5);
        assert!((tilted(1.0) - 0.4 / libm::cosf(1.0)).abs() < 1e-4);
        assert_eq!(tilted(2.0), 0.0);
    }

    proptest! {
        #[test]
        fn one_long_step_of_a_steady_error_is_many_short_ones(
            asked in -3.0f32..3.0, got in -3.0f32..3.0
        ) {
            let begun = step(&start(), &accelerating(0.0, 0.01), None);
            // The error's filter has settled: in its first 8 ms the steps differ.
            let begun = (0..100).fold(begun, |lift, _| {
                step(&lift, &accelerating(got, 0.001), asking(asked))
            });
            let often = (0..50).fold(begun, |lift, _| {
                step(&lift, &accelerating(got, 0.001), asking(asked))
            });
            let rarely = step(&begun, &accelerating(got, 0.05), asking(asked));
            prop_assert!((often.throttle - rarely.throttle).abs() < 1e-3);
            prop_assert!((often.integral - rarely.integral).abs() < 1e-4);
            prop_assert!((often.hover - rarely.hover).abs() < 1e-3);
        }

        #[test]
        fn thrust_is_within_its_range_on_any_input(
            steps in prop::collection::vec((-1e4f32..1e4, -1e4f32..1e4, 0.0f32..0.2), 1..50),
            x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0
        ) {
            let attitude = Quaternion::from_up(Vec3::new(x, y, z)).unwrap_or_default();
            let mut lift = start();
            for (asked, got, dt) in steps {
                let asked = asking(asked);
                let motion = accelerating(got, dt);
                lift = lifted(&lift, &motion, attitude, asked, &level(0.5), &with_room(), &GAINS);
                prop_assert!((0.0..=1.0).contains(&boosted(asked, &lift, &level(0.5), attitude).share()));
                prop_assert!((0.125..=0.6875).contains(&lift.hover));
                prop_assert!(lift.integral.abs() <= GAINS.altitude.throttle_integral_limit);
            }
        }
    }
}
