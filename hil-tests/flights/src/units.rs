//! Units of text logs: converted where they are told, recognised by magnitude.
//!
//! A flight shows most of its units: gravity, the field of the earth and the
//! rates of samples are known. Rates of turning are judged by the specific force:
//! on nine flights, from hover to freestyle, the ratio of [`Raw`] is 0.2 to 1.5 in
//! rad/s and 57 times that in deg/s.

use std::fmt;
use std::str::FromStr;

use super::error::quoted;
use super::recording::Sensor;
use super::track::{SECOND_NS, Track};
use chip_models::stimulus::STANDARD_GRAVITY;

/// A quantity that has a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Time,
    Of(Sensor),
}

/// A unit of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    /// As it is written.
    pub(super) name: &'static str,
    pub(super) quantity: Quantity,
    /// How much of ours (s, rad/s, m/s2, gauss) one of it is; 0 where a flight must show it.
    pub(super) factor: f64,
}

const fn unit(name: &'static str, quantity: Quantity, factor: f64) -> Unit {
    Unit {
        name,
        quantity,
        factor,
    }
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

pub(super) const S: Unit = unit("s", Quantity::Time, 1.0);
pub(super) const MS: Unit = unit("ms", Quantity::Time, 1e-3);
pub(super) const US: Unit = unit("us", Quantity::Time, 1e-6);
pub(super) const NS: Unit = unit("ns", Quantity::Time, 1e-9);
pub(super) const RAD_S: Unit = unit("rad/s", Quantity::Of(Sensor::Gyroscope), 1.0);
pub(super) const DEG_S: Unit = unit("deg/s", Quantity::Of(Sensor::Gyroscope), DEGREE);
pub(super) const M_S2: Unit = unit("m/s2", Quantity::Of(Sensor::Accelerometer), 1.0);
pub(super) const G: Unit = unit("g", Quantity::Of(Sensor::Accelerometer), STANDARD_GRAVITY);
const MG: Unit = unit(
    "mg",
    Quantity::Of(Sensor::Accelerometer),
    STANDARD_GRAVITY * 1e-3,
);
/// Counts of an accelerometer, a power of two for each g.
pub(super) const COUNTS: Unit = unit("counts", Quantity::Of(Sensor::Accelerometer), 0.0);
pub(super) const GAUSS: Unit = unit("gauss", Quantity::Of(Sensor::Magnetometer), 1.0);
const MILLIGAUSS: Unit = unit("mgauss", Quantity::Of(Sensor::Magnetometer), 1e-3);
const MICROTESLA: Unit = unit("ut", Quantity::Of(Sensor::Magnetometer), 1e-2);
const TESLA: Unit = unit("tesla", Quantity::Of(Sensor::Magnetometer), 1e4);

const ALL: [Unit; 14] = [
    S, MS, US, NS, RAD_S, DEG_S, M_S2, G, MG, COUNTS, GAUSS, MILLIGAUSS, MICROTESLA, TESLA,
];

impl Unit {
    /// A unit as headers and people write it.
    pub(super) fn of(text: &str) -> Option<Self> {
        let text: String = text.to_lowercase().replace(['^', '-', ' ', '*'], "");
        let name = match text.as_str() {
            "µs" | "μs" | "usec" => "us",
            "sec" => "s",
            "rads1" | "rads" | "rad/sec" => "rad/s",
            "degs1" | "°/s" | "dps" | "deg/sec" | "degs" => "deg/s",
            "ms2" | "m/s²" | "m/s/s" => "m/s2",
            "gs" => "g",
            "µt" | "μt" | "microtesla" => "ut",
            "gs1" | "ga" => "gauss",
            "mgauss" | "milligauss" => "mgauss",
            "t" => "tesla",
            name => name,
        };
        ALL.into_iter().find(|unit| unit.name == name)
    }
}

/// The units that a user tells, at most one for each quantity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Units(Vec<Unit>);

impl Units {
    pub(super) fn of(&self, quantity: Quantity) -> Option<Unit> {
        self.0
            .iter()
            .copied()
            .find(|unit| unit.quantity == quantity)
    }
}

/// Units that cannot be read; says which can.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitsError(String);

impl fmt::Display for UnitsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known: Vec<&str> = ALL.iter().map(|unit| unit.name).collect();
        write!(
            f,
            "{}: use one of each kind of {}",
            self.0,
            known.join(", ")
        )
    }
}

impl std::error::Error for UnitsError {}

impl FromStr for Units {
    type Err = UnitsError;

    /// Reads `deg/s,g` and the like.
    fn from_str(text: &str) -> Result<Self, UnitsError> {
        let mut units = Self::default();
        for name in text.split(',') {
            let unit = Unit::of(name.trim());
            let unit = unit.ok_or_else(|| UnitsError(format!("unknown unit {}", quoted(name))))?;
            if let Some(other) = units.of(unit.quantity) {
                let (one, two) = (other.name, unit.name);
                return Err(UnitsError(format!("{one} and {two} are of one kind")));
            }
            units.0.push(unit);
        }
        Ok(units)
    }
}

/// Raw samples of gyroscope and accelerometer, by which units are recognised.
pub(super) struct Raw<'a> {
    pub(super) gyro: &'a Track<3>,
    pub(super) accel: &'a Track<3>,
}

impl Raw<'_> {
    /// The unit that a sensor's samples look as if they had, where not what they are taken for.
    pub(super) fn looks_like(
        &self,
        sensor: Sensor,
        raw: &Track<3>,
        taken_for: Unit,
    ) -> Option<Unit> {
        let (size, usual) = match sensor {
            Sensor::Gyroscope => (self.turning()?, 0.0..MOST_TURNING),
            Sensor::Accelerometer => (median(lengths(raw))?, 3.0..40.0),
            Sensor::Magnetometer => (median(lengths(raw))?, 0.05..3.0),
        };
        let fits = |unit: &Unit| usual.contains(&(size * unit.factor));
        if size == 0.0 || fits(&taken_for) {
            return None;
        }
        let candidates = ALL
            .into_iter()
            .filter(|unit| unit.quantity == Quantity::Of(sensor));
        candidates.filter(|unit| unit.factor > 0.0).find(fits)
    }

    /// How far the body rolls or pitches in the median second, against how much the specific force
    /// varies, in g: who turns feels it. About 1 for any flight in rad/s, and 57 in deg/s.
    fn turning(&self) -> Option<f64> {
        /// Both are measured over so long.
        const STEP_NS: i64 = SECOND_NS;
        /// Noise, which says nothing.
        const LEAST_G: f64 = 0.05;
        /// Fewer steps show nothing.
        const ENOUGH: usize = 8;
        let turned = means(self.gyro, STEP_NS);
        if turned.len() < ENOUGH {
            return None;
        }
        let turned = turned
            .iter()
            .map(|[x, y, _]| x.abs().max(y.abs()))
            .collect();
        let forces = means(self.accel, STEP_NS / 5);
        let one_g = median(lengths(self.accel)).filter(|length| *length > 0.0)?;
        let mut sizes: Vec<f64> = forces.iter().map(length).collect();
        sizes.sort_by(f64::total_cmp);
        let part = |share: f64| sizes.get((sizes.len() as f64 * share) as usize).copied();
        let spread = part(0.9)? - part(0.1)?;
        let behind = forces.iter().skip(5);
        let changes = forces
            .iter()
            .zip(behind)
            .map(|(a, b)| length(&[a[0] - b[0], a[1] - b[1], a[2] - b[2]]));
        let changed = median(changes.collect()).unwrap_or_default();
        Some(median(turned)? / (LEAST_G + (spread + changed) / one_g))
    }
}

/// Beyond it a flight turns without feeling it.
const MOST_TURNING: f64 = 6.0;

fn length(v: &[f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn lengths(track: &Track<3>) -> Vec<f64> {
    track.values().iter().map(length).collect()
}

/// The means of a signal over spans of a length.
fn means(track: &Track<3>, length_ns: i64) -> Vec<[f64; 3]> {
    let mut means = Vec::new();
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    let mut from = track.first_time_ns().unwrap_or_default();
    for (time, value) in track.iter() {
        if time - from >= length_ns {
            means.push(sum.map(|sum| sum / count));
            (sum, count, from) = ([0.0; 3], 0.0, time);
        }
        count += 1.0;
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum += value;
        }
    }
    means
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Counts at 1 g: the power of two next to the median length.
pub(super) fn counts_of_1_g(raw: &Track<3>) -> f64 {
    let size = median(lengths(raw)).unwrap_or(1.0);
    size.max(1.0).log2().round().exp2()
}

/// The unit of time in which samples come 20 to 40 000 times a second; none for a log without time.
pub(super) fn of_time(median_period: f64) -> Option<Unit> {
    let mut units = [US, NS, S, MS].into_iter();
    units.find(|unit| is_period(median_period, *unit))
}

/// True for a period of samples that a log in this unit may have.
pub(super) fn is_period(period: f64, unit: Unit) -> bool {
    (25e-6..=0.05).contains(&(period * unit.factor))
}
