//! The picture as SVG, laid out by `layout-rs`.
//!
//! The crate places boxes and leads arrows round them. It is drawn here: its own SVG knows no
//! dotted lines, no background and no tooltips, writes all digits of a coordinate, and lets arrows
//! leave a box sideways, across its neighbours.

use std::fmt::Write;

use layout::core::base::Orientation;
use layout::core::color::Color;
use layout::core::format::{ClipHandle, RenderBackend};
use layout::core::geometry::Point;
use layout::core::style::{LineStyleKind, StyleAttr};
use layout::std_shapes::shapes::{Arrow as LaidArrow, Element, LineEndKind, ShapeKind};
use layout::topo::layout::VisualGraph;
use reflex::dataflow::Description;

use super::scene::{LEGEND, Role, Shape, Stroke, arrows, shapes};

/// Size of letters, in px.
const FONT: usize = 12;
/// Width of a letter at most on average, as a share of its size.
const LETTER: f64 = 0.62;
/// Height of a line of text, in px.
const LINE_HEIGHT: f64 = 16.0;
/// Between text and edge of a box, in px.
const MARGIN: f64 = 10.0;
/// Height of title and legend, in px.
const HEADER: f64 = 48.0;

/// How far an arrow runs straight down from a box or to one, in px.
const BEND: f64 = 30.0;
/// Lengths of strokes and gaps, in px.
const SOLID: &str = "";
const DASHED: &str = "6,4";
const DOTTED: &str = "1,4";

/// The graph as SVG, what is read above who reads it.
#[must_use]
pub fn svg(graph: &Description) -> String {
    let direction = Orientation::TopToBottom;
    let mut laid = VisualGraph::new(direction);
    let shapes = shapes(graph);
    let handles: Vec<_> = shapes
        .iter()
        .map(|shape| laid.add_node(element(shape, direction)))
        .collect();
    let place = |name| shapes.iter().position(|shape| shape.name == name);
    let mut all = arrows(graph);
    // What would close a cycle is turned round by the layout, in this order.
    all.sort_by_key(|arrow| arrow.stroke == Stroke::Dashed);
    for arrow in all {
        if let (Some(from), Some(to)) = (place(arrow.from), place(arrow.to)) {
            laid.add_edge(laid_arrow(arrow.stroke), handles[from], handles[to]);
        }
    }
    let mut canvas = Canvas::default();
    laid.do_it(false, false, false, &mut canvas);
    canvas.finish(&format!("{}: {}", graph.name, graph.doc))
}

fn element(shape: &Shape, direction: Orientation) -> Element {
    let (fill, rounded, width) = match shape.role {
        Role::Input => (0xee_ee_ee_ff, 12, 1),
        Role::State => (0xcf_e2_f7_ff, 0, 1),
        Role::Node => (0xff_ff_ff_ff, 0, 1),
        Role::Output => (0xff_ff_ff_ff, 0, 3),
    };
    let look = StyleAttr::new(
        Color::fast("black"),
        width,
        Some(Color::new(fill)),
        rounded,
        FONT,
    );
    let label = shape.label.join("\n");
    let size = Point::new(
        widest(&label) + 2.0 * MARGIN,
        LINE_HEIGHT * shape.label.len() as f64 + 2.0 * MARGIN,
    );
    Element::create_with_properties(ShapeKind::new_box(&label), look, direction, size, shape.doc)
}

fn widest(label: &str) -> f64 {
    let letters = label.lines().map(|line| line.chars().count()).max();
    letters.unwrap_or(0) as f64 * FONT as f64 * LETTER
}

fn laid_arrow(stroke: Stroke) -> LaidArrow {
    let kind = match stroke {
        Stroke::Solid => LineStyleKind::Normal,
        Stroke::Dashed | Stroke::Dotted => LineStyleKind::Dashed,
    };
    let dashes = match stroke {
        Stroke::Solid => SOLID,
        Stroke::Dashed => DASHED,
        Stroke::Dotted => DOTTED,
    };
    LaidArrow {
        start: LineEndKind::None,
        end: LineEndKind::Arrow,
        line_style: kind,
        look: StyleAttr::new(Color::fast("black"), 1, None, 0, FONT),
        properties: Some(dashes.to_owned()),
        ..LaidArrow::default()
    }
}

/// What the layout draws on.
#[derive(Debug, Default)]
struct Canvas {
    boxes: String,
    /// Beneath the boxes, so that no label is crossed.
    arrows: String,
    /// Corners of the boxes: left, top; right, bottom.
    corners: Vec<(Point, Point)>,
    /// How far anything reaches to the right and down.
    width: f64,
    height: f64,
}

impl Canvas {
    fn reach(&mut self, at: Point) {
        self.width = self.width.max(at.x);
        self.height = self.height.max(at.y);
    }

    /// The box with this point on its edge.
    fn box_at(&self, at: Point) -> Option<(Point, Point)> {
        let within = |low: f64, x: f64, high: f64| low - 1.0 <= x && x <= high + 1.0;
        let mut corners = self.corners.iter();
        let found =
            corners.find(|(low, high)| within(low.x, at.x, high.x) && within(low.y, at.y, high.y));
        found.copied()
    }

    /// The path of an arrow from the lower edge of one box to the upper edge of another one.
    ///
    /// The first point is followed by its control, the others follow theirs. A loop stays as it is.
    fn attached(&self, path: &[(Point, Point)], aside: f64) -> Vec<(Point, Point)> {
        let [first, between @ .., last] = path else {
            return path.to_vec();
        };
        let (Some(above), Some(below)) = (self.box_at(first.0), self.box_at(last.1)) else {
            return path.to_vec();
        };
        if above.1.y >= below.0.y {
            return path.to_vec();
        }
        let middle = |corners: (Point, Point)| (corners.0.x + corners.1.x) / 2.0;
        let next = between.first().map_or(middle(below), |point| point.1.x);
        let before = between.last().map_or(middle(above), |point| point.1.x);
        let start = Point::new(towards(above, next) + aside, above.1.y);
        let end = Point::new(towards(below, before) + aside, below.0.y);
        let bend = Point::new(0.0, BEND);
        let half = Point::new(0.0, (above.1.y - above.0.y) / 2.0);
        let mut led = vec![(start, start.add(bend))];
        for (_, at) in between {
            // Straight through a row of boxes, all of which are as high, and none is crossed.
            let (enter, leave) = (at.sub(half), at.add(half));
            led.extend([(enter.sub(bend), enter), (leave.sub(bend), leave)]);
        }
        led.push((end.sub(bend), end));
        led
    }

    /// The whole picture, with this title.
    fn finish(self, title: &str) -> String {
        let width = self.width.max(widest(LEGEND)).max(widest(title)) + 2.0 * MARGIN;
        let height = self.height + HEADER + MARGIN;
        let title = escaped(title);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" \
             width=\"{width:.0}\" height=\"{height:.0}\" font-family=\"sans-serif\" \
             font-size=\"{FONT}\">\n\
             <title>{title}</title>\n\
             <defs><marker id=\"head\" markerWidth=\"9\" markerHeight=\"7\" refX=\"9\" refY=\"3.5\" \
             orient=\"auto-start-reverse\"><path d=\"M0 0 9 3.5 0 7z\"/></marker></defs>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
             <text x=\"{MARGIN}\" y=\"20\" font-weight=\"bold\">{title}</text>\n\
             <text x=\"{MARGIN}\" y=\"38\">{LEGEND}</text>\n\
             <g transform=\"translate(0,{HEADER})\" stroke-linecap=\"round\">\n\
             {}</g>\n</svg>\n",
            self.arrows + &self.boxes
        )
    }
}

/// Where on a box's edge an arrow from or to this place is attached.
fn towards((low, high): (Point, Point), x: f64) -> f64 {
    let (middle, most) = (
        (low.x + high.x) / 2.0,
        (high.x - low.x) / 2.0 - 2.0 * MARGIN,
    );
    middle + (x - middle).clamp(-most, most)
}

impl RenderBackend for Canvas {
    fn draw_rect(
        &mut self,
        xy: Point,
        size: Point,
        look: &StyleAttr,
        properties: Option<String>,
        _clip: Option<ClipHandle>,
    ) {
        self.reach(xy.add(size));
        self.corners.push((xy, xy.add(size)));
        let fill = look.fill_color.unwrap_or_else(Color::transparent);
        let doc = escaped(&properties.unwrap_or_default());
        let line = format!(
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"{}\" \
             fill=\"{}\" stroke=\"#000000\" stroke-width=\"{}\"><title>{doc}</title></rect>",
            xy.x,
            xy.y,
            size.x,
            size.y,
            look.rounded,
            &fill.to_web_color()[..7],
            look.line_width,
        );
        self.boxes += &line;
        self.boxes.push('\n');
    }

    /// The lines of a box around their middle, the first one bold.
    fn draw_text(&mut self, xy: Point, text: &str, _look: &StyleAttr) {
        let lines = text.lines().count() as f64;
        // Letters stand on their line, a third of their size below their middle.
        let mut y = xy.y - (lines - 1.0) / 2.0 * LINE_HEIGHT + FONT as f64 / 3.0;
        for (place, line) in text.lines().enumerate() {
            let weight = if place == 0 {
                " font-weight=\"bold\""
            } else {
                ""
            };
            // Writing to a string cannot fail.
            let _ = writeln!(
                self.boxes,
                "<text x=\"{:.1}\" y=\"{y:.1}\" text-anchor=\"middle\"{weight}>{}</text>",
                xy.x,
                escaped(line)
            );
            y += LINE_HEIGHT;
        }
    }

    fn draw_arrow(
        &mut self,
        path: &[(Point, Point)],
        _dashed: bool,
        head: (bool, bool),
        _look: &StyleAttr,
        properties: Option<String>,
        _text: &str,
    ) {
        let dashes = properties.unwrap_or_default();
        // Two arrows between the same boxes lie side by side.
        let aside = match dashes.as_str() {
            SOLID => 0.0,
            DASHED => MARGIN,
            _ => -MARGIN,
        };
        let path = self.attached(path, aside);
        for (control, end) in &path {
            self.reach(*control);
            self.reach(*end);
        }
        let _ = write!(
            self.arrows,
            "<path d=\"{}\" fill=\"none\" stroke=\"#000000\"",
            curve(&path)
        );
        if dashes != SOLID {
            let _ = write!(self.arrows, " stroke-dasharray=\"{dashes}\"");
        }
        for (there, end) in [(head.0, "start"), (head.1, "end")] {
            if there {
                let _ = write!(self.arrows, " marker-{end}=\"url(#head)\"");
            }
        }
        self.arrows += "/>\n";
    }

    // Records, circles and the marks of its debugging, which no box here uses.
    fn draw_line(&mut self, _: Point, _: Point, _: &StyleAttr, _: Option<String>) {}
    fn draw_circle(&mut self, _: Point, _: Point, _: &StyleAttr, _: Option<String>) {}
    fn create_clip(&mut self, _: Point, _: Point, _: usize) -> ClipHandle {
        0
    }
}

/// A path in SVG's words.
fn curve(path: &[(Point, Point)]) -> String {
    let [first, second, rest @ ..] = path else {
        return String::new();
    };
    let points = [first.0, first.1, second.0, second.1].map(pair);
    let [start, exit, entry, end] = points;
    let mut path = format!("M{start} C{exit} {entry} {end}");
    for (control, end) in rest {
        let _ = write!(path, " S{} {}", pair(*control), pair(*end));
    }
    path
}

/// A point as paths write it.
fn pair(point: Point) -> String {
    format!("{:.1},{:.1}", point.x, point.y)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
