//! Figures are well-formed, complete, and the same twice.

use super::*;

/// The names of the elements, once it is known that each is closed in its turn.
fn elements(svg: &str) -> Vec<String> {
    let (mut open, mut all): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    for piece in svg.split('<').skip(1) {
        let (tag, text) = piece.split_once('>').expect("a tag ends");
        assert!(!text.contains('>'), "{text:?}");
        for entity in text.split('&').skip(1) {
            assert!(entity.contains(';'), "{entity:?}");
        }
        let name = tag.split([' ', '/']).find(|name| !name.is_empty());
        let name = name.expect("a tag has a name").to_owned();
        if tag.starts_with('/') {
            assert_eq!(open.pop().as_ref(), Some(&name));
            continue;
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag:?}");
        all.push(name.clone());
        if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "left open: {open:?}");
    all
}

fn figure(title: &str) -> Figure {
    let curve = |name: &str, colour, marker, slope: f64| Curve {
        look: Look {
            name: name.to_owned(),
            colour,
            marker,
            width: 2,
        },
        points: (1..=5)
            .map(|step| Point {
                x: f64::from(step) * 100.0,
                y: slope * f64::from(step),
                label: Some(format!("point {step}")),
                interval: None,
            })
            .collect(),
    };
    Figure {
        title: title.to_owned(),
        panels: vec![Panel {
            title: title.to_owned(),
            x: Axis::new("runs per second", Scale::Logarithmic),
            y: Axis::new("deviation, quanta", Scale::FromZero),
            curves: vec![
                curve("falling", (1, 2, 3), Marker::Circle, -1.0),
                curve("rising", (4, 5, 6), Marker::Triangle, 1.0),
                curve("level", (7, 8, 9), Marker::Square, 0.0),
            ],
        }],
        columns: 3,
    }
}

#[test]
fn a_figure_is_well_formed_and_shows_every_curve() {
    let svg = figure("a flight").to_svg().expect("drawn");
    let all = elements(&svg);
    assert_eq!(all.first().map(String::as_str), Some("svg"));
    for colour in ["#010203", "#040506", "#070809"] {
        let lines = svg.lines().filter(|line| line.starts_with("<polyline"));
        let of_colour = lines.filter(|line| line.contains(colour)).count();
        assert!(
            of_colour >= 2,
            "a curve and its line in the legend: {colour}"
        );
    }
    for text in [
        "falling",
        "rising",
        "level",
        "runs per second",
        "deviation, quanta",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    assert_eq!(svg, figure("a flight").to_svg().expect("drawn"));
}

/// The attribute of an element's line, as a number.
fn attribute(line: &str, name: &str) -> f64 {
    let (_, rest) = line
        .split_once(&format!(" {name}=\""))
        .expect("it is there");
    rest.split_once('"')
        .expect("it ends")
        .0
        .parse()
        .expect("a number")
}

#[test]
fn bars_stand_on_zero_and_intervals_reach_to_their_ends() {
    let mut figure = figure("bars");
    let panel = &mut figure.panels[0];
    panel.x = Axis::of_names("place", vec!["lab".into(), "arch".into()]);
    panel.y = Axis::new("better by, %", Scale::FromZero);
    panel.curves.truncate(1);
    let curve = &mut panel.curves[0];
    curve.look.marker = Marker::Bar;
    curve.look.width = 20;
    let point = |x, y: f64| Point {
        x,
        y,
        label: None,
        interval: Some([y - 1.0, y + 1.0]),
    };
    curve.points = vec![point(0.0, 4.0), point(1.0, -4.0)];
    let svg = figure.to_svg().expect("drawn");
    elements(&svg);
    assert!(svg.contains("lab") && svg.contains("arch"), "{svg}");
    let of_curve = |line: &&str| line.starts_with("<rect") && line.contains("#010203");
    let bars: Vec<&str> = svg.lines().filter(of_curve).collect();
    // The first of them is in the legend.
    let [up, down] = bars[..] else {
        let [_, up, down] = bars[..] else {
            panic!("{bars:?}")
        };
        return check_bars(up, down);
    };
    check_bars(up, down);
}

fn check_bars(up: &str, down: &str) {
    let bottom = attribute(up, "y") + attribute(up, "height");
    assert!((bottom - attribute(down, "y")).abs() <= 1.0, "both at zero");
    let heights = [up, down].map(|bar| attribute(bar, "height"));
    assert!((heights[0] - heights[1]).abs() <= 1.0 && heights[0] > 50.0);
}

#[test]
fn no_title_breaks_the_document() {
    for title in [
        "<svg> & \"quotes\" 'and'",
        "two\nlines\u{1}",
        "\u{ffff}",
        "",
    ] {
        elements(&figure(title).to_svg().expect("drawn"));
    }
}

#[test]
fn values_that_no_axis_shows_are_left_out() {
    let mut figure = figure("a flight");
    for point in &mut figure.panels[0].curves[0].points {
        point.x = f64::NAN;
    }
    assert!(!figure.to_svg().expect("drawn").contains("NaN"));
    figure.panels[0].curves.truncate(1);
    let svg = figure.to_svg().expect("drawn");
    elements(&svg);
    assert!(svg.contains("nothing to show"));
    figure.panels.clear();
    elements(&figure.to_svg().expect("drawn"));
}

#[test]
fn names_that_look_alike_are_told_apart_by_a_legend_for_each_panel() {
    let mut figure = figure("a");
    let told = |figure: &Figure, name: &str| {
        let svg = figure.to_svg().expect("drawn");
        svg.lines().filter(|line| line.trim() == name).count()
    };
    figure.panels.push(figure.panels[0].clone());
    assert_eq!(told(&figure, "rising"), 1);
    let look = &mut figure.panels[1].curves[1].look;
    (look.name, look.colour, look.marker) = ("steep".to_owned(), (1, 2, 3), Marker::Circle);
    assert_eq!(
        ["falling", "rising", "steep"].map(|name| told(&figure, name)),
        [2, 1, 1]
    );
}

#[test]
fn a_map_s_unit_is_as_long_on_both_axes_and_nothing_is_cut() {
    let axis = Axis::new("m", Scale::Map);
    let fit = |low, high| axis.fit([low, high].into_iter()).expect("an axis");
    for (east, north) in [([0.0, 10.0], [0.0, 1.0]), ([3.0, 3.0], [-50.0, 50.0])] {
        let fitted = (fit(east[0], east[1]), fit(north[0], north[1]));
        let (x, y) = axis::Fitted::as_map(fitted.0.clone(), fitted.1.clone(), (400.0, 300.0));
        let units = [(x.high - x.low) / 400.0, (y.high - y.low) / 300.0];
        assert!((units[0] / units[1] - 1.0).abs() < 1e-9, "{units:?}");
        for (map, of) in [(x, fitted.0), (y, fitted.1)] {
            assert!(map.low <= of.low && map.high >= of.high, "{map:?}");
        }
    }
}

#[test]
fn a_logarithmic_axis_shows_a_factor_of_two_at_least() {
    let axis = Axis::new("runs per second", Scale::Logarithmic);
    let narrow = axis.fit([49.1, 49.26].into_iter()).expect("an axis");
    assert!(narrow.high - narrow.low > 0.3, "{narrow:?}");
    assert!(narrow.ticks.len() > 1, "{narrow:?}");
}
