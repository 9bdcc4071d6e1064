//! The inner loop: rate error to torque demands, PID about each axis.

use super::integral::stepped;
use crate::estimate::Rotation;
use crate::math::Vec3;
use crate::units::{BodyRates, TorqueDemand};

/// Gains of the rate loop, about each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateLaw {
    /// Share of full authority per rad/s of error.
    pub proportional: Vec3,
    /// Share of full authority per rad of integrated error.
    pub integral: Vec3,
    /// Share of full authority per rad/s2 of measured acceleration.
    pub derivative: Vec3,
    /// The largest share that integration may reach.
    pub integral_limit: f32,
}

/// What the rate loop remembers between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateState {
    /// Integral terms, already multiplied by their gain: new gains cause no bump.
    integral: Vec3,
}

/// A stretch of time as the integral terms see it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateStretch {
    /// Desired rates integrated over it, in rad.
    pub wanted: Vec3,
    /// Angle turned in it, in rad.
    pub turned: Vec3,
    /// The motors could not give the demand: integrals only shrink.
    pub saturated: bool,
}

/// The rates that the rate loop compares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateInput {
    /// What the attitude loop asks for.
    pub wanted: BodyRates,
    /// The newest filtered rates.
    pub measured: BodyRates,
    /// The newest filtered angular acceleration, in rad/s2.
    pub acceleration: Vec3,
}

impl RateInput {
    /// What is asked for beside what is measured.
    #[must_use]
    pub fn of(wanted: BodyRates, rotation: &Rotation) -> Self {
        Self {
            wanted,
            measured: rotation.rates,
            acceleration: rotation.acceleration,
        }
    }
}

impl RateLaw {
    /// The law of proportional, integral and derivative gains and a limit, as their fields have them.
    #[must_use]
    pub const fn new(
        [proportional, integral, derivative]: [[f32; 3]; 3],
        integral_limit: f32,
    ) -> Self {
        Self {
            proportional: Vec3::from_array(proportional),
            integral: Vec3::from_array(integral),
            derivative: Vec3::from_array(derivative),
            integral_limit,
        }
    }

    /// The state after a stretch of time; one of no length leaves it as it is.
    ///
    /// The integral takes the angle turned, not the newest rate times `dt`: runs that a change
    /// of the rate asked for would sample that rate with a bias. The same goes for the desired
    /// rates, which is why they come integrated.
    #[must_use]
    pub fn after(&self, state: &RateState, stretch: &RateStretch) -> RateState {
        let grow = |integral: f32, step: f32| {
            stepped(integral, step, self.integral_limit, stretch.saturated)
        };
        let step = (stretch.wanted - stretch.turned).scale(self.integral);
        let before = state.integral;
        RateState {
            integral: Vec3::new(
                grow(before.x, step.x),
                grow(before.y, step.y),
                grow(before.z, step.z),
            ),
        }
    }

    /// Torque demands in a state.
    #[must_use]
    pub fn demand(&self, state: &RateState, input: &RateInput) -> TorqueDemand {
        let error = input.wanted.0 - input.measured.0;
        TorqueDemand(
            error.scale(self.proportional) + state.integral
                - input.acceleration.scale(self.derivative),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::cascade::GAINS;
    use proptest::prelude::*;

    const LAW: RateLaw = RateLaw::new(
        [GAINS.rate.p, GAINS.rate.i, GAINS.rate.d],
        GAINS.rate.integral_limit,
    );

    fn about_roll(angle: f32) -> Vec3 {
        Vec3::new(angle, 0.0, 0.0)
    }

    fn stretch(wanted: f32, turned: f32) -> RateStretch {
        RateStretch {
            wanted: about_roll(wanted),
            turned: about_roll(turned),
            saturated: false,
        }
    }

    #[test]
    fn without_time_the_output_follows_and_the_state_stays() {
        let law = LAW;
        let state = law.after(&RateState::default(), &stretch(0.01, 0.0));
        assert_eq!(law.after(&state, &RateStretch::default()), state);
        let input = RateInput {
            wanted: BodyRates(about_roll(2.0)),
            ..RateInput::default()
        };
        assert!(law.demand(&state, &input).0.x > 2.0 * GAINS.rate.p[0] * 0.99);
    }

    #[test]
    fn a_saturated_integral_shrinks_but_does_not_grow() {
        let law = LAW;
        let saturated = |wanted| RateStretch {
            saturated: true,
            ..stretch(wanted, 0.0)
        };
        let grown = law.after(&RateState::default(), &stretch(0.01, 0.0));
        assert_eq!(law.after(&grown, &saturated(0.01)), grown);
        let shrunk = law.after(&grown, &saturated(-0.02));
        assert!(shrunk.integral.x < grown.integral.x);
    }

    #[test]
    fn rare_steps_integrate_what_frequent_ones_do() {
        let law = LAW;
        let (mut often, mut rarely) = (RateState::default(), RateState::default());
        let mut turned = 0.0;
        for step in 1..=1000 {
            let each = libm::sinf(step as f32 * 0.7) * 0.001;
            often = law.after(&often, &stretch(0.000_2, each));
            turned += each;
            if step % 50 == 0 {
                rarely = law.after(&rarely, &stretch(0.01, turned));
                turned = 0.0;
            }
        }
        assert!((often.integral - rarely.integral).max_norm() < 1e-6);
    }

    proptest! {
        #[test]
        fn demands_stay_finite_and_integrals_limited_on_any_spacing(
            steps in prop::collection::vec((-20.0f32..20.0, -20.0f32..20.0, 0.0f32..1.0), 1..200)
        ) {
            let law = LAW;
            let mut state = RateState::default();
            for (wanted, measured, dt) in steps {
                state = law.after(&state, &stretch(wanted * dt, measured * dt));
                let input = RateInput {
                    wanted: BodyRates(about_roll(wanted)),
                    measured: BodyRates(about_roll(measured)),
                    acceleration: Vec3::ZERO,
                };
                prop_assert!(law.demand(&state, &input).is_finite());
                prop_assert!(state.integral.max_norm() <= law.integral_limit);
            }
        }
    }
}
