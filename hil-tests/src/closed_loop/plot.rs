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
    let way = |name, colour, place: fn(&Moment) -> (f64, f64)| {
        curve(name, colour, track.iter().map(place))
    };
    let miss = |moment: &Moment| (moment.at_s, (moment.target - moment.position).norm());
    let wind = |moment: &Moment| (moment.at_s, moment.wind_m_s);
    let time = "s from take-off";
    Figure {
        title: format!(
            "{} in {} with {}, {}, seed {}",
            report.airframe, report.environment, report.logic, report.policy, report.seed
        ),
        panels: vec![
            panel(
                "way from above",
                ("east, m", "north, m"),
                vec![
                    way("flown", BLUE, |moment| {
                        (moment.position.y, moment.position.x)
                    }),
                    way("asked for", GREY, |moment| {
                        (moment.target.y, moment.target.x)
                    }),
                ],
            ),
            panel(
                "desired less actual attitude",
                (time, "degrees"),
                vec![
                    off("roll", BLUE, 0),
                    off("pitch", ORANGE, 1),
                    off("yaw", GREEN, 2),
                ],
            ),
            panel(
                "control",
                (time, "runs per second"),
                vec![curve("runs", BLUE, rates)],
            ),
            panel(
                "distance from where it should be, and wind",
                (time, "m and m/s"),
                vec![
                    curve("distance", BLUE, track.iter().map(miss)),
                    curve("wind", GREY, track.iter().map(wind)),
                ],
            ),
        ],
        columns: 2,
    }
}

fn panel(title: &str, (x, y): (&str, &str), curves: Vec<Curve>) -> Panel {
    Panel {
        title: title.to_owned(),
        x: Axis::new(x, Scale::Linear),
        y: Axis::new(y, Scale::Linear),
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
