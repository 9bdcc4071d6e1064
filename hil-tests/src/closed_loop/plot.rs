//! A flight drawn: its way, its errors, the wind, and how often control ran.

use super::{Flown, track::Moment};
use crate::plot::{Axis, Curve, Figure, Look, Marker, Panel, Point, Scale};

type Colour = (u8, u8, u8);
const BLUE: Colour = (0, 90, 160);
const ORANGE: Colour = (213, 94, 0);
const GREEN: Colour = (0, 145, 105);
const GREY: Colour = (150, 150, 150);

/// The figure of one flight.
#[must_use]
pub fn figure(flown: &Flown) -> Figure {
    let report = &flown.report;
    let track = &flown.track;
    let off = |name, colour, axis: usize| {
        let points = track
            .iter()
            .filter_map(|moment| Some((moment.at_s, moment.off_deg[axis]?)));
        curve(name, colour, points)
    };
    let rates = report.control.per_second.iter().enumerate();
    let rates = rates.map(|(second, runs)| (second as f64 + 0.5, f64::from(*runs)));
    let over_time = |name, colour, value: fn(&Moment) -> f64| {
        let points = track.iter().map(|moment| (moment.at_s, value(moment)));
        curve(name, colour, points)
    };
    let attitude = vec![
        off("roll", BLUE, 0),
        off("pitch", ORANGE, 1),
        off("yaw", GREEN, 2),
    ];
    let height = vec![
        over_time("flown", BLUE, |moment| -moment.position.z),
        over_time("asked for", GREY, |moment| -moment.target.z),
    ];
    let miss = |moment: &Moment| (moment.target - moment.position).norm();
    let miss = vec![over_time("distance", BLUE, miss)];
    let wind = vec![over_time("wind", GREY, |moment| moment.wind_m_s)];
    let runs = vec![curve("runs", BLUE, rates)];
    Figure {
        title: format!(
            "{} in {} with {}, {}, seed {}",
            report.airframe, report.environment, report.logic, report.policy, report.seed
        ),
        panels: vec![
            way_from_above(track),
            panel("height", "m", height),
            panel("desired less actual attitude", "degrees", attitude),
            panel("distance from where it should be", "m", miss),
            panel("control", "runs per second", runs),
            panel("wind", "m/s", wind),
        ],
        columns: 2,
    }
}

/// The way flown and the way asked for, with start and end.
fn way_from_above(track: &[Moment]) -> Panel {
    let flown = |moment: &Moment| (moment.position.y, moment.position.x);
    let asked = |moment: &Moment| (moment.target.y, moment.target.x);
    let mark = |name: &str, marker, moment: Option<&Moment>| {
        let mut mark = curve(name, BLUE, moment.map(flown).into_iter());
        mark.look.marker = marker;
        mark
    };
    Panel {
        title: "way from above".to_owned(),
        x: Axis::new("east, m", Scale::Map),
        y: Axis::new("north, m", Scale::Map),
        curves: vec![
            mark("start", Marker::Circle, track.first()),
            mark("end", Marker::Square, track.last()),
            curve("flown", BLUE, track.iter().map(flown)),
            curve("asked for", GREY, track.iter().map(asked)),
        ],
    }
}

/// A panel over the time of the flight.
fn panel(title: &str, unit: &str, curves: Vec<Curve>) -> Panel {
    Panel {
        title: title.to_owned(),
        x: Axis::new("s from take-off", Scale::Linear),
        y: Axis::new(unit, Scale::Linear),
        curves,
    }
}

fn curve(name: &str, colour: Colour, points: impl Iterator<Item = (f64, f64)>) -> Curve {
    let point = |(x, y)| Point {
        x,
        y,
        ..Point::default()
    };
    Curve {
        look: Look {
            name: name.to_owned(),
            colour,
            marker: Marker::None,
            width: 1,
        },
        points: points.map(point).collect(),
    }
}
