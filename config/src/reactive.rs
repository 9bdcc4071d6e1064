//! `reactive.toml`: when control runs, and how it learns when to.

use reflex_settings::{
    Declared, Input, Inputs, Kind, Limits, REACTIVE, Settings, Value, micros, of_input,
};

use crate::ConfigError;
use crate::document::Document;
use crate::values::{Schema, Values, schema};

/// The longest hyperperiod, in us: control at 50 Hz, the slowest that a quadrotor flies well with.
const LONGEST_HYPERPERIOD_US: u64 = 20_000;

/// What `reactive.toml` holds.
pub(crate) fn file() -> Schema {
    let chosen = Settings::SETTINGS.iter();
    let chosen = chosen.filter(|setting| !setting.of_board && setting.kind != Kind::Inputs);
    let mut file = schema(chosen.chain(REACTIVE));
    for input in Input::ALL {
        let settings = of_input(input);
        file.extend(settings.map(|setting| (key_of(input, setting.key), setting)));
    }
    file
}

/// The full key of what an input has.
pub(crate) fn key_of(input: Input, key: &str) -> String {
    format!("inputs.{}.{key}", table_of(input))
}

/// The name of an input's table.
fn table_of(input: Input) -> String {
    input.key().replace('-', "_")
}

/// `reactive.toml` and the board's file together.
#[derive(Clone, Copy)]
pub(crate) struct Files<'v> {
    pub reactive: &'v Values,
    pub board: &'v Values,
}

impl Files<'_> {
    /// The run-time settings.
    pub(crate) fn settings(self) -> Option<Settings> {
        Settings::collect(&mut |setting| match setting.kind {
            Kind::Inputs => Some(Value::Inputs(self.triggers())),
            _ => {
                let path = setting.path().to_string();
                self.reactive.at(&path).or_else(|| self.board.at(&path))
            }
        })
    }

    fn triggers(self) -> Inputs {
        let inputs = Input::ALL.into_iter();
        inputs
            .filter(|input| self.flag(*input, "triggers"))
            .collect()
    }

    fn flag(self, input: Input, key: &str) -> bool {
        self.reactive.at(&key_of(input, key)) == Some(Value::Flag(true))
    }

    /// An input's period enters the hyperperiod.
    pub(crate) fn gates(self, input: Input) -> bool {
        self.flag(input, "gates")
    }

    /// The ends of the bins of an input's changes.
    pub(crate) fn changes(self, input: Input) -> [f64; 2] {
        ["smallest_change", "largest_change"].map(|key| self.reactive.number(&key_of(input, key)))
    }

    /// The rate of a sensor in Hz.
    pub(crate) fn rate(self, input: Input) -> u32 {
        let rate = input.declaration().rate;
        rate.map_or(0, |rate| {
            self.board.number(&format!("sensors.{}", rate.key)) as u32
        })
    }

    /// Least common multiple of the gating inputs' periods, in us.
    pub(crate) fn hyperperiod_us(self) -> u64 {
        let gating = Input::SENSED.into_iter().filter(|input| self.gates(*input));
        let periods = gating.map(|input| 1_000_000 / u64::from(self.rate(input).max(1)));
        periods.fold(1, least_common_multiple)
    }

    /// What limits values beyond their ranges.
    pub(crate) fn limits(self) -> Limits {
        let longest = self.reactive.number("warm_up.longest_s") * 1e6;
        Limits {
            hyperperiod: micros(self.hyperperiod_us()),
            longest_warm_up: micros(longest.round() as u64),
            imu_rate_hz: self.rate(Input::Gyro),
        }
    }

    /// What only several values together can show.
    pub(crate) fn check(self, reactive: &Document, board: &Document) -> Result<(), ConfigError> {
        for input in Input::ALL {
            let [smallest, largest] = self.changes(input);
            if smallest >= largest {
                let message = format!("must be below largest_change, {largest}");
                return Err(reactive.error_at(&key_of(input, "smallest_change"), message));
            }
        }
        if !Input::SENSED.iter().any(|input| self.gates(*input)) {
            return Err(reactive.error_at("inputs", "at least one must have gates = true"));
        }
        self.check_hyperperiod(reactive)?;
        let limits = self.limits();
        board.check(self.board, &limits)?;
        reactive.check(self.reactive, &limits)?;
        let triggers = Settings::SETTINGS.iter().find(|it| it.kind == Kind::Inputs);
        triggers
            .map_or(Ok(()), |it| it.check(Value::Inputs(self.triggers()), None))
            .map_err(|refusal| reactive.error_at("inputs", refusal.to_string()))
    }

    /// Rates that have little in common make hyperperiods that no drone can wait for.
    fn check_hyperperiod(self, document: &Document) -> Result<(), ConfigError> {
        let hyperperiod = self.hyperperiod_us();
        if hyperperiod <= LONGEST_HYPERPERIOD_US {
            return Ok(());
        }
        let gates = Input::SENSED.into_iter().filter(|input| self.gates(*input));
        let slowest = gates.clone().min_by_key(|input| self.rate(*input));
        let rates: Vec<String> = gates
            .map(|input| format!("{} {} Hz", table_of(input), self.rate(input)))
            .collect();
        let message = format!(
            "{} have a hyperperiod of {} ms, at most {} ms: let one trigger without gating",
            rates.join(", "),
            hyperperiod as f64 / 1e3,
            LONGEST_HYPERPERIOD_US / 1000
        );
        let input = slowest.unwrap_or(Input::Gyro);
        Err(document.error_at(&key_of(input, "gates"), message))
    }
}

fn least_common_multiple(a: u64, b: u64) -> u64 {
    let (mut larger, mut smaller) = (a, b);
    while smaller != 0 {
        (larger, smaller) = (smaller, larger % smaller);
    }
    a / larger * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn inputs_are_configured_as_they_are_declared_to_be_shipped() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let configuration = crate::load(folder).expect("the shipped configuration");
        let files = configuration.files();
        for input in Input::ALL {
            let declared = input.declaration();
            assert_eq!(files.gates(input), declared.gates, "{input:?}");
            assert_eq!(files.changes(input), declared.changes, "{input:?}");
        }
    }
}
