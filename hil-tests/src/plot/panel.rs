//! One panel: axes fitted to its curves, the curves, their labels.

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::cartesian::Cartesian2d;
use plotters::prelude::{RGBColor, SVGBackend, Text};
use plotters::style::{Color, TRANSPARENT};

use super::axis::{Axis, Fitted};
use super::curve::{Curve, Point};
use super::{Area, Drawn, INK, Pixel, bold, plain, text};

/// Curves over a pair of axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// The line above it.
    pub title: String,
    /// The axis that runs to the right.
    pub x: Axis,
    /// The axis that runs upwards.
    pub y: Axis,
    /// Drawn from the last to the first, so that the first lies on top.
    pub curves: Vec<Curve>,
}

type Chart<'p, 'a> = ChartContext<'p, SVGBackend<'a>, Cartesian2d<Fitted, Fitted>>;

/// Lines of the grid.
const GRID: RGBColor = RGBColor(222, 222, 222);
/// Room for the axes' numbers and titles, beside and below.
const SIDES: (u32, u32) = (64, 52);
/// Margin around a panel.
const MARGIN: u32 = 10;
/// Size of labels, and of the box that no other label may enter.
const LABEL: i32 = 14;
const LABEL_BOX: Pixel = (26, 15);
/// From a point to the upper left corner of its label.
const LABEL_OFFSET: Pixel = (7, -17);
/// Longest title of a panel, in characters.
const LONGEST_TITLE: usize = 56;

impl Panel {
    /// Draws into `area`; `root` is the figure, whose units places are in.
    pub(super) fn draw(&self, root: &Area<'_>, area: &Area<'_>) -> Drawn {
        let fit = |axis: &Axis, of: fn(&Point) -> f64| axis.fit(self.shown().map(of));
        let title = cut(&plain(&self.title));
        let fitted = fit(&self.x, |point| point.x).zip(fit(&self.y, |point| point.y));
        let Some((x, y)) = fitted else {
            let left = MARGIN as i32;
            area.draw(&Text::new(title, (left, left), bold(17)))?;
            area.draw(&Text::new("nothing to show", (left, 4 * left), text(15)))?;
            return Ok(());
        };
        let mut chart = ChartBuilder::on(area)
            .caption(title, bold(17))
            .margin(MARGIN)
            .x_label_area_size(SIDES.1)
            .y_label_area_size(SIDES.0)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_desc(plain(&self.x.title))
            .y_desc(plain(&self.y.title))
            .label_style(text(14))
            .axis_desc_style(text(15))
            .axis_style(INK.stroke_width(1))
            .bold_line_style(GRID.stroke_width(1))
            .light_line_style(TRANSPARENT)
            .draw()?;
        self.draw_curves(root, &chart)
    }

    /// Points that both axes can show.
    fn shown(&self) -> impl Iterator<Item = &Point> {
        let points = self.curves.iter().flat_map(|curve| &curve.points);
        points.filter(|point| self.place(point).is_some())
    }

    fn place(&self, point: &Point) -> Option<(f64, f64)> {
        self.x.place(point.x).zip(self.y.place(point.y))
    }

    fn draw_curves(&self, root: &Area<'_>, chart: &Chart<'_, '_>) -> Drawn {
        let mut labels = Vec::new();
        for curve in self.curves.iter().rev() {
            let placed = curve.points.iter().filter_map(|point| {
                let place = self.place(point)?;
                Some((chart.backend_coord(&place), point))
            });
            let placed: Vec<(Pixel, &Point)> = placed.collect();
            let line = placed.iter().map(|(pixel, _)| *pixel).collect();
            curve.look.draw_line(root, line)?;
            for (pixel, _) in &placed {
                curve.look.draw_marker(root, *pixel)?;
            }
            labels.extend(labelled(&placed));
        }
        for ((x, y), label) in with_room(labels) {
            let at = (x + LABEL_OFFSET.0, y + LABEL_OFFSET.1);
            root.draw(&Text::new(plain(label), at, text(LABEL)))?;
        }
        Ok(())
    }
}

/// The labels of a curve, its ends first: they say most.
fn labelled<'p>(placed: &[(Pixel, &'p Point)]) -> Vec<(Pixel, &'p str)> {
    let label = |&(pixel, point): &(Pixel, &'p Point)| Some((pixel, point.label.as_deref()?));
    let mut labels: Vec<_> = placed.iter().filter_map(label).collect();
    if let Some(last) = labels.pop() {
        labels.insert(labels.len().min(1), last);
    }
    labels
}

/// Labels that do not cover those before them.
fn with_room(labels: Vec<(Pixel, &str)>) -> Vec<(Pixel, &str)> {
    let mut kept: Vec<(Pixel, &str)> = Vec::new();
    for (pixel, label) in labels {
        let is_free = kept.iter().all(|((x, y), _)| {
            (x - pixel.0).abs() >= LABEL_BOX.0 || (y - pixel.1).abs() >= LABEL_BOX.1
        });
        if is_free {
            kept.push((pixel, label));
        }
    }
    kept
}

fn cut(title: &str) -> String {
    if title.chars().count() <= LONGEST_TITLE {
        return title.to_owned();
    }
    let start: String = title.chars().take(LONGEST_TITLE - 3).collect();
    start + "..."
}
