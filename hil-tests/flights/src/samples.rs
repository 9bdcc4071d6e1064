//! The samples of a sensor as a log gives them: admitted, or skipped and counted.
//!
//! A few samples that no sensor gives are spoilt, and skipped. Where they are
//! many, the unit is wrong, or all of the log, and it is refused.

use super::error::{Fault, Location};
use super::recording::Sensor;
use super::skipped::Skipped;
use super::track::{SECOND_NS, Track};

/// One sample in this many may be impossible.
const MOST_SPOILT: u64 = 100;
/// So many may be in any log.
const ALWAYS_ALLOWED: u64 = 5;
/// A stamp that leads by more is doubted, and dropped where those that follow go back.
const LEAP_NS: i64 = SECOND_NS / 10;

/// The samples of one sensor.
#[derive(Debug)]
pub(super) struct Samples {
    sensor: Sensor,
    /// Whose they are, in what is said of them.
    name: String,
    track: Track<3>,
    spoilt: u64,
    first_spoilt: Option<Fault>,
    /// Where the last sample was, and the time before it.
    last: Option<(Location, Option<i64>)>,
}

impl Samples {
    /// Of a sensor that the log calls so.
    pub(super) fn new(sensor: Sensor, name: &str) -> Self {
        Self {
            sensor,
            name: name.to_owned(),
            track: Track::new(),
            spoilt: 0,
            first_spoilt: None,
            last: None,
        }
    }

    /// Takes a sample in, or counts it; one that repeats the last stamp is a repetition.
    pub(super) fn take(
        &mut self,
        place: Location,
        time_ns: i64,
        value: [f64; 3],
        skipped: &mut Skipped,
    ) {
        if let Some(reason) = value.iter().find_map(|v| self.sensor.check(*v).err()) {
            self.spoilt += 1;
            let kind = format!("{}: {} that no sensor gives", self.name, self.sensor.noun());
            skipped.add(place.clone(), &kind);
            let reason = format!("{}: {reason}", self.name);
            self.first_spoilt.get_or_insert(Fault::new(place, reason));
            return;
        }
        if let Some(newest) = self.track.last_time_ns()
            && time_ns < newest
        {
            let Some(at) = self.leapt(time_ns, newest) else {
                skipped.add(place, &format!("{}: a time that goes back", self.name));
                return;
            };
            skipped.add(at, &format!("{}: a time that leaps ahead", self.name));
            self.track.pop();
        }
        self.last = Some((place, self.track.last_time_ns()));
        self.track.push(time_ns, value);
    }

    /// Where the newest sample is, if its stamp is at fault and not the one that follows it.
    fn leapt(&self, time_ns: i64, newest: i64) -> Option<Location> {
        let (place, before) = self.last.as_ref()?;
        let fits = before.is_none_or(|before| before <= time_ns && newest - before > LEAP_NS);
        fits.then(|| place.clone())
    }

    /// The samples.
    ///
    /// # Errors
    /// The first impossible one, where there are too many.
    pub(super) fn finish(self) -> Result<Track<3>, Fault> {
        let all = self.track.len() as u64 + self.spoilt;
        match self.first_spoilt {
            Some(fault) if self.spoilt > ALWAYS_ALLOWED.max(all / MOST_SPOILT) => Err(fault),
            _ => Ok(self.track),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn take(times_ms: &[i64]) -> (Vec<i64>, u64) {
        let (mut samples, mut skipped) = (
            Samples::new(Sensor::Gyroscope, "gyroscope"),
            Skipped::default(),
        );
        for time in times_ms {
            samples.take(Location::File, time * 1_000_000, [0.1; 3], &mut skipped);
        }
        let track = samples.finish().expect("possible values");
        let times = track.times_ns().iter().map(|time| time / 1_000_000);
        (times.collect(), skipped.count())
    }

    #[test]
    fn a_single_wrong_stamp_costs_one_sample() {
        assert_eq!(
            take(&[0, 4, 8, 900_000, 12, 16]),
            (vec![0, 4, 8, 12, 16], 1)
        );
        assert_eq!(take(&[0, 4, 8, 2, 12, 16]), (vec![0, 4, 8, 12, 16], 1));
        assert_eq!(take(&[900_000, 4, 8]), (vec![4, 8], 1));
        assert_eq!(take(&[0, 4, 4, 8]), (vec![0, 4, 8], 0));
    }

    #[test]
    fn many_impossible_values_refuse_the_log() {
        let (mut samples, mut skipped) = (
            Samples::new(Sensor::Gyroscope, "gyroscope"),
            Skipped::default(),
        );
        for line in 0..1000 {
            let value = if line % 20 == 3 { 400.0 } else { 1.0 };
            samples.take(Location::Line(line), line as i64, [value; 3], &mut skipped);
        }
        let fault = samples.finish().expect_err("one in twenty");
        assert_eq!(fault.location, Location::Line(3));
        assert_eq!(skipped.count(), 50);
    }
}
