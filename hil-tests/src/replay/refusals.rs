//! Refusals that only the flight itself can show, before anything is built or run.

use std::path::Path;

use anyhow::{Result, bail};
use reflex::config::SHORTEST_WARM_UP;
use reflex::settings::{Policy, WarmUp};

use super::options::ReplayOptions;
use crate::flight_log::FlightLog;
use crate::output_file::OutputFile;
use crate::refusal::Refusal;
use recorded_flights::Flight;

/// The longest gap, in s, that is bridged: beyond it there are two flights, or a broken stamp.
const LONGEST_GAP_S: f64 = 30.0;

/// The shortest flight, in s, that periodic control is judged by.
const SHORTEST_S: f64 = 0.1;

/// The largest tilt at the start, in degrees, at which the firmware arms.
const LARGEST_TILT: f64 = 60.0;

/// Refuses a flight that cannot be replayed with these options.
pub(crate) fn check(options: &ReplayOptions, flight: &Flight, path: &Path) -> Result<()> {
    check_flight(options, flight, &path.display().to_string())?;
    if let Some(defmt) = &options.defmt {
        let defmt = OutputFile::new("defmt", defmt);
        defmt.check_is_not(path)?;
        defmt.check_is_no_pipe()?;
    }
    if let Some(record) = &options.record {
        FlightLog::check_is_not(record, path)?;
    }
    Ok(())
}

/// As [`check`], where the flight is all there is; `name` is what the refusal calls it.
pub(crate) fn check_flight(options: &ReplayOptions, flight: &Flight, name: &str) -> Result<()> {
    let reason = too_short(options, flight)
        .or_else(|| gap(flight))
        .or_else(|| tilted(flight));
    match reason {
        Some(reason) => bail!(Refusal::new(format!("{name}: {reason}"))),
        None => Ok(()),
    }
}

fn too_short(options: &ReplayOptions, flight: &Flight) -> Option<String> {
    let length = options
        .duration_s
        .unwrap_or(f64::INFINITY)
        .min(flight.duration_s());
    let (needed, what) = match (options.settings.policy, options.settings.warm_up) {
        (Policy::Periodic, _) => (SHORTEST_S, "periodic control is judged by"),
        (_, WarmUp::Fixed(warm_up)) => (warm_up.ticks() as f64 / 1e6, "the fixed warm-up takes"),
        (_, WarmUp::Automatic) => {
            let shortest = SHORTEST_WARM_UP.ticks() as f64 / 1e6;
            (shortest, "the automatic warm-up takes at least")
        }
    };
    (length <= needed).then(|| format!("{length:.3} s of flight, but {what} {needed} s"))
}

fn gap(flight: &Flight) -> Option<String> {
    let gap = flight
        .gaps
        .iter()
        .find(|gap| gap.length_s > LONGEST_GAP_S)?;
    Some(format!(
        "a gap of {:.1} s at {:.1} s, at most {LONGEST_GAP_S} s can be bridged: cut the log there",
        gap.length_s, gap.at_s
    ))
}

/// The firmware would refuse to arm.
fn tilted(flight: &Flight) -> Option<String> {
    let [x, y, z] = flight.specific_force_at_rest();
    let tilt = (-z).atan2(x.hypot(y)).to_degrees();
    let tilt = 90.0 - tilt;
    (tilt > LARGEST_TILT).then(|| {
        format!(
            "begins {tilt:.0} degrees tilted, and the firmware arms up to {LARGEST_TILT}: \
             is --rotate right?"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use recorded_flights::{Rotate, Rotation};
    use std::fmt::Write;

    /// A still flight of `seconds` at 100 Hz whose specific force is `force`.
    fn flight(seconds: u64, force: [f64; 3], hole_s: u64) -> Flight {
        let mut text = String::from("t_us,gx,gy,gz,ax,ay,az\n");
        let [x, y, z] = force;
        for step in 0..seconds * 100 {
            let hole = if step > 50 { hole_s * 1_000_000 } else { 0 };
            writeln!(text, "{},0,0,0,{x},{y},{z}", step * 10_000 + hole).unwrap();
        }
        Flight::of_bytes(
            "still.csv".into(),
            text.as_bytes(),
            Rotate::Named(Rotation::NONE),
        )
        .unwrap_or_else(|fault| panic!("{fault:?}"))
    }

    fn refusal(options: &ReplayOptions, flight: &Flight) -> Option<String> {
        let path = Path::new("still.csv");
        check(options, flight, path)
            .err()
            .map(|error| error.to_string())
    }

    const LEVEL: [f64; 3] = [0.0, 0.0, -9.8];

    #[test]
    fn a_flight_that_ends_before_the_warm_up_is_refused() {
        let options = ReplayOptions::default();
        assert_eq!(refusal(&options, &flight(5, LEVEL, 0)), None);
        let line = refusal(&options, &flight(2, LEVEL, 0)).unwrap();
        assert!(
            line.starts_with("still.csv: 1.990 s of flight, but"),
            "{line}"
        );
    }

    #[test]
    fn a_flight_that_begins_upside_down_names_its_tilt() {
        let line = refusal(&ReplayOptions::default(), &flight(5, [0.0, 0.0, 9.8], 0)).unwrap();
        assert!(line.contains("begins 180 degrees tilted"), "{line}");
    }

    #[test]
    fn a_hole_of_an_hour_is_named_with_its_place() {
        let line = refusal(&ReplayOptions::default(), &flight(5, LEVEL, 3600)).unwrap();
        assert!(line.contains("a gap of 3600.0 s at 0.5 s"), "{line}");
    }
}
