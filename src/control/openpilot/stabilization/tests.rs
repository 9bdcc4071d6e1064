//! Tests of the cascade of attitude PI and rate PID.

use super::*;
use crate::config::openpilot::GAINS;
use crate::units::Thrust;
use proptest::prelude::*;

const LAW: Stabilization = Stabilization::new(&GAINS);

/// The configured law with an integral in the attitude loop, off by default.
fn with_attitude_integral() -> Stabilization {
    let mut law = LAW;
    law.attitude.integral = Vec3::new(1.5, 1.5, 1.5);
    law
}

fn level() -> Setpoint {
    Setpoint::level(Thrust::new(0.5).expect("in range"))
}

fn about_roll(x: f32) -> Vec3 {
    Vec3::new(x, 0.0, 0.0)
}

/// Turning about roll: angle and rate at the start, angular acceleration.
#[derive(Clone, Copy)]
struct Roll {
    angle: f32,
    rate: f32,
    acceleration: f32,
}

impl Roll {
    fn after(self, t: f32) -> Self {
        Self {
            angle: self.angle + self.rate * t + 0.5 * self.acceleration * t * t,
            rate: self.rate + self.acceleration * t,
            ..self
        }
    }

    fn error(self, setpoint: &Setpoint) -> AttitudeError {
        let (sin, cos) = crate::math::sin_cos(0.5 * self.angle);
        let attitude = Quaternion {
            w: cos,
            v: about_roll(sin),
        };
        AttitudeError::of(attitude, setpoint)
    }

    fn stretch(self, dt: f32, setpoint: &Setpoint) -> StabilizedStretch {
        let end = self.after(dt);
        let turned = about_roll(end.angle - self.angle);
        let swept = 0.5 * self.rate * dt * dt + self.acceleration * dt * dt * dt / 6.0;
        let (before, after) = (self.error(setpoint), end.error(setpoint));
        StabilizedStretch {
            error: ErrorStretch::of_turn(
                [before.angle, after.angle],
                [turned, about_roll(swept)],
                before.axes,
                dt,
            ),
            axes: before.axes,
            turned,
            measured: BodyRates(about_roll(end.rate)),
        }
    }

    /// The integrals after 50 ms in this many steps.
    fn integrals(self, law: &Stabilization, before: Integrals, steps: u16) -> Integrals {
        let dt = 0.05 / f32::from(steps);
        let setpoint = level();
        let start = Integrals {
            measured: BodyRates(about_roll(self.rate)),
            ..before
        };
        (0..steps).fold(start, |state, k| {
            let stretch = self.after(f32::from(k) * dt).stretch(dt, &setpoint);
            law.after(&state, &setpoint, &stretch)
        })
    }
}

fn apart(a: &Integrals, b: &Integrals) -> (f32, f32) {
    let rate = |state: &Integrals| LAW.rate.demand(&state.rate, &RateInput::default()).0;
    (
        (a.attitude - b.attitude).max_norm(),
        (rate(a) - rate(b)).max_norm(),
    )
}

#[test]
fn rolled_right_of_the_target_asks_for_roll_to_the_left_by_the_published_gain() {
    let roll = Roll {
        angle: 0.2,
        rate: 0.0,
        acceleration: 0.0,
    };
    let wanted = LAW.wanted(&roll.error(&level()), &Integrals::default(), &level());
    assert!((wanted.0.x + 0.5).abs() < 0.01, "{wanted:?}");
}

#[test]
fn rate_mode_flies_the_rates_as_far_as_sticks_go() {
    let setpoint = Setpoint {
        attitude: None,
        rates: BodyRates(Vec3::new(1.0, -9.0, 0.5)),
        ..level()
    };
    let tilted = Quaternion::IDENTITY.turned_by(about_roll(0.3));
    let error = AttitudeError::of(tilted, &setpoint);
    let wanted = LAW.wanted(&error, &Integrals::default(), &setpoint).0;
    assert_eq!(
        wanted,
        Vec3::new(1.0, -GAINS.attitude.manual_rate_rad_s[1], 0.5)
    );
}

#[test]
fn without_thrust_nothing_is_integrated() {
    let law = with_attitude_integral();
    let roll = Roll {
        angle: 0.2,
        rate: 0.0,
        acceleration: 0.0,
    };
    let state = roll.integrals(&law, Integrals::default(), 1);
    assert!(state != Integrals::default());
    let cut = Setpoint::level(Thrust::ZERO);
    let stretch = roll.stretch(0.01, &cut);
    assert_eq!(law.after(&state, &cut, &stretch), Integrals::default());
}

#[test]
fn without_time_nothing_advances() {
    let law = with_attitude_integral();
    let roll = Roll {
        angle: 0.2,
        rate: 1.0,
        acceleration: 0.0,
    };
    let state = roll.integrals(&law, Integrals::default(), 1);
    let stretch = roll.stretch(0.0, &level());
    assert_eq!(law.after(&state, &level(), &stretch), state);
}

#[test]
fn a_rate_on_an_axis_forgets_the_integral_of_its_attitude() {
    let law = with_attitude_integral();
    let roll = Roll {
        angle: 0.2,
        rate: 0.0,
        acceleration: 0.0,
    };
    let state = roll.integrals(&law, Integrals::default(), 1);
    assert!(state.attitude.x < -0.01);
    let acro = Setpoint {
        attitude: None,
        ..level()
    };
    let after = law.after(&state, &acro, &roll.stretch(0.01, &acro));
    assert_eq!(after.attitude, Vec3::ZERO);
}

proptest! {
    #[test]
    fn one_step_of_50_ms_integrates_what_50_of_1_ms_do(
        angle in -1.0f32..1.0, rate in -6.0f32..6.0, acceleration in -60.0f32..60.0
    ) {
        let law = with_attitude_integral();
        let roll = Roll { angle, rate, acceleration };
        let often = roll.integrals(&law, Integrals::default(), 50);
        let rarely = roll.integrals(&law, Integrals::default(), 1);
        let (attitude, rate) = apart(&often, &rarely);
        prop_assert!(attitude < 5e-6, "attitude {}", attitude);
        prop_assert!(rate < 5e-5, "rate {}", rate);
    }

    #[test]
    fn and_so_they_do_from_integrals_at_their_limits(
        angle in -1.0f32..1.0, rate in -6.0f32..6.0, acceleration in -60.0f32..60.0,
        up in any::<bool>()
    ) {
        let law = with_attitude_integral();
        let wound = Roll { angle: if up { -1.2 } else { 1.2 }, rate: 0.0, acceleration: 0.0 };
        let mut full = Integrals::default();
        for _ in 0..100 {
            full = wound.integrals(&law, full, 1);
        }
        prop_assert_eq!(full.attitude.x.abs(), GAINS.attitude.integral_limit_rad_s[0]);
        let roll = Roll { angle, rate, acceleration };
        let (attitude, rate) =
            apart(&roll.integrals(&law, full, 50), &roll.integrals(&law, full, 1));
        prop_assert!(attitude < 2e-3, "attitude {}", attitude);
        prop_assert!(rate < 3e-4, "rate {}", rate);
    }

    #[test]
    fn whatever_comes_demands_are_finite_and_limited(
        steps in prop::collection::vec(
            (-1e4f32..1e4, -1e4f32..1e4, -1e4f32..1e4, 0.0f32..1.0), 1..100
        )
    ) {
        let law = with_attitude_integral();
        let mut state = Integrals::default();
        for (error, turned, rate, dt) in steps {
            let (error, turned) = (Vec3::new(error, -error, rate), Vec3::new(turned, rate, 0.0));
            let axes = Vec3::new(1.0, 1.0, 1.0);
            let stretch = StabilizedStretch {
                error: ErrorStretch::of_turn([error, -error], [turned, turned * dt], axes, dt),
                axes,
                turned,
                measured: BodyRates(turned),
            };
            state = law.after(&state, &level(), &stretch);
            prop_assert!(state.attitude.is_finite());
            let error = AttitudeError { angle: error, axes };
            let wanted = law.wanted(&error, &state, &level());
            prop_assert!(wanted.0.max_norm() <= GAINS.attitude.maximum_rate_rad_s[0]);
            let input = RateInput {
                wanted,
                measured: BodyRates(turned),
                acceleration: error.angle,
            };
            let demand = law.demand(&state, &input);
            prop_assert!(demand.is_finite() && demand.0.max_norm() <= GAINS.rate.output_limit);
        }
    }
}
