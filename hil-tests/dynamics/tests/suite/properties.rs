//! What holds for all throttles, winds and steps.

use flight_dynamics::{Divergence, Drone, Environment, Start, State};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

use crate::vehicles;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_flight_stays_finite_or_says_why_it_does_not(
        commands in prop::collection::vec((prop::array::uniform4(0.0..=1.0), 50e-6..1e-3), 1..400),
        wind in prop::array::uniform3(-15.0..15.0),
        angles in prop::array::uniform3(-3.0..3.0),
        height in 0.0..5.0,
    ) {
        let mut state = State::at_height(height);
        state.attitude = UnitQuaternion::from_euler_angles(angles[0], angles[1], angles[2]);
        let environment = Environment::calm();
        let mut drone = Drone::in_state(&vehicles::quad(), state, &environment).unwrap();
        for (throttles, dt) in commands {
            if drone.advance(dt, &throttles, Vector3::from(wind)).is_err() {
                break;
            }
            let readings = drone.readings();
            let numbers = readings.rates.iter().chain(&readings.specific_force);
            prop_assert!(numbers.chain(&readings.magnetic_field).all(|x| x.is_finite()));
            let norm = drone.state().attitude.quaternion().norm();
            prop_assert!((norm - 1.0).abs() < 1e-12);
            prop_assert!(drone.state().position.z < 0.5, "fell through the ground");
            prop_assert!((0.0..=1.0).contains(&drone.state().state_of_charge));
            prop_assert!(drone.state().rotor_speeds.iter().all(|speed| *speed >= 0.0));
        }
    }

    #[test]
    fn energy_used_never_falls_and_time_is_the_sum_of_steps(
        commands in prop::collection::vec((0.0..=1.0, 50_000_u32..1_000_000), 1..100),
    ) {
        let vehicle = vehicles::quad();
        let mut drone =
            Drone::new(&vehicle, Start::default(), &Environment::calm()).unwrap();
        let (mut energy, mut time) = (0.0, 0);
        for (throttle, ns) in commands {
            drone.advance(f64::from(ns) * 1e-9, &[throttle; 4], Vector3::zeros()).unwrap();
            time += u64::from(ns);
            prop_assert!(drone.state().energy_used > energy);
            prop_assert_eq!(drone.state().time_ns, time);
            energy = drone.state().energy_used;
        }
    }

    #[test]
    fn a_throttle_that_is_no_share_is_refused_and_changes_nothing(
        motor in 0_usize..4,
        share in prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(-0.01), 1.001..1e9],
    ) {
        let vehicle = vehicles::quad();
        let mut drone =
            Drone::new(&vehicle, Start::default(), &Environment::calm()).unwrap();
        let before = *drone.state();
        let mut throttles = [0.5; 4];
        throttles[motor] = share;
        let diverged = drone.advance(1e-3, &throttles, Vector3::zeros()).unwrap_err();
        let named = matches!(diverged.what, Divergence::Throttle { motor: at, .. } if at == motor);
        prop_assert!(named);
        prop_assert_eq!(*drone.state(), before);
        prop_assert_eq!(*diverged.state, before);
    }
}

#[test]
fn what_is_not_finite_is_refused_with_time_and_reason() {
    let vehicle = vehicles::quad();
    let mut drone = Drone::new(&vehicle, Start::default(), &Environment::calm()).unwrap();
    let still = Vector3::zeros();
    drone.advance(0.05, &[0.0; 4], still).unwrap();
    for dt in [f64::NAN, 0.0, -1e-3, 0.11] {
        let refused = drone.advance(dt, &[0.0; 4], still).unwrap_err();
        assert!(matches!(refused.what, Divergence::Step(_)));
    }
    let storm = Vector3::new(f64::NAN, 0.0, 0.0);
    let refused = drone.advance(1e-3, &[0.0; 4], storm).unwrap_err();
    assert!(matches!(refused.what, Divergence::Wind(_)));
    let refused = drone.advance(1e-3, &[0.0; 3], still).unwrap_err();
    let text = refused.to_string();
    let start = "flight dynamics diverged after 0.0500 s: 3 throttles given for 4 motors; before";
    assert!(text.starts_with(start), "{text}");
}

#[test]
fn a_vehicle_out_of_range_is_refused_with_the_name_of_the_parameter() {
    let mut vehicle = vehicles::quad();
    vehicle.propulsion.lag_up = f64::NAN;
    let refusal = Drone::new(&vehicle, Start::default(), &Environment::calm()).unwrap_err();
    assert_eq!(
        refusal.to_string(),
        "lag_up is NaN; it must be from 0.002 to 2"
    );
}
