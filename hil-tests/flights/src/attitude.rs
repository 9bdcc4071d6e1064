//! The attitude of a flight whose log has none.
//!
//! A complementary filter in double precision: the gyroscope turns the
//! attitude, the specific force pulls it level with a time constant of 5 s,
//! less the further its length is from 1 g. It starts from the attitude at
//! rest with yaw 0. A gyroscope bias `b` leaves a tilt error of about `5 s * b`.

use nalgebra::{UnitQuaternion, Vector3};

use super::flight::Flight;
use super::quaternion::to_array;
use super::track::{Track, seconds};
use chip_models::stimulus::STANDARD_GRAVITY;

const TIME_CONSTANT_S: f64 = 5.0;
/// Specific forces this far from 1 g, in g, say nothing about the vertical.
const TRUST_UP_TO: f64 = 0.5;

/// The attitude whose resting specific force is `force`, with yaw 0.
fn at_rest(force: [f64; 3]) -> UnitQuaternion<f64> {
    let [x, y, z] = force;
    let roll = (-y).atan2(-z);
    let pitch = x.atan2(y.hypot(z));
    UnitQuaternion::from_euler_angles(roll, pitch, 0.0)
}

/// The attitude at every gyroscope sample, computed from the sensors.
pub(super) fn estimate(flight: &Flight) -> Track<4> {
    let mut attitude = at_rest(flight.specific_force_at_rest());
    let mut track = Track::new();
    let mut last: Option<(i64, Vector3<f64>)> = None;
    let cursor = super::track::Cursor::default();
    for (time, rate) in flight.gyro.iter() {
        let rate = Vector3::from(rate);
        if let Some((last_time, last_rate)) = last {
            let dt = seconds(time - last_time);
            let force = flight.accel.at_cursor(time, &cursor).unwrap_or_default();
            let correction = toward_level(attitude, Vector3::from(force));
            let mean_rate = (rate + last_rate) / 2.0;
            attitude *= UnitQuaternion::from_scaled_axis((mean_rate + correction) * dt);
            attitude.renormalize();
        }
        last = Some((time, rate));
        track.push(time, to_array(attitude));
    }
    track
}

/// The rate (rad/s, body) that turns the attitude toward the measured vertical.
fn toward_level(attitude: UnitQuaternion<f64>, force: Vector3<f64>) -> Vector3<f64> {
    let length = force.norm() / STANDARD_GRAVITY;
    let trust = (1.0 - (length - 1.0).abs() / TRUST_UP_TO).max(0.0);
    let Some(measured) = force.try_normalize(1e-6) else {
        return Vector3::zeros();
    };
    let expected = attitude.inverse() * -Vector3::z();
    measured.cross(&expected) * (trust / TIME_CONSTANT_S)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quaternion::{from_array, heading};
    use crate::{Rotate, Rotation};

    /// A flight of gyroscope and accelerometer at 200 Hz, as functions of seconds.
    fn flight(length_s: f64, motion: impl Fn(f64) -> ([f64; 3], [f64; 3])) -> Flight {
        let rows = (0..=(length_s * 200.0) as u64).map(|sample| {
            let (gyro, accel) = motion(sample as f64 / 200.0);
            let values = [gyro, accel].concat().into_iter().map(|v| format!(",{v}"));
            format!("{}{}\n", sample * 5000, values.collect::<String>())
        });
        let text = "t_us,gx,gy,gz,ax,ay,az\n".to_owned() + &rows.collect::<String>();
        let unturned = Rotate::Named(Rotation::NONE);
        Flight::of_bytes("made-up".to_owned(), text.as_bytes(), unturned).expect("a good log")
    }

    #[test]
    fn the_attitude_at_rest_feels_the_force_it_was_made_from() {
        for force in [[1.0, 2.0, -9.0], [-3.0, 0.5, -8.0], [4.0, 4.0, 7.0]] {
            let sensed = at_rest(force).inverse() * Vector3::new(0.0, 0.0, -1.0);
            assert!((sensed - Vector3::from(force).normalize()).norm() < 1e-9);
        }
    }

    #[test]
    fn a_constant_turn_is_integrated() {
        let flight = flight(4.0, |_| ([0.0, 0.0, 0.25], [0.0, 0.0, -9.806_65]));
        let last = estimate(&flight).at(flight.duration_ns).map(from_array);
        let yaw = last.map(heading).unwrap_or_default();
        assert!((yaw - 0.25 * flight.duration_s()).abs() < 1e-9, "{yaw}");
    }

    #[test]
    fn a_wrong_tilt_is_pulled_level_with_the_time_constant() {
        // At rest after a start that felt 0.1 rad of roll.
        let flight = flight(10.0, |t| {
            let roll: f64 = if t < 0.6 { 0.1 } else { 0.0 };
            ([0.0; 3], [0.0, -9.8 * roll.sin(), -9.8 * roll.cos()])
        });
        let (roll, _, _) = estimate(&flight)
            .at(5_600_000_000)
            .map(from_array)
            .unwrap_or_default()
            .euler_angles();
        assert!((roll - 0.1 * (-1.0_f64).exp()).abs() < 0.002, "{roll}");
    }
}
