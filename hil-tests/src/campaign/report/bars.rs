//! Panels of bars: environments side by side, a bar for each airframe.

use crate::campaign::plan::Plan;
use crate::interval::Interval;
use crate::plot::{Axis, Curve, Look, Marker, Panel, Point, Scale};

/// Colours of environments where airframes are in the same figure.
pub const OTHERS: [(u8, u8, u8); 3] = [(130, 80, 170), (213, 94, 0), (60, 60, 60)];
/// Colours of airframes, and of curves of one kind alone.
pub const COLOURS: [(u8, u8, u8); 4] =
    [(0, 90, 160), (230, 159, 0), (0, 145, 105), (170, 170, 170)];
/// Where the paper's numbers are drawn.
const PAPER: (u8, u8, u8) = (204, 60, 120);
/// Width of all bars of a place, as a share of the way to the next.
const TOGETHER: f64 = 0.75;
/// The same in the figure's units, of a whole panel.
const PANEL: f64 = 440.0;

/// The value of the bar of an environment and an airframe.
pub type Value<'v> = &'v dyn Fn(&str, &str) -> Option<Interval>;

/// A panel; `range` is what the paper found, drawn as two lines.
pub fn panel(
    plan: &Plan,
    (title, y): (&str, &str),
    value: Value<'_>,
    range: Option<[f64; 2]>,
) -> Panel {
    let (places, each) = (plan.environments.len(), plan.airframes.len());
    let step = TOGETHER / each as f64;
    let bars = plan
        .airframes
        .iter()
        .enumerate()
        .map(|(kind, airframe)| Curve {
            look: Look {
                name: airframe.clone(),
                colour: COLOURS[kind % COLOURS.len()],
                marker: Marker::Bar,
                width: (PANEL / places as f64 * step * 0.9) as u32,
            },
            points: (0u32..)
                .zip(&plan.environments)
                .filter_map(|(place, environment)| {
                    let offset = (kind as f64 + 0.5) * step - TOGETHER / 2.0;
                    Some(point(
                        f64::from(place) + offset,
                        &value(environment, airframe)?,
                    ))
                })
                .collect(),
        });
    let mut curves: Vec<Curve> = bars.collect();
    curves.extend(range.into_iter().flatten().map(|y| line(y, places)));
    Panel {
        title: title.to_owned(),
        x: Axis::of_names("environment", plan.environments.clone()),
        y: Axis::new(y, Scale::Linear),
        curves,
    }
}

/// A mean with its interval.
pub fn point(x: f64, interval: &Interval) -> Point {
    Point {
        x,
        y: interval.mean,
        label: None,
        interval: interval.half_width.map(|_| interval.ends()),
    }
}

fn line(y: f64, places: usize) -> Curve {
    let end = |x| Point {
        x,
        y,
        ..Point::default()
    };
    Curve {
        look: Look {
            name: "paper: lowest and highest".into(),
            colour: PAPER,
            marker: Marker::None,
            width: 2,
        },
        points: vec![end(-0.5), end(places as f64 - 0.5)],
    }
}
