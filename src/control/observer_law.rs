//! The rate loop with an observer: what disturbs is estimated and cancelled.
//!
//! A model of the motors says how a demand moves the rates. What they did besides, behind a
//! low-pass filter, is the disturbance (Chen et al. 2000, "A nonlinear disturbance observer for
//! robotic manipulators"; with the filter's corner at infinity, incremental control). It answers
//! a gust before an error of the rate has been integrated.
//!
//! Over a stretch of any length the demand stands and rates move linearly. What the motors give in
//! it counts by its mean: after a change of the demand the estimate of a stretch of 50 ms is within
//! 3 % of that change of the result of many short ones.

use super::one_pole::along;
use super::rate_law::RateInput;
use crate::math::{Vec3, limited};
use crate::settings::gains::observer::Gains;
use crate::units::{BodyRates, TorqueDemand};

/// Gains of the rate loop with its observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverLaw {
    /// Share of full authority per rad/s of error, about each axis.
    pub proportional: Vec3,
    /// Share of full authority per rad/s2 of measured acceleration, about each axis.
    pub derivative: Vec3,
    /// Angular acceleration per share of full authority, in rad/s2, about each axis.
    pub effectiveness: Vec3,
    /// Time constant from a demand to a measured rate, in s.
    pub lag: f32,
    /// How fast the estimate follows what disturbs, in 1/s.
    pub bandwidth: f32,
    /// The largest share of full authority that is cancelled.
    pub limit: f32,
}

/// What the observer remembers between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObserverState {
    /// The demand as the motors give it, a share of full authority.
    given: Vec3,
    /// Rates at the end of the last stretch, in rad/s.
    rates: BodyRates,
    /// Angular acceleration that nothing else explains, as a share of full authority.
    disturbance: Vec3,
}

/// A stretch of time as the observer sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObserverStretch {
    /// The demand in force.
    pub asked: TorqueDemand,
    /// Filtered rates at its end.
    pub rates: BodyRates,
    /// Its length, in s.
    pub dt: f32,
    /// The motors could not give the demand: what they gave is unknown, and nothing is learned.
    pub saturated: bool,
}

impl ObserverState {
    /// The same without anything that was seen to disturb.
    #[must_use]
    pub fn undisturbed(&self) -> Self {
        Self {
            disturbance: Vec3::ZERO,
            ..*self
        }
    }
}

impl ObserverLaw {
    /// The law of some gains.
    #[must_use]
    pub const fn new(gains: &Gains) -> Self {
        Self {
            proportional: Vec3::from_array(gains.rate.p),
            derivative: Vec3::from_array(gains.rate.d),
            effectiveness: Vec3::from_array(gains.observer.effectiveness),
            lag: gains.observer.lag_s,
            bandwidth: gains.observer.bandwidth,
            limit: gains.observer.limit,
        }
    }

    /// The state after a stretch of time; one of no length leaves it as it is.
    #[must_use]
    pub fn after(&self, state: &ObserverState, stretch: &ObserverStretch) -> ObserverState {
        if stretch.dt <= 0.0 {
            return *state;
        }
        let turned = stretch.rates.0 - state.rates.0;
        let axis = |asked: f32, given: f32, turned: f32, effect: f32, known: f32| {
            let now = along(given, [asked; 2], stretch.dt, self.lag);
            // The lag's step response, integrated over the stretch.
            let mean = asked + (given - now) * (self.lag / stretch.dt);
            let unexplained = turned / (effect * stretch.dt) - mean;
            let learned = along(known, [unexplained; 2], stretch.dt, 1.0 / self.bandwidth);
            let known = if stretch.saturated { known } else { learned };
            (now, limited(known, self.limit))
        };
        let (asked, given, known) = (stretch.asked.0, state.given, state.disturbance);
        let effect = self.effectiveness;
        let roll = axis(asked.x, given.x, turned.x, effect.x, known.x);
        let pitch = axis(asked.y, given.y, turned.y, effect.y, known.y);
        let yaw = axis(asked.z, given.z, turned.z, effect.z, known.z);
        ObserverState {
            given: Vec3::new(roll.0, pitch.0, yaw.0),
            rates: stretch.rates,
            disturbance: Vec3::new(roll.1, pitch.1, yaw.1),
        }
    }

    /// Torque demands in a state.
    #[must_use]
    pub fn demand(&self, state: &ObserverState, input: &RateInput) -> TorqueDemand {
        let error = input.wanted.0 - input.measured.0;
        TorqueDemand(
            error.scale(self.proportional)
                - input.acceleration.scale(self.derivative)
                - state.disturbance,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::observer::GAINS;
    use proptest::prelude::*;

    const LAW: ObserverLaw = ObserverLaw::new(&GAINS);

    fn about_roll(value: f32) -> Vec3 {
        Vec3::new(value, 0.0, 0.0)
    }

    fn stretch(asked: f32, rate: f32, dt: f32) -> ObserverStretch {
        ObserverStretch {
            asked: TorqueDemand(about_roll(asked)),
            rates: BodyRates(about_roll(rate)),
            dt,
            saturated: false,
        }
    }

    /// A body that motors and a steady push turn about roll, and its loop every `dt` for a second.
    fn pushed(push: f32, dt: f32) -> (ObserverState, f32) {
        let law = LAW;
        let (mut state, mut rate, mut given) = (ObserverState::default(), 0.0, 0.0);
        for _ in 0..(1.0 / dt) as u32 {
            let input = RateInput {
                measured: BodyRates(about_roll(rate)),
                ..RateInput::default()
            };
            let asked = law.demand(&state, &input).0.x;
            let fine = dt / 20.0;
            for _ in 0..20 {
                rate += (given * law.effectiveness.x + push) * fine;
                given = along(given, [asked; 2], fine, law.lag);
            }
            state = law.after(&state, &stretch(asked, rate, dt));
        }
        (state, rate)
    }

    #[test]
    fn a_steady_push_is_found_and_cancelled_however_rare_the_runs() {
        for dt in [0.001, 0.005, 0.02] {
            let (state, rate) = pushed(20.0, dt);
            let share = 20.0 / LAW.effectiveness.x;
            let found = state.disturbance.x / share;
            assert!((found - 1.0).abs() < 0.1, "{dt} s: {found}");
            assert!(rate.abs() < 0.1, "{dt} s: {rate}");
        }
    }

    #[test]
    fn what_the_motors_explain_is_no_disturbance() {
        let law = LAW;
        let (mut state, mut rate, mut given) = (ObserverState::default(), 0.0, 0.0);
        for _ in 0..500 {
            rate += given * law.effectiveness.x * 0.001;
            given = along(given, [0.01; 2], 0.001, law.lag);
            state = law.after(&state, &stretch(0.01, rate, 0.001));
        }
        assert!(
            rate > 1.0 && state.disturbance.max_norm() < 3e-4,
            "{state:?}"
        );
    }

    #[test]
    fn nothing_is_learned_without_time_or_from_saturated_motors() {
        let law = LAW;
        let state = law.after(&ObserverState::default(), &stretch(0.0, 0.5, 0.01));
        assert!(state.disturbance.x > 0.0);
        assert_eq!(law.after(&state, &stretch(0.3, 2.0, 0.0)), state);
        let saturated = ObserverStretch {
            saturated: true,
            ..stretch(1.0, -3.0, 0.01)
        };
        let after = law.after(&state, &saturated);
        assert_eq!(after.disturbance, state.disturbance);
        assert_eq!(after.undisturbed().disturbance, Vec3::ZERO);
    }

    proptest! {
        #[test]
        fn one_long_stretch_comes_to_what_many_short_ones_do(
            asked in -1.0f32..1.0, from in -3.0f32..3.0, slope in -20.0f32..20.0,
            pieces in 1..50u8,
        ) {
            let law = ObserverLaw { limit: 10.0, ..LAW };
            let start = law.after(&ObserverState::default(), &stretch(0.0, from, 0.1));
            let rarely = law.after(&start, &stretch(asked, from + slope * 0.05, 0.05));
            let piece = 0.05 / f32::from(pieces);
            let often = (1..=pieces).fold(start, |state, n| {
                law.after(&state, &stretch(asked, from + slope * piece * f32::from(n), piece))
            });
            let apart = (often.disturbance - rarely.disturbance).max_norm();
            prop_assert!(apart < 0.03 * asked.abs() + 1e-4, "{apart}");
            prop_assert!((often.given - rarely.given).max_norm() < 1e-5);
        }

        #[test]
        fn demands_stay_finite_and_what_is_cancelled_limited(
            steps in prop::collection::vec((-9.0f32..9.0, -40.0f32..40.0, 0.0f32..1.0), 1..200)
        ) {
            let law = LAW;
            let mut state = ObserverState::default();
            for (asked, rate, dt) in steps {
                state = law.after(&state, &stretch(asked, rate, dt));
                prop_assert!(law.demand(&state, &RateInput::default()).is_finite());
                prop_assert!(state.disturbance.max_norm() <= law.limit);
            }
        }
    }
}
