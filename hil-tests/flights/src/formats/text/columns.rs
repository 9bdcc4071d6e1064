//! Which column holds what, by the names in a header.

use csv::StringRecord;

use super::super::super::error::quoted;
use super::super::super::recording::MAX_MOTORS;
use super::super::super::units::{Quantity, Unit};
use super::dialects::{Axes, DIALECTS, Dialect};

/// Where a signal is, and in which unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group<const N: usize> {
    pub(super) at: [usize; N],
    pub(super) unit: Unit,
}

/// Where the time is; its unit, unless the samples must show it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Time {
    pub(super) at: usize,
    pub(super) unit: Option<Unit>,
}

/// Which column holds what.
pub(super) struct Columns {
    pub(super) names: Vec<String>,
    pub(super) dialect: &'static Dialect,
    pub(super) time: Time,
    pub(super) gyro: Group<3>,
    pub(super) accel: Group<3>,
    pub(super) mag: Option<Group<3>>,
    pub(super) motors: Vec<usize>,
}

impl Columns {
    /// Finds the columns by their names; else the reason why no writer has such.
    pub(super) fn of_header(header: &StringRecord) -> Result<Self, String> {
        let names = Names::of(header);
        let mut refusal = None;
        for dialect in &DIALECTS {
            match names.columns(dialect) {
                Ok(columns) => return Ok(columns),
                Err(reason) => {
                    // A writer whose gyroscope is there is the one that was meant.
                    if names.three(&dialect.gyro).is_some() || names.three(&dialect.accel).is_some()
                    {
                        refusal.get_or_insert(reason);
                    }
                }
            }
        }
        Err(refusal.unwrap_or_else(|| {
            let mut known: Vec<&str> = DIALECTS.iter().map(|dialect| dialect.name).collect();
            known.dedup();
            let first = header.get(0).unwrap_or_default();
            format!(
                "names no columns that are known (the first is {}): name them t_us,gx,gy,gz,ax,ay,az\
                 [,mx,my,mz][,m1..m8], or as {} do",
                quoted(first),
                known[1..].join(", ")
            )
        }))
    }

    /// Which columns are left out, where any are.
    pub(super) fn note(&self) -> Option<String> {
        let mut used = vec![self.time.at];
        used.extend(
            self.gyro
                .at
                .iter()
                .chain(&self.accel.at)
                .chain(&self.motors),
        );
        used.extend(self.mag.iter().flat_map(|mag| mag.at));
        let left_out = (0..self.names.len()).filter(|column| !used.contains(column));
        let left_out: Vec<&str> = left_out.map(|column| self.names[column].as_str()).collect();
        let first = left_out.first()?;
        Some(match left_out.len() {
            1 => format!("column {} is left out", quoted(first)),
            count => format!("{count} columns are left out, such as {}", quoted(first)),
        })
    }
}

/// The names of a header: as written, in small letters without units, and their units.
struct Names {
    written: Vec<String>,
    plain: Vec<String>,
    units: Vec<Option<Unit>>,
}

impl Names {
    fn of(header: &StringRecord) -> Self {
        let written: Vec<String> = header.iter().map(|name| name.trim().to_owned()).collect();
        let split: Vec<(String, Option<Unit>)> =
            written.iter().map(|name| with_unit(name)).collect();
        let (plain, units) = split.into_iter().unzip();
        Self {
            written,
            plain,
            units,
        }
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.plain.iter().position(|known| known == name)
    }

    fn three(&self, (names, default): &Axes) -> Option<Group<3>> {
        let [x, y, z] = names.map(|name| self.find(name));
        let at = [x?, y?, z?];
        let told = self.units[at[0]].filter(|unit| unit.quantity == default.quantity);
        Some(Group {
            at,
            unit: told.unwrap_or(*default),
        })
    }

    fn columns(&self, dialect: &'static Dialect) -> Result<Columns, String> {
        let needed = |axes: &Axes, what: &str| {
            let missing = || format!("has no {what} (columns {})", axes.0.join(","));
            self.three(axes).ok_or_else(missing)
        };
        let gyro = needed(&dialect.gyro, "gyroscope")?;
        let accel = needed(&dialect.accel, "accelerometer")?;
        let (names, unit) = dialect.time;
        let at = names.iter().find_map(|name| self.find(name));
        let at = at.ok_or_else(|| format!("has no column {}", names[0]))?;
        let told = self.units[at].filter(|unit| unit.quantity == Quantity::Time);
        let mag = dialect.mag.as_ref();
        if let Some((axes, _)) = mag
            && mag.and_then(|mag| self.three(mag)).is_none()
            && axes.iter().any(|name| self.find(name).is_some())
        {
            return Err(format!("has only a part of the columns {}", axes.join(",")));
        }
        self.check_repeated(&gyro.at.iter().chain(&accel.at).copied().collect::<Vec<_>>())?;
        let (pattern, first) = dialect.motors.0;
        let motor = |number: usize| self.find(&pattern.replace('#', &number.to_string()));
        let numbers = first..first + MAX_MOTORS;
        let motors: Vec<usize> = numbers.clone().map_while(motor).collect();
        if motors.len() < numbers.filter(|number| motor(*number).is_some()).count() {
            let missing = pattern.replace('#', &(first + motors.len()).to_string());
            return Err(format!("has no column {missing}"));
        }
        Ok(Columns {
            names: self.written.clone(),
            dialect,
            time: Time {
                at,
                unit: told.or(unit),
            },
            gyro,
            accel,
            mag: mag.and_then(|mag| self.three(mag)),
            motors,
        })
    }

    /// Refuses names that are given twice where they count.
    fn check_repeated(&self, used: &[usize]) -> Result<(), String> {
        let is_again = |&&column: &&usize| {
            let later = self.plain.iter().skip(column + 1);
            later.into_iter().any(|name| *name == self.plain[column])
        };
        match used.iter().find(is_again) {
            Some(&column) => Err(format!(
                "has the column {} twice",
                quoted(&self.written[column])
            )),
            None => Ok(()),
        }
    }
}

/// A name in small letters, and the unit that stands in brackets behind it.
fn with_unit(name: &str) -> (String, Option<Unit>) {
    let name = name.to_lowercase();
    let brackets = [('(', ')'), ('[', ']')];
    for (open, close) in brackets {
        if let Some((plain, unit)) = name
            .strip_suffix(close)
            .and_then(|name| name.rsplit_once(open))
            && unit.parse::<usize>().is_err()
        {
            return (plain.trim().to_owned(), Unit::of(unit));
        }
    }
    (name, None)
}
