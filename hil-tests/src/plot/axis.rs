//! Axes: from values to places on paper, and which values get a tick.
//!
//! The drawing library has ticks too, but on a logarithmic axis at powers of ten alone, of which
//! most figures here show one or two.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

/// How values are spread along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// Evenly, and 0 is always shown.
    FromZero,
    /// Evenly, a unit as long as on the panel's other axis, where that is a map's too.
    Map,
    /// By their logarithm; values of 0 and below cannot be shown.
    Logarithmic,
}

/// One axis of a panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows, with the unit.
    pub title: String,
    /// How values are spread along it.
    pub scale: Scale,
    /// Names of the values 0, 1 and so on; none for an axis of numbers.
    pub names: Vec<String>,
}

/// An axis that was fitted to its values; places on it are what `place` returns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fitted {
    scale: Scale,
    names: Vec<String>,
    pub low: f64,
    pub high: f64,
    pub ticks: Vec<f64>,
}

/// Room beyond the outermost values, as a share of the range.
const ROOM: f64 = 0.06;
/// The least of a logarithmic axis, in powers of ten: a factor of two. What differs by less looks so.
const LEAST_DECADES: f64 = 0.301;
/// Ticks that an axis has at least, where its range lets it.
const FEWEST_TICKS: usize = 4;
/// Mantissas of the ticks on a logarithmic axis, sparse to dense.
const MANTISSAS: [&[f64]; 4] = [
    &[1.0],
    &[1.0, 2.0, 5.0],
    &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0],
    &[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0],
];

impl Axis {
    /// An axis with a title, which names the unit.
    pub fn new(title: impl Into<String>, scale: Scale) -> Self {
        Self {
            title: title.into(),
            scale,
            names: Vec::new(),
        }
    }

    /// An axis of named places at 0, 1 and so on; all of them are shown.
    pub fn of_names(title: impl Into<String>, names: Vec<String>) -> Self {
        Self {
            names,
            ..Self::new(title, Scale::Linear)
        }
    }

    /// Where a value lies on paper; `None` for one that cannot be shown.
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        self.scale.place(value)
    }

    /// The axis over some values; `None` where none can be shown.
    pub(super) fn fit(&self, values: impl Iterator<Item = f64>) -> Option<Fitted> {
        if !self.names.is_empty() {
            return Some(self.fit_names());
        }
        let places = values.filter_map(|value| self.place(value));
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
            (low.min(place), high.max(place))
        });
        if low > high {
            return None;
        }
        let (low, high) = self.scale.with_room(low, high);
        Some(Fitted::over(self.scale, low, high))
    }

    fn fit_names(&self) -> Fitted {
        let last = self.names.len() as f64 - 1.0;
        Fitted {
            scale: self.scale,
            names: self.names.clone(),
            low: -0.5,
            high: last + 0.5,
            ticks: (0..self.names.len()).map(|place| place as f64).collect(),
        }
    }
}

impl Fitted {
    fn over(scale: Scale, low: f64, high: f64) -> Self {
        let ticks = match scale {
            Scale::Logarithmic => logarithmic_ticks(low, high),
            _ => linear_ticks(low, high),
        };
        Self {
            scale,
            names: Vec::new(),
            low,
            high,
            ticks,
        }
    }

    /// The same around its middle, at least so long.
    fn at_least(self, length: f64) -> Self {
        if self.high - self.low >= length {
            return self;
        }
        let middle = (self.low + self.high) / 2.0;
        Self::over(self.scale, middle - length / 2.0, middle + length / 2.0)
    }

    /// Both axes of a map that is `width` by `height` on paper: the shorter one shows more.
    pub(super) fn as_map(x: Self, y: Self, (width, height): (f64, f64)) -> (Self, Self) {
        let unit = ((x.high - x.low) / width).max((y.high - y.low) / height);
        (x.at_least(unit * width), y.at_least(unit * height))
    }
}

impl Scale {
    fn place(self, value: f64) -> Option<f64> {
        let place = match self {
            Self::Logarithmic => value.log10(),
            _ => value,
        };
        place.is_finite().then_some(place)
    }

    fn with_room(self, low: f64, high: f64) -> (f64, f64) {
        let (low, high) = match self {
            Self::FromZero => (low.min(0.0), high.max(0.0)),
            Self::Logarithmic if high - low < LEAST_DECADES && high > low => {
                let middle = (low + high) / 2.0;
                (middle - LEAST_DECADES / 2.0, middle + LEAST_DECADES / 2.0)
            }
            _ => (low, high),
        };
        let width = high - low;
        let room = if width > 1e-9 * high.abs().max(low.abs()) {
            ROOM * width
        } else {
            // A single value stands in the middle.
            (0.1 * high.abs()).max(0.1)
        };
        match self {
            Self::FromZero if low == 0.0 => (0.0, high + room),
            Self::FromZero if high == 0.0 => (low - room, 0.0),
            _ => (low - room, high + room),
        }
    }
}

impl ValueFormatter<f64> for Fitted {
    /// The value at a place, as a person reads it.
    fn format_ext(&self, place: &f64) -> String {
        if let Some(name) = self.names.get(place.round() as usize) {
            return super::plain(name);
        }
        match self.scale {
            Scale::Logarithmic => short(10f64.powf(*place)),
            _ => short(*place),
        }
    }
}

impl Ranged for Fitted {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, place: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (place - self.low) / (self.high - self.low);
        from + (share * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return Vec::new();
        }
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

/// A number in up to five significant digits, without the zeros behind it.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    // No tick reads `-0`.
    format!("{}", rounded + 0.0)
}

/// Ticks at multiples of 1, 2 or 5 of a power of ten.
fn linear_ticks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / FEWEST_TICKS as f64;
    let decade = 10f64.powf(rough.log10().floor());
    let factors = [5.0, 2.0, 1.0];
    let factor = factors.into_iter().find(|factor| factor * decade <= rough);
    let step = factor.unwrap_or(1.0) * decade;
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    // Rounded, so that a tick at 0.3 is not one at 0.30000000000000004.
    (first..=last)
        .map(|count| {
            let tick = count as f64 * step;
            format!("{tick:.9e}").parse().unwrap_or(tick)
        })
        .collect()
}

/// Ticks at round values, as sparse as still are enough; places, not values.
fn logarithmic_ticks(low: f64, high: f64) -> Vec<f64> {
    let ticks_at = |mantissas: &[f64]| -> Vec<f64> {
        let decades = low.floor() as i32..=high.floor() as i32;
        decades
            .flat_map(|decade| mantissas.iter().map(move |m| m.log10() + f64::from(decade)))
            .filter(|tick| (low..=high).contains(tick))
            .collect()
    };
    let enough = MANTISSAS
        .iter()
        .map(|mantissas| ticks_at(mantissas))
        .find(|ticks| ticks.len() >= FEWEST_TICKS);
    enough.unwrap_or_else(|| {
        let values = linear_ticks(10f64.powf(low), 10f64.powf(high));
        values.into_iter().map(f64::log10).collect()
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn labels(scale: Scale, values: &[f64]) -> Vec<String> {
        let fitted = Axis::new("", scale).fit(values.iter().copied()).unwrap();
        let ticks = fitted.ticks.iter();
        ticks.map(|tick| fitted.format_ext(tick)).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(
            labels(Scale::FromZero, &[0.71]),
            ["0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7"]
        );
        assert_eq!(
            labels(Scale::Logarithmic, &[15.0, 600.0]),
            ["20", "50", "100", "200", "500"]
        );
        assert_eq!(
            labels(Scale::Logarithmic, &[90.0, 400.0]),
            ["100", "150", "200", "300"]
        );
        assert_eq!(
            labels(Scale::Linear, &[-2.0, 2.0]),
            ["-2", "-1", "0", "1", "2"]
        );
    }

    #[test]
    fn named_places_are_shown_whether_or_not_there_is_a_value() {
        let axis = Axis::of_names("", vec!["lab".into(), "arch".into()]);
        let fitted = axis.fit(std::iter::empty()).unwrap();
        let names = fitted.ticks.iter().map(|tick| fitted.format_ext(tick));
        assert_eq!(names.collect::<Vec<_>>(), ["lab", "arch"]);
        assert_eq!(fitted.range(), -0.5..1.5);
    }

    #[test]
    fn an_axis_without_a_value_to_show_is_none() {
        for values in [&[][..], &[f64::NAN], &[0.0, -1.0]] {
            let axis = Axis::new("", Scale::Logarithmic);
            assert_eq!(axis.fit(values.iter().copied()), None, "{values:?}");
        }
    }

    proptest! {
        #[test]
        fn every_value_lies_within_and_ticks_are_few(
            values in prop::collection::vec(-1e6..1e6f64, 1..9),
            scale in prop::sample::select(vec![Scale::Linear, Scale::FromZero, Scale::Logarithmic]),
        ) {
            let axis = Axis::new("", scale);
            if let Some(fitted) = axis.fit(values.iter().copied()) {
                prop_assert!(fitted.low < fitted.high);
                prop_assert!(fitted.ticks.len() <= 20, "{:?}", fitted);
                for place in values.iter().filter_map(|value| axis.place(*value)) {
                    prop_assert!((fitted.low..=fitted.high).contains(&place));
                }
            }
        }
    }
}
