//! What the sensors feel of a flight.

use super::samples::{flight, hover};
use chip_models::stimulus::{STANDARD_GRAVITY, StimulusSource};
use recorded_flights::{FlightStimulus, Standstill};

const STANDSTILL_NS: u64 = 1_500_000_000;

#[test]
fn before_the_flight_the_drone_rests_in_its_first_attitude() {
    let tilted = flight(2.0, |_| ([1.0, 2.0, 3.0], [0.0, 3.0, -4.0]));
    let sensed = FlightStimulus::new(&tilted, Standstill::default()).at(STANDSTILL_NS - 60_000_000);
    assert_eq!(sensed.gyro, [0.0; 3]);
    let [x, y, z] = sensed.specific_force;
    assert_eq!(x, 0.0);
    assert!((y - 0.6 * STANDARD_GRAVITY).abs() < 1e-9);
    assert!((z + 0.8 * STANDARD_GRAVITY).abs() < 1e-9);
}

#[test]
fn the_flight_is_met_exactly_at_its_samples() {
    let swinging = flight(2.0, |t| ([t.sin(), t, -t], [t, 0.0, -9.8 + t]));
    let source = FlightStimulus::new(&swinging, Standstill::default());
    for (time, value) in swinging.gyro.iter() {
        assert_eq!(source.at(STANDSTILL_NS + time as u64).gyro, value);
    }
    for (time, value) in swinging.accel.iter() {
        assert_eq!(source.at(STANDSTILL_NS + time as u64).specific_force, value);
    }
}

#[test]
fn the_last_moments_at_rest_lead_to_the_flight() {
    let moving = flight(2.0, |_| ([1.0, 0.0, 0.0], [0.0, 0.0, -9.8]));
    let source = FlightStimulus::new(&moving, Standstill::default());
    assert_eq!(source.at(STANDSTILL_NS - 50_000_000).gyro[0], 0.0);
    assert_eq!(source.at(STANDSTILL_NS - 25_000_000).gyro[0], 0.5);
    assert_eq!(source.at(STANDSTILL_NS).gyro[0], 1.0);
}

#[test]
fn after_the_flight_the_last_sample_is_held() {
    let moving = flight(2.0, |t| ([t, 0.0, 0.0], [0.0, 0.0, -9.8]));
    let source = FlightStimulus::new(&moving, Standstill::default());
    assert_eq!(source.at(u64::MAX).gyro, [2.0, 0.0, 0.0]);
}

#[test]
fn a_missing_magnetometer_feels_a_constant_field() {
    let source = FlightStimulus::new(&hover(), Standstill::default());
    assert_eq!(
        source.at(0).magnetic_field,
        source.at(u64::MAX).magnetic_field
    );
    assert!(hover().mag.is_none());
}

#[test]
fn the_order_of_questions_changes_no_answer() {
    let moving = flight(2.0, |t| ([t.cos(), 0.0, 0.0], [0.0, t, -9.8]));
    let (rising, jumping) = (
        FlightStimulus::new(&moving, Standstill::default()),
        FlightStimulus::new(&moving, Standstill::default()),
    );
    let steps = 3000;
    for step in 0..steps {
        let at = |step: u64| step * 1_234_567;
        let far = step * 1777 % steps;
        let _ = jumping.at(at(far));
        assert_eq!(rising.at(at(step)), jumping.at(at(step)));
    }
}

#[test]
fn a_standstill_too_short_to_boot_is_lengthened() {
    assert_eq!(Standstill::new(0).length_ns(), Standstill::SHORTEST_NS);
    assert_eq!(Standstill::default().log_time_ns(STANDSTILL_NS + 7), 7);
    assert_eq!(Standstill::default().log_time_ns(0), -1_500_000_000);
}
