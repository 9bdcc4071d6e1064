//! `reactive.toml`: when control runs, and how it learns when to.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, Error, Visitor};

use crate::document::Document;
use crate::{Board, ConfigError, Fallback, range};

/// The longest hyperperiod, in us: control at 50 Hz, the slowest that a quadrotor flies well with.
const LONGEST_HYPERPERIOD_US: u64 = 20_000;

/// The content of `reactive.toml`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reactive {
    /// When control runs.
    pub runs: Runs,
    /// How long control runs at every sample to learn.
    pub warm_up: WarmUp,
    /// How models follow what they see.
    pub learning: Learning,
    /// When reactive control is left.
    pub fallback: Fallback,
    /// What the sensors may ask for.
    pub inputs: Inputs,
    /// What a continuous setpoint must move by to force a run.
    pub setpoint: Setpoint,
}

/// When control runs.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Runs {
    /// Which policy decides.
    pub policy: Policy,
    /// Rate of the periodic policy in Hz, 1 to 1000.
    #[serde(deserialize_with = "range::control_rate")]
    pub periodic_rate_hz: f64,
    /// What a change is measured against.
    pub reference: Reference,
    /// Probability of a changed command that calls for a run, within (0, 1).
    #[serde(deserialize_with = "range::probability")]
    pub p_run: f64,
    /// Longest time between runs in s, above two hyperperiods, at most 1.
    #[serde(deserialize_with = "range::failsafe")]
    pub failsafe_s: f64,
    /// Steps in full scale, one of which counts as a change, 2 to 65535.
    #[serde(deserialize_with = "range::steps")]
    pub quantum_steps: u32,
}

/// Which policy decides when control runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Policy {
    /// When a sensor's change calls for it.
    Reactive,
    /// Time-triggered.
    Periodic,
}

/// What a change is measured against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reference {
    /// The sample before.
    PreviousSample,
    /// The sample that the last run used.
    LastRun,
}

/// How long control runs at every sample to learn.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WarmUp {
    /// How its end is decided.
    pub length: WarmUpLength,
    /// How often control runs meanwhile, in Hz.
    #[serde(deserialize_with = "range::warm_up_rate")]
    pub rate_hz: f64,
    /// Which pairs of samples and commands become labels.
    pub pairs: Pairs,
    /// The least an automatic warm-up lasts, in s.
    #[serde(deserialize_with = "range::warm_up")]
    pub shortest_s: f64,
    /// The most any warm-up lasts, in s, at most 30.
    #[serde(deserialize_with = "range::longest_warm_up")]
    pub longest_s: f64,
    /// Labels of each class that a model needs, 1 to 10000.
    #[serde(deserialize_with = "range::labels")]
    pub labels_of_each_class: u32,
    /// How far from `P_run` a refit may see the old threshold while it counts as stable, (0, 1].
    #[serde(deserialize_with = "range::positive_share")]
    pub stable_change: f64,
}

/// Which pairs of samples and commands become labels in the warm-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pairs {
    /// Shadow holds end at the first crossing of a candidate threshold.
    FirstCrossings,
    /// Pairs at several lags, each weighted by its inverse.
    WeightedLags,
    /// Consecutive samples, as published.
    Published,
}

/// Which runs become labels in reactive control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Feedback {
    /// Every run that one input alone asked for, failsafe and exploration runs.
    Every,
    /// False positives and failsafe runs that changed a command, as published.
    Published,
}

/// How the end of the warm-up is decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WarmUpLength {
    /// By the state of the models.
    Automatic,
    /// After this many seconds.
    Seconds(f64),
}

impl<'de> Deserialize<'de> for WarmUpLength {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        source.deserialize_any(WarmUpLengthVisitor)
    }
}

struct WarmUpLengthVisitor;

impl Visitor<'_> for WarmUpLengthVisitor {
    type Value = WarmUpLength;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"automatic\" or a time of 0 to 30 s")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<WarmUpLength, E> {
        if word == "automatic" {
            Ok(WarmUpLength::Automatic)
        } else {
            Err(E::invalid_value(serde::de::Unexpected::Str(word), &self))
        }
    }

    fn visit_f64<E: Error>(self, seconds: f64) -> Result<WarmUpLength, E> {
        if (0.0..=30.0).contains(&seconds) {
            Ok(WarmUpLength::Seconds(seconds))
        } else {
            Err(E::invalid_value(
                serde::de::Unexpected::Float(seconds),
                &self,
            ))
        }
    }

    fn visit_i64<E: Error>(self, seconds: i64) -> Result<WarmUpLength, E> {
        self.visit_f64(seconds as f64)
    }
}

/// How models follow what they see.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learning {
    /// Time constant with which old labels are forgotten, in s, 1 to 3600.
    #[serde(deserialize_with = "range::forgetting")]
    pub forgetting_s: f64,
    /// Time between refits in s, 0.05 to 60.
    #[serde(deserialize_with = "range::refit_interval")]
    pub refit_interval_s: f64,
    /// Probability of an exploration run in a hyperperiod, 0 to 0.1.
    #[serde(deserialize_with = "range::exploration_share")]
    pub exploration_share: f64,
    /// Most that one exploration label may weigh, 1 to 256.
    #[serde(deserialize_with = "range::weight")]
    pub exploration_weight_cap: f64,
    /// Seed of the exploration runs.
    pub exploration_seed: u32,
    /// Which runs become labels.
    pub feedback: Feedback,
}

/// What the sensors may ask for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inputs {
    /// The MPU6050's gyro, changes in rad/s.
    pub gyro: Input,
    /// The MPU6050's accelerometer, changes in m/s2.
    pub accel: Input,
    /// The LSM303AGR's accelerometer, changes in m/s2.
    pub chip_accel: Input,
    /// The LSM303AGR's magnetometer, changes in gauss.
    pub chip_mag: Input,
    /// The angle turned since the last run, changes in rad.
    pub turned: DerivedInput,
    /// The change of the command that a run would make, changes in quanta.
    pub command: DerivedInput,
}

/// What an input that is computed at every gating sample may ask for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DerivedInput {
    /// Its model may ask for a run.
    pub triggers: bool,
    /// Lower end of the bins of its changes, in its unit.
    #[serde(deserialize_with = "range::change")]
    pub smallest_change: f64,
    /// Upper end of the bins of its changes, in its unit.
    #[serde(deserialize_with = "range::change")]
    pub largest_change: f64,
}

/// What one sensor may ask for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Its period enters the hyperperiod.
    pub gates: bool,
    /// Its model may ask for a run.
    pub triggers: bool,
    /// Lower end of the bins of its changes, in the sensor's unit.
    #[serde(deserialize_with = "range::change")]
    pub smallest_change: f64,
    /// Upper end of the bins of its changes, in the sensor's unit.
    #[serde(deserialize_with = "range::change")]
    pub largest_change: f64,
}

/// What a continuous setpoint must move by to force a run.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setpoint {
    /// Of an attitude, in rad, within (0, 1].
    #[serde(deserialize_with = "range::angle_quantum")]
    pub angle_quantum_rad: f64,
    /// Of a body rate, in rad/s, within (0, 10].
    #[serde(deserialize_with = "range::rate_quantum")]
    pub rate_quantum_rad_s: f64,
    /// Of a place to fly to, in m, within (0, 10].
    #[serde(deserialize_with = "range::position_quantum")]
    pub position_quantum_m: f64,
    /// Steps in full thrust, one of which counts, 2 to 65535.
    #[serde(deserialize_with = "range::steps")]
    pub thrust_steps: u32,
}

impl Reactive {
    /// What only several values together can show.
    pub(crate) fn check(&self, document: &Document, board: &Board) -> Result<(), ConfigError> {
        let warm_up = &self.warm_up;
        if warm_up.shortest_s > warm_up.longest_s {
            let message = format!("must be 0 to longest_s, {} s", warm_up.longest_s);
            return Err(document.error_at(&["warm_up", "shortest_s"], message));
        }
        if matches!(warm_up.length, WarmUpLength::Seconds(s) if s > warm_up.longest_s) {
            let message = format!("must be 0 to longest_s, {} s", warm_up.longest_s);
            return Err(document.error_at(&["warm_up", "length"], message));
        }
        for (name, smallest, largest) in self.inputs.changes(board) {
            if smallest >= largest {
                let message = format!("must be below largest_change, {largest}");
                return Err(document.error_at(&["inputs", name, "smallest_change"], message));
            }
        }
        if self
            .inputs
            .with_rates(board)
            .iter()
            .all(|(_, input, _)| !input.gates)
        {
            return Err(document.error_at(&["inputs"], "at least one must have gates = true"));
        }
        self.check_hyperperiod(document, board)?;
        let shortest = 2e-6 * self.hyperperiod_us(board) as f64;
        if self.runs.failsafe_s <= shortest {
            let message = format!("must be above 2 hyperperiods, {shortest} s, and at most 1 s");
            return Err(document.error_at(&["runs", "failsafe_s"], message));
        }
        let fastest = 1e6 / self.hyperperiod_us(board) as f64;
        if self.runs.periodic_rate_hz > fastest {
            let message = format!("must be 1 Hz to one run per hyperperiod, {fastest} Hz");
            return Err(document.error_at(&["runs", "periodic_rate_hz"], message));
        }
        Ok(())
    }

    /// Rates that have little in common make hyperperiods that no drone can wait for.
    fn check_hyperperiod(&self, document: &Document, board: &Board) -> Result<(), ConfigError> {
        let hyperperiod = self.hyperperiod_us(board);
        if hyperperiod <= LONGEST_HYPERPERIOD_US {
            return Ok(());
        }
        let gates = self.inputs.with_rates(board);
        let gates = gates.iter().filter(|(_, input, _)| input.gates);
        let slowest = gates.clone().min_by_key(|(_, _, rate)| *rate);
        let rates: Vec<String> = gates
            .map(|(name, _, rate)| format!("{name} {rate} Hz"))
            .collect();
        let message = format!(
            "{} have a hyperperiod of {} ms, at most {} ms: let one trigger without gating",
            rates.join(", "),
            hyperperiod as f64 / 1e3,
            LONGEST_HYPERPERIOD_US / 1000
        );
        let name = slowest.map_or("gyro", |(name, _, _)| name);
        Err(document.error_at(&["inputs", name, "gates"], message))
    }

    /// Least common multiple of the gating inputs' periods, in us.
    #[must_use]
    pub fn hyperperiod_us(&self, board: &Board) -> u64 {
        self.inputs
            .with_rates(board)
            .iter()
            .filter(|(_, input, _)| input.gates)
            .map(|(_, _, rate)| 1_000_000 / u64::from(*rate))
            .fold(1, least_common_multiple)
    }
}

impl Inputs {
    /// One bit for each input whose model may ask for a run, in the firmware's order.
    pub(crate) fn triggers(&self) -> u8 {
        let each = [
            self.gyro.triggers,
            self.accel.triggers,
            self.chip_accel.triggers,
            self.chip_mag.triggers,
            self.turned.triggers,
            self.command.triggers,
        ];
        let bits = each.iter().zip(0..);
        bits.fold(0, |all, (triggers, bit)| all | u8::from(*triggers) << bit)
    }

    /// Every input's key and the ends of its changes.
    fn changes(&self, board: &Board) -> impl Iterator<Item = (&'static str, f64, f64)> {
        let sensed = self
            .with_rates(board)
            .map(|(name, input, _)| (name, input.smallest_change, input.largest_change));
        let derived = [("turned", &self.turned), ("command", &self.command)]
            .map(|(name, input)| (name, input.smallest_change, input.largest_change));
        sensed.into_iter().chain(derived)
    }

    /// Every input with its key and its rate in Hz on a board.
    #[must_use]
    pub fn with_rates(&self, board: &Board) -> [(&'static str, &Input, u32); 4] {
        let sensors = &board.sensors;
        [
            ("gyro", &self.gyro, sensors.imu_rate_hz),
            ("accel", &self.accel, sensors.imu_rate_hz),
            ("chip_accel", &self.chip_accel, sensors.chip_accel_rate_hz),
            ("chip_mag", &self.chip_mag, sensors.chip_mag_rate_hz),
        ]
    }
}

fn least_common_multiple(a: u64, b: u64) -> u64 {
    let (mut larger, mut smaller) = (a, b);
    while smaller != 0 {
        (larger, smaller) = (smaller, larger % smaller);
    }
    a / larger * b
}
