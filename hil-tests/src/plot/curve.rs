//! Curves: what they go through, and how they look.

use plotters::element::{Circle, PathElement, Rectangle, TriangleMarker};
use plotters::prelude::RGBColor;
use plotters::style::Color;

use super::{Area, Drawn, INK, Pixel};

/// How a point is marked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// Not at all.
    None,
    /// A filled circle.
    Circle,
    /// A square's outline, wide enough to show around another marker.
    Square,
    /// A filled triangle.
    Triangle,
    /// A filled bar from zero, as wide as the look says.
    Bar,
}

/// How curves of one kind look; the legend has a line for each name.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// The name in the legend.
    pub name: String,
    /// Red, green and blue.
    pub colour: (u8, u8, u8),
    /// How points are marked.
    pub marker: Marker,
    /// Width of the line through the points, 0 for none; or of each bar.
    pub width: u32,
}

/// One point of a curve, in the units of the axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Along the x axis.
    pub x: f64,
    /// Along the y axis.
    pub y: f64,
    /// What is written beside it, where there is room.
    pub label: Option<String>,
    /// Lower and upper end of the interval around it, along the y axis.
    pub interval: Option<[f64; 2]>,
}

/// Points in the order in which the line goes through them.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// How it looks.
    pub look: Look,
    /// What it goes through.
    pub points: Vec<Point>,
}

/// Radius of a marker.
const RADIUS: i32 = 5;
/// Half of a square marker's side.
const SIDE: i32 = 7;
/// Half of the width of an interval's ends.
const END: i32 = 4;
/// Half of the height of a bar in the legend.
const SAMPLE: i32 = 6;

impl Look {
    /// The colour as the drawing library has it.
    fn rgb(&self) -> RGBColor {
        let (red, green, blue) = self.colour;
        RGBColor(red, green, blue)
    }

    /// A piece of line with a marker, as the legend shows it.
    pub(super) fn draw_sample(&self, area: &Area<'_>, (x, y): Pixel, length: i32) -> Drawn {
        if self.marker == Marker::Bar {
            return self.draw_box(area, [(x, y - SAMPLE), (x + length, y + SAMPLE)]);
        }
        self.draw_line(area, vec![(x, y), (x + length, y)])?;
        self.draw_marker(area, (x + length / 2, y))
    }

    /// The bar from the height of zero to a place.
    pub(super) fn draw_bar(&self, area: &Area<'_>, (x, y): Pixel, zero: i32) -> Drawn {
        let width = self.width as i32;
        let left = x - width / 2;
        self.draw_box(area, [(left, y.min(zero)), (left + width, y.max(zero))])
    }

    fn draw_box(&self, area: &Area<'_>, corners: [Pixel; 2]) -> Drawn {
        area.draw(&Rectangle::new(corners, self.rgb().filled()))?;
        Ok(())
    }

    /// The interval between two heights.
    pub(super) fn draw_interval(&self, area: &Area<'_>, x: i32, [low, high]: [i32; 2]) -> Drawn {
        // On a bar of its own colour nothing would be seen.
        let colour = match self.marker {
            Marker::Bar => INK,
            _ => self.rgb(),
        };
        for (from, to) in [
            ((x, low), (x, high)),
            ((x - END, low), (x + END, low)),
            ((x - END, high), (x + END, high)),
        ] {
            area.draw(&PathElement::new(vec![from, to], colour.stroke_width(1)))?;
        }
        Ok(())
    }

    /// The line through some places.
    pub(super) fn draw_line(&self, area: &Area<'_>, places: Vec<Pixel>) -> Drawn {
        if self.marker != Marker::Bar && self.width > 0 && places.len() > 1 {
            area.draw(&PathElement::new(
                places,
                self.rgb().stroke_width(self.width),
            ))?;
        }
        Ok(())
    }

    /// The marker at a place.
    pub(super) fn draw_marker(&self, area: &Area<'_>, at: Pixel) -> Drawn {
        let fill = self.rgb().filled();
        let (x, y) = at;
        match self.marker {
            // A bar takes more than a place: see `draw_bar`.
            Marker::None | Marker::Bar => {}
            Marker::Circle => area.draw(&Circle::new(at, RADIUS, fill))?,
            Marker::Triangle => area.draw(&TriangleMarker::new(at, RADIUS + 1, fill))?,
            Marker::Square => {
                let (left, right, top, bottom) = (x - SIDE, x + SIDE, y - SIDE, y + SIDE);
                let corners = vec![
                    (left, top),
                    (right, top),
                    (right, bottom),
                    (left, bottom),
                    (left, top),
                ];
                area.draw(&PathElement::new(corners, self.rgb().stroke_width(2)))?;
            }
        }
        Ok(())
    }
}
