//! The inner loop: rate error to torque demands, PID about each axis.

use crate::config::{INTEGRAL_LIMIT, RATE_D, RATE_I, RATE_P};
use crate::math::{Vec3, limited};
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

impl Default for RateLaw {
    fn default() -> Self {
        let vector = |[x, y, z]: [f32; 3]| Vec3::new(x, y, z);
        Self {
            proportional: vector(RATE_P),
            integral: vector(RATE_I),
            derivative: vector(RATE_D),
            integral_limit: INTEGRAL_LIMIT,
        }
    }
}

/// What the rate loop remembers between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateState {
    /// Integral terms, already multiplied by their gain: new gains cause no bump.
    integral: Vec3,
    /// Wanted rates of the step before.
    wanted: Option<BodyRates>,
}

/// What the rate loop sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateInput {
    /// What the attitude loop asks for.
    pub wanted: BodyRates,
    /// The newest filtered rates.
    pub measured: BodyRates,
    /// The newest filtered angular acceleration, in rad/s2.
    pub acceleration: Vec3,
    /// Angle turned since the step before, in rad.
    pub turned: Vec3,
    /// Time since the step before, in seconds.
    pub dt: f32,
    /// The motors could not give the last demand: integrals may shrink but not grow.
    pub saturated: bool,
}

impl RateLaw {
    /// Torque demands; with `dt` of zero the state stays.
    pub fn step(&self, state: &mut RateState, input: &RateInput) -> TorqueDemand {
        state.integral = self.integrated(state, input);
        if input.dt > 0.0 {
            state.wanted = Some(input.wanted);
        }
        self.demand(state.integral, input)
    }

    /// What [`Self::step`] would demand now, leaving no trace.
    #[must_use]
    pub fn foresee(&self, state: &RateState, input: &RateInput) -> TorqueDemand {
        self.demand(self.integrated(state, input), input)
    }

    fn demand(&self, integral: Vec3, input: &RateInput) -> TorqueDemand {
        let error = input.wanted.0 - input.measured.0;
        TorqueDemand(
            error.scale(self.proportional) + integral - input.acceleration.scale(self.derivative),
        )
    }

    /// The integral takes the angle turned, not the newest rate times `dt`: runs that a change
    /// of the rate asked for would sample that rate with a bias.
    fn integrated(&self, state: &RateState, input: &RateInput) -> Vec3 {
        let grow = |integral: f32, step: f32| {
            if input.saturated && integral * step > 0.0 {
                integral
            } else {
                limited(integral + step, self.integral_limit)
            }
        };
        let before = state.wanted.unwrap_or(input.wanted);
        let wanted = (before.0 + input.wanted.0) * (0.5 * input.dt);
        let step = (wanted - input.turned).scale(self.integral);
        Vec3::new(
            grow(state.integral.x, step.x),
            grow(state.integral.y, step.y),
            grow(state.integral.z, step.z),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn about_roll(rate: f32) -> BodyRates {
        BodyRates(Vec3::new(rate, 0.0, 0.0))
    }

    fn input(wanted: f32, measured: f32, dt: f32) -> RateInput {
        RateInput {
            wanted: about_roll(wanted),
            measured: about_roll(measured),
            acceleration: Vec3::ZERO,
            turned: about_roll(measured).0 * dt,
            dt,
            saturated: false,
        }
    }

    #[test]
    fn without_time_the_output_follows_and_the_state_stays() {
        let law = RateLaw::default();
        let mut state = RateState::default();
        law.step(&mut state, &input(1.0, 0.0, 0.01));
        let before = state;
        let torque = law.step(&mut state, &input(2.0, 0.0, 0.0));
        assert_eq!(state, before);
        assert!(torque.0.x > 2.0 * RATE_P[0] * 0.99);
    }

    #[test]
    fn a_saturated_integral_shrinks_but_does_not_grow() {
        let law = RateLaw::default();
        let mut state = RateState::default();
        let saturated = |wanted, dt| RateInput {
            saturated: true,
            ..input(wanted, 0.0, dt)
        };
        law.step(&mut state, &input(1.0, 0.0, 0.01));
        let grown = state.integral.x;
        law.step(&mut state, &saturated(1.0, 0.01));
        assert_eq!(state.integral.x, grown);
        law.step(&mut state, &saturated(-2.0, 0.01));
        assert!(state.integral.x < grown);
    }

    #[test]
    fn rare_steps_integrate_what_frequent_ones_do() {
        let law = RateLaw::default();
        let (mut often, mut rarely) = (RateState::default(), RateState::default());
        let mut turned = Vec3::ZERO;
        for step in 1..=1000 {
            let rate = libm::sinf(step as f32 * 0.7);
            let each = input(0.2, rate, 0.001);
            law.step(&mut often, &each);
            turned += each.turned;
            if step % 50 == 0 {
                law.step(
                    &mut rarely,
                    &RateInput {
                        turned,
                        dt: 0.05,
                        ..each
                    },
                );
                turned = Vec3::ZERO;
            }
        }
        assert!((often.integral - rarely.integral).max_norm() < 1e-6);
    }

    proptest! {
        #[test]
        fn demands_stay_finite_and_integrals_limited_on_any_spacing(
            steps in prop::collection::vec((-20.0f32..20.0, -20.0f32..20.0, 0.0f32..1.0), 1..200)
        ) {
            let law = RateLaw::default();
            let mut state = RateState::default();
            for (wanted, measured, dt) in steps {
                let torque = law.step(&mut state, &input(wanted, measured, dt));
                prop_assert!(torque.is_finite());
                prop_assert!(state.integral.max_norm() <= law.integral_limit);
            }
        }
    }
}
