//! Setpoints: recorded ones where they were flown, the flight's own otherwise.

use super::samples::{csv, flight, hover, named};
use super::ulog_bytes::{Ulog, level_flight};
use recorded_flights::{Flight, Rotate, SetpointSource, Setpoints};

/// A level flight whose log has setpoints with a thrust (pointing up).
pub(super) fn with_setpoints(thrust: f32) -> Flight {
    let mut log = Ulog::new();
    level_flight(&mut log);
    log.topic("vehicle_attitude", "uint64_t timestamp;float[4] q;");
    log.topic(
        "vehicle_attitude_setpoint",
        "uint64_t timestamp;float[4] q_d;float[3] thrust_body;",
    );
    log.topic(
        "vehicle_rates_setpoint",
        "uint64_t timestamp;float roll;float pitch;float yaw;",
    );
    // Headed east; asked to roll by 0.2 rad.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let (sin, cos) = 0.1_f32.sin_cos();
    for time in [1_000_000, 2_000_000, 3_000_000] {
        log.floats("vehicle_attitude", time, &[half, 0.0, 0.0, half]);
        let q = [half * cos, half * sin, half * sin, half * cos];
        log.floats(
            "vehicle_attitude_setpoint",
            time,
            &[&q[..], &[0.0, 0.0, -thrust]].concat(),
        );
        log.floats("vehicle_rates_setpoint", time, &[0.1, 0.2, 0.3]);
    }
    Flight::of_bytes("log".to_owned(), &log.bytes, Rotate::Auto).expect("a good log")
}

#[test]
fn recorded_setpoints_are_taken_and_count_from_the_first_heading() {
    let setpoints = Setpoints::of(&with_setpoints(0.6));
    assert_eq!(setpoints.sources.attitude, SetpointSource::Recorded);
    assert_eq!(setpoints.sources.rates, SetpointSource::Recorded);
    assert_eq!(setpoints.sources.thrust, SetpointSource::Recorded);
    let asked = setpoints.at(500_000_000);
    let (sin, cos) = 0.1_f64.sin_cos();
    for (component, expected) in asked.attitude.iter().zip([cos, sin, 0.0, 0.0]) {
        assert!((component - expected).abs() < 1e-6, "{:?}", asked.attitude);
    }
    assert!((asked.rates[2] - 0.3).abs() < 1e-6);
    assert!((asked.thrust - 0.6).abs() < 1e-6);
}

#[test]
fn setpoints_that_were_never_flown_are_not_taken() {
    let setpoints = Setpoints::of(&with_setpoints(0.0));
    assert_eq!(setpoints.sources.attitude, SetpointSource::Motion);
    assert_eq!(setpoints.sources.rates, SetpointSource::Motion);
    assert_eq!(setpoints.sources.thrust, SetpointSource::Constant);
    assert_eq!(setpoints.at(0).thrust, 0.5);
}

#[test]
fn a_log_without_attitude_counts_from_the_heading_at_its_start() {
    let turning = flight(3.0, |_| ([0.0, 0.0, 0.5], [0.0, 0.0, -9.806_65]));
    assert_eq!(Setpoints::of(&turning).heading_at_start(), 0.0);
    let east = Setpoints::of(&with_setpoints(0.6)).heading_at_start();
    assert!((east - std::f64::consts::FRAC_PI_2).abs() < 1e-6, "{east}");
}

#[test]
fn before_the_flight_no_rates_are_asked_for() {
    let setpoints = Setpoints::of(&with_setpoints(0.6));
    assert_eq!(setpoints.at(-1).rates, [0.0; 3]);
    assert_eq!(setpoints.at(-1).attitude, setpoints.at(0).attitude);
}

#[test]
fn without_an_attitude_in_the_log_it_is_computed() {
    let rolling = flight(6.0, |t| {
        let roll = 0.15 * (1.0 - (t * 0.6).cos());
        let rate = 0.09 * (t * 0.6).sin();
        let force = [0.0, -9.806_65 * roll.sin(), -9.806_65 * roll.cos()];
        ([rate, 0.0, 0.0], force)
    });
    let setpoints = Setpoints::of(&rolling);
    assert_eq!(setpoints.sources.attitude, SetpointSource::Computed);
    let asked = setpoints.at(3_000_000_000);
    let roll = 2.0 * asked.attitude[1].asin();
    assert!((roll - 0.15 * (1.0 - 1.8_f64.cos())).abs() < 0.02, "{roll}");
}

#[test]
fn the_mean_of_the_motors_is_the_thrust_without_vibration() {
    let text = csv("t_us,gx,gy,gz,ax,ay,az,m1,m2", 4.0, |t| {
        let ripple = 0.1 * (t * 300.0).sin();
        vec![0.0, 0.0, 0.0, 0.0, 0.0, -9.8, 0.4 + ripple, 0.6 + ripple]
    });
    let setpoints = Setpoints::of(&named(&text, Rotate::Auto).expect("a good log"));
    assert_eq!(setpoints.sources.thrust, SetpointSource::Motion);
    assert!((setpoints.at(2_000_000_000).thrust - 0.5).abs() < 0.005);
    assert_eq!(
        Setpoints::of(&hover()).sources.thrust,
        SetpointSource::Constant
    );
}

#[test]
fn a_flip_keeps_the_setpoint_a_unit_quaternion() {
    let flip = flight(4.0, |t| {
        let rate = if (1.0..2.0).contains(&t) { 20.0 } else { 0.0 };
        ([rate, 0.0, 0.0], [0.0, 0.0, -9.8])
    });
    let setpoints = Setpoints::of(&flip);
    for step in 0..400 {
        let q = setpoints.at(step * 10_000_000).attitude;
        let norm: f64 = q.iter().map(|c| c * c).sum();
        assert!((norm - 1.0).abs() < 1e-9);
    }
}
