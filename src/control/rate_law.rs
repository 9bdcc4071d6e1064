//! The inner loop: rate error to torque demands, PID about each axis.

use crate::config::{INTEGRAL_LIMIT, RATE_D, RATE_D_CUTOFF, RATE_I, RATE_P};
use crate::math::Vec3;
use crate::units::{BodyRates, TorqueDemand};
use core::f32::consts::TAU;

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
    /// Corner of the derivative's low-pass, in Hz.
    pub derivative_cutoff: f32,
}

impl Default for RateLaw {
    fn default() -> Self {
        let vector = |[x, y, z]: [f32; 3]| Vec3::new(x, y, z);
        Self {
            proportional: vector(RATE_P),
            integral: vector(RATE_I),
            derivative: vector(RATE_D),
            integral_limit: INTEGRAL_LIMIT,
            derivative_cutoff: RATE_D_CUTOFF,
        }
    }
}

/// What the rate loop remembers between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateState {
    /// Integral terms, already multiplied by their gain: new gains cause no bump.
    integral: Vec3,
    /// Filtered angular acceleration in rad/s2.
    acceleration: Vec3,
    /// The rates of the step before.
    rates: Option<BodyRates>,
}

impl RateLaw {
    /// Torque demands for a rate error over the last `dt` seconds.
    ///
    /// While `saturated`, integrals may shrink but not grow. With `dt` of zero the state stays.
    pub fn step(
        &self,
        state: &mut RateState,
        wanted: BodyRates,
        measured: BodyRates,
        dt: f32,
        saturated: bool,
    ) -> TorqueDemand {
        let error = wanted.0 - measured.0;
        if dt > 0.0 {
            self.integrate(state, error, dt, saturated);
            self.differentiate(state, measured, dt);
        }
        TorqueDemand(
            error.scale(self.proportional) + state.integral
                - state.acceleration.scale(self.derivative),
        )
    }

    fn integrate(&self, state: &mut RateState, error: Vec3, dt: f32, saturated: bool) {
        let grow = |integral: f32, step: f32| {
            if saturated && integral * step > 0.0 {
                integral
            } else {
                (integral + step).clamp(-self.integral_limit, self.integral_limit)
            }
        };
        let step = error.scale(self.integral) * dt;
        state.integral = Vec3::new(
            grow(state.integral.x, step.x),
            grow(state.integral.y, step.y),
            grow(state.integral.z, step.z),
        );
    }

    /// The low-pass follows the measured `dt`, so that rare runs smooth no further than needed.
    fn differentiate(&self, state: &mut RateState, measured: BodyRates, dt: f32) {
        if let Some(before) = state.rates {
            let acceleration = (measured.0 - before.0) * (1.0 / dt);
            let reach = TAU * self.derivative_cutoff * dt;
            let gain = reach / (1.0 + reach);
            state.acceleration += (acceleration - state.acceleration) * gain;
        }
        state.rates = Some(measured);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn about_roll(rate: f32) -> BodyRates {
        BodyRates(Vec3::new(rate, 0.0, 0.0))
    }

    #[test]
    fn without_time_the_output_follows_and_the_state_stays() {
        let law = RateLaw::default();
        let mut state = RateState::default();
        law.step(&mut state, about_roll(1.0), about_roll(0.0), 0.01, false);
        let before = state;
        let torque = law.step(&mut state, about_roll(2.0), about_roll(0.0), 0.0, false);
        assert_eq!(state, before);
        assert!(torque.0.x > 2.0 * RATE_P[0] * 0.99);
    }

    #[test]
    fn a_saturated_integral_shrinks_but_does_not_grow() {
        let law = RateLaw::default();
        let mut state = RateState::default();
        law.step(&mut state, about_roll(1.0), about_roll(0.0), 0.01, false);
        let grown = state.integral.x;
        law.step(&mut state, about_roll(1.0), about_roll(0.0), 0.01, true);
        assert_eq!(state.integral.x, grown);
        law.step(&mut state, about_roll(-1.0), about_roll(0.0), 0.005, true);
        assert!(state.integral.x < grown);
    }

    proptest! {
        #[test]
        fn demands_stay_finite_and_integrals_limited_on_any_spacing(
            steps in prop::collection::vec((-20.0f32..20.0, -20.0f32..20.0, 0.0f32..1.0), 1..200)
        ) {
            let law = RateLaw::default();
            let mut state = RateState::default();
            for (wanted, measured, dt) in steps {
                let torque = law.step(&mut state, about_roll(wanted), about_roll(measured), dt, false);
                prop_assert!(torque.is_finite());
                prop_assert!(state.integral.max_norm() <= law.integral_limit);
            }
        }
    }
}
