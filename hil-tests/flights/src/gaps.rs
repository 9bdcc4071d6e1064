//! Holes in a log: found and reported, interpolated across like the rest.

use super::recording::Sensor;
use super::track::{Track, seconds};

/// A span without samples of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Gap {
    /// Whose samples are missing.
    pub sensor: Sensor,
    /// Time of the last sample before it, s of log time.
    pub at_s: f64,
    /// Time to the next sample, s.
    pub length_s: f64,
}

/// A gap is longer than this many median periods ...
const PERIODS: i64 = 5;
/// ... or, for gyroscope and accelerometer, than this.
const LONGEST_NS: i64 = 50_000_000;

/// The gaps of a log, in order of time.
///
/// An accelerometer that shares the gyroscope's time stamps shares its gaps:
/// those are reported once, as the gyroscope's. `mag` is given only where it
/// has time stamps of its own.
pub(super) fn find(gyro: &Track<3>, accel: &Track<3>, mag: Option<&Track<3>>) -> Vec<Gap> {
    let mut gaps = of(Sensor::Gyroscope, gyro, LONGEST_NS);
    if accel.times_ns() != gyro.times_ns() {
        gaps.extend(of(Sensor::Accelerometer, accel, LONGEST_NS));
    }
    if let Some(mag) = mag {
        gaps.extend(of(Sensor::Magnetometer, mag, i64::MAX));
    }
    gaps.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    gaps
}

/// The gaps of one sensor.
fn of(sensor: Sensor, track: &Track<3>, longest_ns: i64) -> Vec<Gap> {
    let Some(median) = track.median_period_ns() else {
        return Vec::new();
    };
    let limit = median.saturating_mul(PERIODS).min(longest_ns);
    track
        .times_ns()
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > limit)
        .map(|pair| Gap {
            sensor,
            at_s: seconds(pair[0]),
            length_s: seconds(pair[1] - pair[0]),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(times_ms: impl IntoIterator<Item = i64>) -> Track<3> {
        let mut track = Track::new();
        for time in times_ms {
            track.push(time * 1_000_000, [0.0; 3]);
        }
        track
    }

    #[test]
    fn a_hole_of_more_than_five_periods_is_a_gap() {
        let holed = track((0..100).chain(106..200));
        let gaps = find(&holed, &holed, None);
        assert_eq!(gaps.len(), 1);
        assert_eq!(gaps[0].sensor, Sensor::Gyroscope);
        assert!((gaps[0].at_s - 0.099).abs() < 1e-9);
        assert!((gaps[0].length_s - 0.007).abs() < 1e-9);
    }

    #[test]
    fn a_slow_log_has_a_gap_from_fifty_milliseconds_on() {
        let slow = track((0..50).map(|i| i * 20).chain([1050, 1070]));
        assert_eq!(find(&slow, &slow, None).len(), 1);
    }

    #[test]
    fn jitter_is_no_gap() {
        let jittered = track((0..100).map(|i| i * 4 + i % 3));
        assert_eq!(find(&jittered, &jittered, None), []);
    }

    #[test]
    fn each_sensor_with_its_own_stamps_reports_its_own_gaps() {
        let whole = track(0..200);
        let holed = track((0..100).chain(120..200));
        let slow = track((0..50).map(|i| i * 500));
        let gaps = find(&whole, &holed, Some(&slow));
        assert_eq!(gaps.len(), 1);
        assert_eq!(gaps[0].sensor, Sensor::Accelerometer);
    }
}
