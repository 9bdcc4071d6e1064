//! One panel: axes fitted to its curves, the curves, their labels.

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::cartesian::Cartesian2d;
use plotters::element::PathElement;
use plotters::prelude::{RGBColor, SVGBackend, Text};
use plotters::style::{Color, TRANSPARENT};

use super::axis::{Axis, Fitted, Scale};
use super::curve::{Curve, Look, Marker, Point};
use super::{Area, Drawn, INK, LINE_HEIGHT, Pixel, bold, draw_legend, looks_of, plain, text};

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
/// Height of a panel's title, with the room around it.
const CAPTION: u32 = 24;
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
    ///
    /// Where it has a legend of its own, that stands below it.
    pub(super) fn draw(&self, root: &Area<'_>, area: &Area<'_>, has_legend: bool) -> Drawn {
        let looks = looks_of(self.curves.iter());
        // A single curve is what the title says.
        if has_legend && looks.len() > 1 {
            let (chart, legend) = area.split_vertically(area.dim_in_pixel().1 - LINE_HEIGHT);
            draw_legend(&legend, &looks)?;
            return self.draw_chart(root, &chart);
        }
        self.draw_chart(root, area)
    }

    fn draw_chart(&self, root: &Area<'_>, area: &Area<'_>) -> Drawn {
        let title = cut(&plain(&self.title));
        let x = self.x.fit(self.shown().map(|point| point.x));
        let fitted = x.filter(|_| self.shown().next().is_some());
        let fitted = fitted.zip(self.y.fit(self.heights()));
        let Some((x, y)) = fitted else {
            let left = MARGIN as i32;
            area.draw(&Text::new(title, (left, left), bold(17)))?;
            area.draw(&Text::new("nothing to show", (left, 4 * left), text(15)))?;
            return Ok(());
        };
        let (x, y) = match [self.x.scale, self.y.scale] {
            [Scale::Map, Scale::Map] => Fitted::as_map(x, y, on_paper(area)),
            _ => (x, y),
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

    /// The heights that the y axis is to show: points, ends of intervals, the foot of bars.
    fn heights(&self) -> impl Iterator<Item = f64> {
        let bars = self
            .curves
            .iter()
            .any(|curve| curve.look.marker == Marker::Bar);
        let of_point = |point: &Point| {
            let [low, high] = point.interval.unwrap_or([point.y; 2]);
            [low, point.y, high]
        };
        self.shown().flat_map(of_point).chain(bars.then_some(0.0))
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
            for (pixel, point) in &placed {
                self.draw_point(root, chart, (&curve.look, *pixel, point))?;
            }
            labels.extend(labelled(&placed));
        }
        self.draw_zero(root, chart)?;
        for ((x, y), label) in with_room(labels) {
            let at = (x + LABEL_OFFSET.0, y + LABEL_OFFSET.1);
            root.draw(&Text::new(plain(label), at, text(LABEL)))?;
        }
        Ok(())
    }

    fn draw_point(
        &self,
        root: &Area<'_>,
        chart: &Chart<'_, '_>,
        (look, pixel, point): (&Look, Pixel, &Point),
    ) -> Drawn {
        let height = |y: f64| {
            let place = self.x.place(point.x).zip(self.y.place(y))?;
            Some(chart.backend_coord(&place).1)
        };
        match height(0.0).filter(|_| look.marker == Marker::Bar) {
            Some(zero) => look.draw_bar(root, pixel, zero)?,
            None => look.draw_marker(root, pixel)?,
        }
        let ends = point
            .interval
            .and_then(|[low, high]| height(low).zip(height(high)));
        match ends {
            Some((low, high)) => look.draw_interval(root, pixel.0, [low, high]),
            None => Ok(()),
        }
    }

    /// The line that bars stand on.
    fn draw_zero(&self, root: &Area<'_>, chart: &Chart<'_, '_>) -> Drawn {
        if !self
            .curves
            .iter()
            .any(|curve| curve.look.marker == Marker::Bar)
        {
            return Ok(());
        }
        let (left, right) = (chart.x_range().start, chart.x_range().end);
        let ends = [left, right].map(|x| chart.backend_coord(&(x, 0.0)));
        root.draw(&PathElement::new(ends.to_vec(), INK.stroke_width(1)))?;
        Ok(())
    }
}

/// Width and height of the axes in an area.
fn on_paper(area: &Area<'_>) -> (f64, f64) {
    let (width, height) = area.dim_in_pixel();
    let around = (SIDES.0 + 2 * MARGIN, SIDES.1 + 2 * MARGIN + CAPTION);
    (
        f64::from(width.saturating_sub(around.0)),
        f64::from(height.saturating_sub(around.1)),
    )
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
