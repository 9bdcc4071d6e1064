//! The header of a Blackbox session: what its frames hold, and in which units.

use std::collections::HashMap;

use super::layout::{Encoding, Field, Layout, Predictor};

/// A session's header.
pub(super) struct Header {
    values: HashMap<String, String>,
    /// Of frames that stand by themselves.
    pub(super) intra: Layout,
    /// Of frames that hold differences.
    pub(super) inter: Layout,
    /// Of frames that are written now and then; their values are not used.
    pub(super) slow: Layout,
    pub(super) gps: Layout,
    pub(super) home: Layout,
    /// Which field is the loop's number.
    pub(super) iteration: usize,
    /// Which is the time, us.
    pub(super) time: usize,
    /// Loops between frames that stand by themselves.
    intra_interval: i64,
    /// Of so many loops, so many are logged.
    inter_interval: (i64, i64),
}

/// More fields, or longer intervals, no firmware writes.
const MOST_FIELDS: usize = 256;
const LONGEST_INTERVAL: i64 = 1 << 16;

impl Header {
    /// Reads the header at the start of a session; also what follows it.
    pub(super) fn read(session: &[u8]) -> Result<(Self, &[u8]), String> {
        let mut rest = session;
        let mut values = HashMap::new();
        while let Some(line) = rest.strip_prefix(b"H ") {
            let Some(end) = line.iter().position(|&byte| byte == b'\n') else {
                return Err("is cut off within its header".to_owned());
            };
            let text = String::from_utf8_lossy(&line[..end]);
            if let Some((key, value)) = text.split_once(':') {
                values.insert(key.trim().to_owned(), value.trim().to_owned());
            }
            rest = &line[end + 1..];
        }
        Ok((Self::of(values)?, rest))
    }

    fn of(values: HashMap<String, String>) -> Result<Self, String> {
        let number = |key: &str| values.get(key).and_then(|text| text.parse::<i64>().ok());
        if number("Data version") != Some(2) {
            let version = values.get("Data version").map_or("none", String::as_str);
            return Err(format!(
                "has data version {version}, and 2 is read: convert it by blackbox_decode"
            ));
        }
        let constants = Constants {
            min_throttle: number("minthrottle").unwrap_or(1150),
            min_motor: ends(&values).map_or(1000, |[low, _]| low as i64),
            battery: number("vbatref").unwrap_or(4095),
        };
        let intra = layout(&values, "I", "I", &constants)?;
        let find = |name: &str| {
            let found = intra.fields.iter().position(|field| field.name == name);
            found.ok_or_else(|| format!("has no field {name} in its header"))
        };
        let (iteration, time) = (find("loopIteration")?, find("time")?);
        Ok(Self {
            inter: layout(&values, "P", "I", &constants)?,
            slow: layout(&values, "S", "S", &constants).unwrap_or_default(),
            gps: layout(&values, "G", "G", &constants).unwrap_or_default(),
            home: layout(&values, "H", "H", &constants).unwrap_or_default(),
            iteration,
            time,
            intra_interval: number("I interval").unwrap_or(1).clamp(1, LONGEST_INTERVAL),
            inter_interval: inter_interval(values.get("P interval")),
            intra,
            values,
        })
    }

    /// Where a field of the main frames is.
    pub(super) fn field(&self, name: &str) -> Option<usize> {
        let mut fields = self.intra.fields.iter();
        fields.position(|field| field.name == name)
    }

    /// How many loops were left out of the log on purpose behind this one.
    pub(super) fn left_out_behind(&self, iteration: i64) -> i64 {
        let (logged, of) = self.inter_interval;
        let is_logged = |loop_number: i64| {
            let within = loop_number.rem_euclid(self.intra_interval);
            (within + logged - 1).rem_euclid(of) < logged
        };
        let behind = iteration.wrapping_add(1)..;
        let found = behind.take(self.intra_interval as usize + 1);
        found
            .take_while(|&loop_number| !is_logged(loop_number))
            .count() as i64
    }

    /// rad/s of one count of the gyroscope.
    pub(super) fn gyro_unit(&self) -> f64 {
        let text = self
            .first_of(["gyro_scale", "gyro.scale"])
            .unwrap_or_default();
        let bits = u32::from_str_radix(text.trim_start_matches("0x"), 16).ok();
        let scale = bits.map(|bits| f64::from(f32::from_bits(bits)));
        let scale = scale
            .filter(|scale| scale.is_normal() && *scale > 0.0)
            .unwrap_or(1.0);
        match self.values.contains_key("Firmware type") {
            true => scale.to_radians(),
            // Baseflight, before all others, counts rad/us.
            false => scale * 1e6,
        }
    }

    /// Counts of the accelerometer at 1 g.
    pub(super) fn counts_of_1_g(&self) -> f64 {
        let text = self.first_of(["acc_1G", "acc.acc_1G", "acc_1g"]);
        let counts = text.and_then(|text| text.parse().ok());
        counts.filter(|counts| *counts >= 1.0).unwrap_or(2048.0)
    }

    /// Motor commands at no thrust and at full thrust.
    pub(super) fn motor_ends(&self) -> [f64; 2] {
        ends(&self.values).unwrap_or([1000.0, 2000.0])
    }

    /// Firmware, board and name.
    pub(super) fn description(&self) -> String {
        let keys = ["Firmware revision", "Board information", "Craft name"];
        let known = keys.iter().filter_map(|key| self.values.get(*key));
        let known: Vec<&str> = known
            .map(String::as_str)
            .filter(|text| !text.is_empty())
            .collect();
        known.join(", ")
    }

    fn first_of<const N: usize>(&self, keys: [&str; N]) -> Option<&str> {
        keys.iter()
            .find_map(|key| self.values.get(*key))
            .map(String::as_str)
    }
}

/// What predictors add that the header says.
struct Constants {
    min_throttle: i64,
    min_motor: i64,
    battery: i64,
}

/// The two ends of the motor commands.
fn ends(values: &HashMap<String, String>) -> Option<[f64; 2]> {
    let (low, high) = values.get("motorOutput")?.split_once(',')?;
    let (low, high) = (low.trim().parse().ok()?, high.trim().parse().ok()?);
    (low < high).then_some([low, high])
}

/// How many of how many loops are logged, as `1/8` or `8`.
fn inter_interval(text: Option<&String>) -> (i64, i64) {
    let text = text.map_or("1/1", String::as_str);
    let (logged, of) = text.split_once('/').unwrap_or(("1", text));
    let whole = |text: &str| text.trim().parse().unwrap_or(1).clamp(1, LONGEST_INTERVAL);
    let (logged, of): (i64, i64) = (whole(logged), whole(of));
    (logged.min(of), of)
}

/// The layout of a kind of frames; `named` is the kind that says the fields' names.
fn layout(
    values: &HashMap<String, String>,
    kind: &str,
    named: &str,
    constants: &Constants,
) -> Result<Layout, String> {
    let list = |kind: &str, what: &str| -> Result<Vec<&str>, String> {
        let key = format!("Field {kind} {what}");
        let text = values
            .get(&key)
            .ok_or_else(|| format!("has no line '{key}' in its header"))?;
        let list: Vec<&str> = text.split(',').map(str::trim).collect();
        match list.len() <= MOST_FIELDS {
            true => Ok(list),
            false => Err(format!(
                "has {} fields in its header, at most {MOST_FIELDS} are read",
                list.len()
            )),
        }
    };
    let (names, signs) = (list(named, "name")?, list(named, "signed")?);
    let (encodings, predictors) = (list(kind, "encoding")?, list(kind, "predictor")?);
    if [signs.len(), encodings.len(), predictors.len()] != [names.len(); 3] {
        return Err(format!(
            "has lists of different lengths for its {kind} fields"
        ));
    }
    let motor_0 = names.iter().position(|name| *name == "motor[0]");
    let fields = names
        .iter()
        .zip(signs)
        .zip(encodings.iter().zip(predictors));
    let fields = fields.map(|((name, signed), (encoding, predictor))| {
        let unknown =
            |what: &str, code: &str| format!("has an unknown {what} {code} for its field {name}");
        Ok(Field {
            name: (*name).to_owned(),
            is_signed: signed == "1",
            encoding: Encoding::of(encoding).ok_or_else(|| unknown("encoding", encoding))?,
            predictor: match predictor {
                "0" | "7" | "10" => Predictor::Constant(0),
                "1" => Predictor::Previous,
                "2" => Predictor::StraightLine,
                "3" => Predictor::Average,
                "4" => Predictor::Constant(constants.min_throttle),
                "5" => Predictor::Field(motor_0.ok_or_else(|| unknown("motor", "0"))?),
                "6" => Predictor::Increment,
                "8" => Predictor::Constant(1500),
                "9" => Predictor::Constant(constants.battery),
                "11" => Predictor::Constant(constants.min_motor),
                code => return Err(unknown("predictor", code)),
            },
        })
    });
    Ok(Layout {
        fields: fields.collect::<Result<_, String>>()?,
    })
}
