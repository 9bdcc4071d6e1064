//! Gusts and turbulence as a drone meets them.

use flight_dynamics::{Environment, Gusts, Wind};
use nalgebra::Vector3;

use crate::close;

#[test]
fn without_turbulence_and_gusts_the_wind_is_the_mean() {
    let mut environment = Environment::calm();
    environment.wind.mean = Vector3::new(4.0, -1.0, 0.2);
    let mut wind = Wind::new(&environment, 3).unwrap();
    for _ in 0..1000 {
        assert_eq!(wind.advance(0.0013), environment.wind.mean);
    }
}

#[test]
fn gusts_come_at_their_mean_interval_and_reach_their_amplitude() {
    let mut environment = Environment::calm();
    environment.wind.nominal_airspeed = 10.0;
    environment.wind.gusts = Some(Gusts {
        mean_interval: 4.0,
        amplitude: 3.0,
        length: 5.0,
    });
    let mut wind = Wind::new(&environment, 3).unwrap();
    let (mut gusts, mut most, mut was_calm) = (0, 0.0_f64, true);
    for _ in 0..1_000_000 {
        let speed = wind.advance(0.01).norm();
        most = most.max(speed);
        gusts += u32::from(was_calm && speed > 0.0);
        was_calm = speed == 0.0;
    }
    close(most, 3.0, 1e-3);
    // 10000 s; each gust takes 1 s after a wait of 4 s: 2000, give or take twice 36.
    close(f64::from(gusts), 2000.0, 75.0);
}

#[test]
fn turbulence_has_the_intensity_that_the_standard_states() {
    let mut environment = Environment::calm();
    environment.wind.speed_at_20_ft = 7.7;
    environment.wind.nominal_altitude = 6.096;
    environment.wind.nominal_airspeed = 7.7;
    let mut wind = Wind::new(&environment, 11).unwrap();
    let mut square = Vector3::zeros();
    let samples = 4_000_000;
    for _ in 0..samples {
        let air = wind.advance(0.01);
        square += air.component_mul(&air) / f64::from(samples);
    }
    let deviation = square.map(f64::sqrt);
    // 20 ft: vertical 0.1 * 7.7; along the ground over (0.177 + 0.01646)^0.4 = 0.5184.
    close(deviation.z, 0.77, 0.02);
    close(deviation.x, 1.485, 0.06);
    close(deviation.y, 1.485, 0.06);
}

#[test]
fn a_climate_out_of_range_is_refused_with_its_name() {
    let mut environment = Environment::calm();
    environment.wind.nominal_airspeed = 0.0;
    let refusal = Wind::new(&environment, 1).unwrap_err().to_string();
    assert_eq!(
        refusal,
        "wind nominal_airspeed is 0; it must be from 0.5 to 100"
    );
}
