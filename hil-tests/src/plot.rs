//! Figures as SVG: panels with titled axes, curves with markers, legends.
//!
//! ```text
//! Figure { title, panels } -- each Panel { title, x, y, curves } -- each Curve { look, points }
//! ```
//! Looks differ in colour, brightness and marker, so that a figure in grey print still reads.
//! The viewer of the SVG chooses the font: none is looked for here. The same figure gives the
//! same bytes. Values that an axis cannot show (not finite, or not above 0 on a logarithmic
//! one) are left out.

mod axis;
mod curve;
mod panel;
#[cfg(test)]
mod tests;

use anyhow::{Result, anyhow};
use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, IntoDrawingArea, RGBColor, SVGBackend, Text, WHITE};
use plotters::style::{FontStyle, IntoFont, TextStyle};

pub use axis::{Axis, Scale};
pub use curve::{Curve, Look, Marker, Point};
pub use panel::Panel;

/// What figures are drawn on, within this module.
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A place in the figure's units, from its upper left corner.
type Pixel = (i32, i32);

/// Whether it could be drawn.
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Width and height of a panel, in the figure's units (a screen's pixels).
const PANEL: (u32, u32) = (560, 430);
/// Height of the title's and of the legend's line.
const LINE_HEIGHT: u32 = 38;
/// Margin around everything.
const MARGIN: u32 = 12;
/// Nearly black: softer than black on a screen, black in print.
const INK: RGBColor = RGBColor(34, 34, 34);

/// A page of panels under one title and one legend, or one for each where looks mean several things.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The line on top.
    pub title: String,
    /// Drawn in their order, row by row.
    pub panels: Vec<Panel>,
    /// Panels beside each other, at most; 0 counts as 1.
    pub columns: usize,
}

impl Figure {
    /// The figure as an SVG document.
    ///
    /// # Errors
    /// None in practice: nothing is written but a string.
    pub fn to_svg(&self) -> Result<String> {
        let columns = self.columns.min(self.panels.len()).max(1);
        let rows = self.panels.len().div_ceil(columns).max(1);
        let size = (
            PANEL.0 * columns as u32 + 2 * MARGIN,
            PANEL.1 * rows as u32 + 2 * LINE_HEIGHT + 2 * MARGIN,
        );
        let mut svg = String::new();
        {
            let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
            self.draw(&root, (rows, columns))
                .map_err(|error| anyhow!("the figure cannot be drawn: {error}"))?;
        }
        Ok(svg)
    }

    fn draw(&self, root: &Area<'_>, grid: (usize, usize)) -> Drawn {
        root.fill(&WHITE)?;
        let margin = MARGIN as i32;
        let page = root.margin(margin, margin, margin, margin);
        let (title, rest) = page.split_vertically(LINE_HEIGHT);
        let (legend, body) = rest.split_vertically(LINE_HEIGHT);
        let at = (margin, 4);
        let size = title_size(&self.title, title.dim_in_pixel().0);
        title.draw(&Text::new(plain(&self.title), at, bold(size)))?;
        let looks = self.looks();
        let told_apart = are_told_apart(&looks);
        if told_apart {
            draw_legend(&legend, &looks)?;
        }
        for (panel, area) in self.panels.iter().zip(body.split_evenly(grid)) {
            panel.draw(root, &area, !told_apart)?;
        }
        root.present()?;
        Ok(())
    }

    fn looks(&self) -> Vec<&Look> {
        looks_of(self.panels.iter().flat_map(|panel| &panel.curves))
    }
}

/// Every look once, in the order of the curves.
fn looks_of<'c>(curves: impl Iterator<Item = &'c Curve>) -> Vec<&'c Look> {
    let mut looks: Vec<&Look> = Vec::new();
    for curve in curves {
        if !looks.iter().any(|look| look.name == curve.look.name) {
            looks.push(&curve.look);
        }
    }
    looks
}

/// Whether no two names look alike.
fn are_told_apart(looks: &[&Look]) -> bool {
    let alike = |one: &Look, other: &Look| (one.colour, one.marker) == (other.colour, other.marker);
    let mut rest = looks;
    while let [one, behind @ ..] = rest {
        if behind.iter().any(|other| alike(one, other)) {
            return false;
        }
        rest = behind;
    }
    true
}

/// The size of a title that fits a width: a bold letter is about two thirds as wide as it is high.
fn title_size(title: &str, width: u32) -> i32 {
    const LARGEST: u32 = 22;
    let letters = title.chars().count().max(1) as u32;
    (width * 3 / 2 / letters).clamp(LARGEST / 2, LARGEST) as i32
}

fn draw_legend(area: &Area<'_>, looks: &[&Look]) -> Drawn {
    /// Length of the sample of a line, the gap to its name, and the mean width of a letter.
    const SAMPLE: i32 = 36;
    const GAP: i32 = 8;
    const LETTER: i32 = 8;
    let mut x = MARGIN as i32;
    let y = LINE_HEIGHT as i32 / 2 - 4;
    for look in looks {
        look.draw_sample(area, (x, y), SAMPLE)?;
        x += SAMPLE + GAP;
        area.draw(&Text::new(plain(&look.name), (x, y - 9), text(16)))?;
        x += LETTER * look.name.chars().count() as i32 + 3 * GAP;
    }
    Ok(())
}

fn text(size: i32) -> TextStyle<'static> {
    TextStyle::from(("sans-serif", size).into_font()).color(&INK)
}

fn bold(size: i32) -> TextStyle<'static> {
    let font = ("sans-serif", size).into_font().style(FontStyle::Bold);
    TextStyle::from(font).color(&INK)
}

/// Text that XML can hold: names of files come from outside.
fn plain(text: &str) -> String {
    let allowed = |c: char| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars()
        .map(|c| if allowed(c) { c } else { '\u{fffd}' })
        .collect()
}
