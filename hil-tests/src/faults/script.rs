//! Scripts of faults: TOML, checked against the declared kinds.
//!
//! ```toml
//! [[fault]]
//! what = "bias"
//! where = "gyroscope.x"
//! at_s = 20     # from take-off
//! for_s = 0.5   # for ever without it
//! size = 10
//! unit = "deg/s" # may be left out
//! seed = 1      # of garbage; 0 without it
//! ```

use std::fmt;
use std::path::Path;

use emulated_board::BusFault;
use reflex_config::{ConfigError, Document};
use serde::{Deserialize, Serialize};

use super::kinds::{Effect, KINDS, Kind};

/// A fault as it is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    pub(super) what: String,
    #[serde(rename = "where")]
    pub(super) place: String,
    pub(super) at_s: f64,
    pub(super) for_s: Option<f64>,
    pub(super) size: Option<f64>,
    pub(super) unit: Option<String>,
    #[serde(default)]
    pub(super) seed: u32,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    fault: Vec<Entry>,
}

/// One fault, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// What happens.
    pub effect: Effect,
    /// From when on, ns from the start.
    pub from_ns: u64,
    /// Until when; `u64::MAX` for ever.
    pub until_ns: u64,
    /// Seed of its chance.
    pub seed: u32,
}

/// All faults of a flight.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script(Vec<Fault>);

/// The flight that a script is for.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Instant of take-off, or of a recorded flight's beginning, ns from the start.
    pub take_off_ns: u64,
    /// From there to the end, s.
    pub duration_s: f64,
    /// Motors of the drone; none where a recorded flight is replayed.
    pub motors: Option<usize>,
    /// Natively there are no wires.
    pub is_native: bool,
}

impl Fault {
    /// It holds at an instant.
    #[must_use]
    pub fn holds(&self, at_ns: u64) -> bool {
        (self.from_ns..self.until_ns).contains(&at_ns)
    }
}

impl Script {
    /// Reads a file.
    ///
    /// # Errors
    /// What no kind, place, unit or range has, or no flight of these limits; with file and line.
    pub fn read(file: &Path, limits: &Limits) -> Result<Self, ConfigError> {
        let document = Document::open(file)?;
        let File { fault } = document.parse()?;
        Self::checked(&fault, limits, |place, key, line| {
            document.error_at(&format!("fault.{place}.{key}"), line)
        })
    }

    /// The script of what is written; an error is placed by `error`, from the entry's place, key and line.
    ///
    /// # Errors
    /// As those of [`Self::read`].
    pub fn checked<E>(
        entries: &[Entry],
        limits: &Limits,
        error: impl Fn(usize, &str, String) -> E,
    ) -> Result<Self, E> {
        let faults = entries.iter().enumerate().map(|(place, entry)| {
            let fault = entry.checked(limits);
            fault.map_err(|(key, line)| error(place, key, line))
        });
        faults.collect::<Result<_, _>>().map(Self)
    }

    /// Faults as a file has them.
    ///
    /// # Errors
    /// None that is known: what was read can be written.
    pub fn written(entries: &[Entry]) -> Result<String, toml::ser::Error> {
        let fault = entries.to_vec();
        toml::to_string(&File { fault })
    }

    /// What happens to the wires of the emulated board.
    #[must_use]
    pub fn on_wires(&self) -> Vec<BusFault> {
        let on_wire = |fault: &Fault| match fault.effect {
            Effect::Bus(what) => Some(BusFault {
                what,
                from_ns: fault.from_ns,
                until_ns: fault.until_ns,
            }),
            _ => None,
        };
        self.iter().filter_map(on_wire).collect()
    }

    /// No fault at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Every fault.
    pub fn iter(&self) -> impl Iterator<Item = &Fault> {
        self.0.iter()
    }

    /// When the first begins, ns from the start.
    #[must_use]
    pub fn begins_ns(&self) -> Option<u64> {
        self.iter().map(|fault| fault.from_ns).min()
    }

    /// Those that hold at an instant.
    pub fn now(&self, at_ns: u64) -> impl Iterator<Item = &Fault> {
        self.iter().filter(move |fault| fault.holds(at_ns))
    }
}

impl Limits {
    /// Which key asks for what no such flight can play, and why.
    pub(super) fn refusal(&self, effect: Effect) -> Option<Refused> {
        let told = |key, why: &str| Some((key, why.to_owned()));
        match (effect, self.motors) {
            (effect, None) if effect.needs_drone() => told(
                "what",
                "has no place in a replay: no drone answers, fly instead",
            ),
            (Effect::Motor(motor, _), Some(motors)) if motor >= motors => {
                Some(("where", format!("is none of this drone's {motors} motors")))
            }
            (effect, _) if self.is_native && effect.needs_emulator() => {
                told("what", "needs the emulated board: leave out --native")
            }
            (effect, _) if !self.is_native && effect.needs_native() => {
                told("what", "is for the native tier: add --native")
            }
            _ => None,
        }
    }
}

/// A key at fault, and why.
type Refused = (&'static str, String);

/// `gyroscope.x bias 2 for 0.5 s`.
impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.place, self.what)?;
        if let Some(size) = self.size {
            write!(f, " {size}")?;
        }
        match self.for_s {
            None => Ok(()),
            Some(for_s) => write!(f, " for {for_s} s"),
        }
    }
}

impl Entry {
    /// The same kind of fault, on whatever axis or motor.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        let part = |place: &str| {
            place
                .split('.')
                .next()
                .map(|part| part.trim_end_matches(char::is_numeric).to_owned())
        };
        self.what == other.what && part(&self.place) == part(&other.place)
    }

    fn checked(&self, limits: &Limits) -> Result<Fault, Refused> {
        let kind = self.kind()?;
        let from_s = within(
            "at_s",
            self.at_s,
            [0.0, limits.duration_s],
            "s of the flight",
        )?;
        let until_ns = match self.for_s {
            None => u64::MAX,
            Some(for_s) => {
                let left = [0.0, limits.duration_s - from_s];
                nanos(
                    limits,
                    from_s + within("for_s", for_s, left, "s, to the end of the flight")?,
                )
            }
        };
        let effect = self.effect(kind)?;
        match limits.refusal(effect) {
            Some((key, why)) => Err((key, format!("`{}` {why}", self.named(key)))),
            None => Ok(Fault {
                effect,
                from_ns: nanos(limits, from_s),
                until_ns,
                seed: self.seed,
            }),
        }
    }

    /// What a key says.
    fn named(&self, key: &str) -> &str {
        match key {
            "where" => &self.place,
            _ => &self.what,
        }
    }

    fn kind(&self) -> Result<&'static Kind, Refused> {
        let named: Vec<&Kind> = KINDS.iter().filter(|kind| kind.name == self.what).collect();
        if named.is_empty() {
            let mut names: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
            names.dedup();
            return Err(("what", unknown(&self.what, &names)));
        }
        let here = |kind: &&&Kind| kind.places.contains(&self.place.as_str());
        named.iter().find(here).copied().ok_or_else(|| {
            let places: Vec<&str> = named.iter().flat_map(|kind| kind.places).copied().collect();
            ("where", unknown(&self.place, &places))
        })
    }

    fn effect(&self, kind: &Kind) -> Result<Effect, Refused> {
        let size = match (kind.size, self.size) {
            (None, None) => 0.0,
            (None, Some(_)) => return Err(("size", format!("`{}` has no size", self.what))),
            (Some(of), None) => {
                return Err(("what", format!("`{}` needs a size, {of}", self.what)));
            }
            (Some(of), Some(size)) => within("size", size, of.range, of.unit)?,
        };
        let unit = kind.size.map_or("", |size| size.unit);
        match &self.unit {
            Some(given) if given != unit => Err(("unit", unknown(given, &[unit]))),
            _ => {
                (kind.effect)(&self.place, size).ok_or(("where", unknown(&self.place, kind.places)))
            }
        }
    }
}

fn unknown(given: &str, known: &[&str]) -> String {
    let known = known.join(", ");
    format!("`{given}` is unknown here, must be one of: {known}")
}

fn within(
    key: &'static str,
    value: f64,
    [least, most]: [f64; 2],
    unit: &str,
) -> Result<f64, Refused> {
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    let line = format!("{value} is out of range, must be {least} to {most} {unit}");
    Err((key, line.trim_end().to_owned()))
}

fn nanos(limits: &Limits, since_take_off_s: f64) -> u64 {
    limits.take_off_ns + (since_take_off_s * 1e9) as u64
}

#[cfg(test)]
mod tests {
    use super::super::distortion::Distortion;
    use super::*;

    const LIMITS: Limits = Limits {
        take_off_ns: 1_500_000_000,
        duration_s: 30.0,
        motors: Some(4),
        is_native: true,
    };

    fn read(text: &str) -> Result<Script, ConfigError> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("faults.toml");
        std::fs::write(&file, text).unwrap();
        Script::read(&file, &LIMITS)
    }

    fn entry(lines: &str) -> String {
        format!("# A comment.\n[[fault]]\n{}\n", lines.replace("; ", "\n"))
    }

    #[test]
    fn a_script_is_read_with_its_times_and_its_size() {
        let text = entry(
            "what = 'bias'; where = 'gyroscope.y'; at_s = 20; for_s = 0.5; size = 10; unit = 'deg/s'; seed = 3",
        );
        let script = read(&text).unwrap();
        let fault = script.iter().next().unwrap();
        assert_eq!(
            (fault.from_ns, fault.until_ns, fault.seed),
            (21_500_000_000, 22_000_000_000, 3)
        );
        let Effect::Signal(elements, Distortion::Bias(10.0)) = fault.effect else {
            panic!("{fault:?}");
        };
        assert_eq!(elements.axes, [false, true, false]);
        assert!(fault.holds(21_500_000_000) && !fault.holds(22_000_000_000));
    }

    /// entry | line | what is said
    const SENSELESS: &str = "
what = 'sulk'; where = 'link'; at_s = 1 | 3 | what: `sulk` is unknown here, must be one of: stuck, zero,
what = 'lost'; where = 'motor9'; at_s = 1 | 4 | where: `motor9` is unknown here, must be one of: motor1,
what = 'lost'; where = 'motor5'; at_s = 1 | 4 | where: `motor5` is none of this drone's 4 motors
what = 'lost'; where = 'motor1'; at_s = 31 | 5 | at_s: 31 is out of range, must be 0 to 30 s of the flight
what = 'lost'; where = 'motor1'; at_s = 20; for_s = 11 | 6 | for_s: 11 is out of range, must be 0 to 10 s
what = 'lost'; where = 'motor1'; at_s = nan | 5 | at_s: NaN is out of range
what = 'weak'; where = 'motor1'; at_s = 1 | 3 | what: `weak` needs a size, 0 to 1
what = 'weak'; where = 'motor1'; at_s = 1; size = 2 | 6 | size: 2 is out of range, must be 0 to 1
what = 'lost'; where = 'motor1'; at_s = 1; size = 1 | 6 | size: `lost` has no size
what = 'bias'; where = 'gyroscope'; at_s = 1; size = 1; unit = 'rad/s' | 7 | unit: `rad/s` is unknown here, must be one of: deg/s
what = 'held_low'; where = 'magnetometer_line'; at_s = 1 | 3 | what: `held_low` needs the emulated board
what = 'lost'; where = 'motor1'; at_s = 1; colour = 1 | 6 | unknown field `colour`
what = 'lost'; where = 'motor1' | 2 | missing field `at_s`
";

    #[test]
    fn what_no_flight_can_play_is_refused_with_its_line() {
        let rows = SENSELESS.trim().lines().map(|row| {
            let mut parts = row.split(" | ");
            [(); 3].map(|()| parts.next().unwrap())
        });
        for [lines, line, expected] in rows {
            let said = read(&entry(lines)).unwrap_err();
            assert!(said.to_string().contains(expected), "{lines}: {said}");
            assert_eq!(said.line, Some(line.parse().unwrap()), "{lines}: {said}");
        }
    }

    #[test]
    fn every_kind_has_an_effect_at_each_of_its_places() {
        for kind in KINDS {
            for place in kind.places {
                let size = kind.size.map_or(0.0, |size| size.range[1]);
                assert!(
                    (kind.effect)(place, size).is_some(),
                    "{} {place}",
                    kind.name
                );
            }
        }
    }
}
