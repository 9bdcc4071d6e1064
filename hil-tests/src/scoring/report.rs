//! The JSON report of a replay: its score, and what the replay knows.

use super::Score;
use super::deviation::Deviation;
use super::latency::Quantiles;
use super::options::{described, named};
use super::periodic::Periodic;
use super::reason::ByReason;
use reflex::sensors::Inputs;
use reflex::settings::Settings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// The report, one flat JSON object.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Report {
    /// What was replayed, how, and on what.
    #[serde(flatten)]
    pub run: RunReport,
    /// How well control did.
    #[serde(flatten)]
    pub score: Score,
    /// The same flight again, natively, when no input that knows the command triggers; null where
    /// none did, and under periodic control.
    pub without_leading: Option<WithoutLeading>,
}

/// How well control does when sensors alone trigger.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct WithoutLeading {
    /// Inputs that triggered.
    pub triggers: Vec<String>,
    /// Runs after warm-up.
    pub runs: u64,
    /// Runs per second, those by exploration left out; null over no time.
    pub rate_hz: Option<f64>,
    /// How far it strayed.
    #[serde(flatten)]
    pub deviation: Deviation,
    /// A periodic autopilot with as many runs.
    pub periodic_equal: Periodic,
}

impl WithoutLeading {
    /// Of a replay that was scored, in which these inputs triggered.
    #[must_use]
    pub fn of(triggers: Inputs, score: &Score) -> Self {
        Self {
            triggers: triggers
                .iter()
                .map(|input| input.key().to_owned())
                .collect(),
            runs: score.section.control.runs,
            rate_hz: score.section.control.rate_hz,
            deviation: score.section.actuators.deviation,
            periodic_equal: score.periodic_equal,
        }
    }
}

/// What was replayed, how, and on what; and what the board showed.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RunReport {
    /// The log's path as it was given.
    pub log: String,
    /// Where the autopilot ran: `emulated` or `native`.
    pub tier: Tier,
    /// `reactive` or `periodic`.
    pub policy: String,
    /// Seed of noise, oscillators and exploration.
    pub seed: u64,
    /// Every option in effect, defaults included.
    pub options: Options,
    /// Which part of the log was replayed.
    pub part: FlightPart,
    /// Where the setpoint came from.
    pub setpoint: SetpointSource,
    /// Gaps in the log's samples; what is longer than a failsafe period is not scored.
    pub gaps: Vec<Gap>,
    /// What of the log could not be used, and what else should be known of how it was read.
    pub notes: Vec<String>,
    /// When the firmware disarmed its motors, in s of the board's time; the score ends 2 s earlier.
    /// Null where it did not.
    pub disarmed_s: Option<f64>,
    /// Sizes of the firmware that was replayed; null in the native tier, which runs none.
    pub firmware: Option<Firmware>,
    /// Every sensor, present in the log or not.
    pub sensors: Vec<Sensor>,
    /// Interrupt to motor register, by reason, after warm-up; null for a reason without a run.
    pub latency_us: ByReason<Option<Quantiles>>,
    /// What the latency of the runs that the gyro asked for is made of, in order; empty in the
    /// native tier.
    pub latency_parts_us: Vec<LatencyPart>,
    /// Load of the processor after warm-up; null in the native tier, which has none.
    pub cpu: Option<Cpu>,
    /// Times of the emulated board; null in the native tier.
    pub board: Option<BoardTime>,
    /// Everything that was counted by name: faults, dropped frames, fallbacks.
    pub counters: BTreeMap<String, u64>,
    /// SHA-256 over all motor writes with their times; in the native tier over the commands of
    /// all runs with their stamps.
    pub digest: String,
}

/// Where the autopilot runs.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Tier {
    /// An emulator that runs the firmware's ELF.
    Emulated,
    /// The host, around the autopilot alone.
    Native,
}

impl fmt::Display for Tier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Emulated => "emulated",
            Self::Native => "native",
        })
    }
}

/// Options in effect, in the spelling of the command line.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Options {
    /// Name of the control logic.
    pub logic: String,
    /// Gains of the control logic, if not those of its own file: a name or a file; else null.
    pub gains: Option<String>,
    /// The autopilot's settings.
    #[serde(flatten, serialize_with = "named")]
    #[schemars(schema_with = "described")]
    pub settings: Settings,
    /// Rotation from the log's axes to the board's.
    pub rotate: String,
    /// `datasheet` or `none`.
    pub noise: String,
    /// Seconds of the log that were replayed at most; null for all.
    pub duration_s: Option<f64>,
}

/// Where the setpoint of a replay came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SetpointSource {
    /// The log records it.
    Log,
    /// The log's own attitude and rates, low-passed at 1 Hz without delay.
    LowPassed,
}

impl SetpointSource {
    /// The source as a person reads it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Log => "as logged",
            Self::LowPassed => "from the log's own attitude and rates, low-passed",
        }
    }
}

/// A part of a log.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FlightPart {
    /// Start in seconds of the log.
    pub from_s: f64,
    /// End in seconds of the log.
    pub to_s: f64,
    /// Why this part.
    pub reason: String,
}

/// A stretch without samples in the log.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Gap {
    /// Start in seconds of the log.
    pub start_s: f64,
    /// Length in seconds.
    pub length_s: f64,
}

/// What the firmware takes of the chip.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Firmware {
    /// Bytes of flash.
    pub flash_bytes: u64,
    /// Bytes of `.data`, `.bss` and `.uninit`.
    pub ram_bytes: u64,
    /// High-water mark of the stack in bytes, measured in this replay.
    pub stack_bytes: u64,
}

/// The state of a sensor's model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ModelState {
    /// The log lacks the sensor.
    Absent,
    /// Not fitted yet.
    Learning,
    /// Fitted: it triggers past its threshold.
    Fit,
    /// It says no more than the gyro does: it joins and never triggers.
    Irrelevant,
    /// It could not be fitted: it triggers, bounded by the fallback.
    Unfit,
}

impl ModelState {
    /// The state as the report spells it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Absent => "absent",
            Self::Learning => "learning",
            Self::Fit => "fit",
            Self::Irrelevant => "irrelevant",
            Self::Unfit => "unfit",
        }
    }
}

/// One triggering input at the end of the replay.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Sensor {
    /// Name of the input, chip first.
    pub name: String,
    /// Whether the log has it; an absent sensor answers with a constant sample.
    pub present: bool,
    /// Samples that the chip produced.
    pub samples: u64,
    /// Interrupts that it raised.
    pub interrupts: u64,
    /// Samples that its chip kept to itself.
    pub spared: u64,
    /// Orders on its chip's bus after warm-up: to re-arm, to read, to check, to program.
    pub orders: u64,
    /// Runs that it asked for, alone or with others.
    pub triggers: u64,
    /// Those that it asked for first, or with the first.
    pub first: u64,
    /// Those that it alone asked for.
    pub alone: u64,
    /// Those of `alone` that were changed, as models learn it; the others were spent on nothing.
    pub rightly: u64,
    /// The state of its model.
    pub state: ModelState,
    /// The change above which it asks for a run, in `unit`; null without a model.
    pub threshold: Option<f64>,
    /// Unit of the threshold: `rad/s`, `m/s2`, `gauss`, `rad` or `quanta`.
    pub unit: String,
    /// Threshold code in the chip's registers at the end; null where the chip does not compare.
    pub chip_threshold: Option<u32>,
    /// Thresholds that the chip took and that were read back, in the whole replay.
    pub chip_thresholds_set: u64,
    /// Samples that the chip's own comparison announced.
    pub chip_crossings: u64,
    /// The model's `b1`; null without a model.
    pub b1: Option<f64>,
    /// The model's `b2`, per unit; null without a model.
    pub b2: Option<f64>,
}

/// One part of the way from the gyro's interrupt to the motor registers.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LatencyPart {
    /// What happens in it.
    pub part: String,
    /// How long it took, in microseconds; null without a run.
    pub micros: Option<Quantiles>,
    /// What exceptions that are entered and left in it take on silicon, in microseconds: to be added.
    pub exceptions_us: f64,
}

/// Load of the processor after warm-up.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Cpu {
    /// Share of time in which it did not sleep, its exceptions for nothing; null over no time.
    pub busy_fraction: Option<f64>,
    /// Exceptions entered a second; null over no time.
    pub exceptions_per_second: Option<f64>,
    /// Share of time with 22 cycles for each exception, as silicon takes them to enter and to leave.
    pub busy_with_exceptions: Option<f64>,
    /// Instructions of one run of the control logic, on average; null without a run.
    pub instructions_per_run: Option<f64>,
}

/// How long the board took, in its own time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct BoardTime {
    /// Virtual seconds that the board ran, start-up included.
    pub virtual_s: f64,
    /// Virtual seconds from reset to the first hyperperiod.
    pub start_up_s: f64,
}
