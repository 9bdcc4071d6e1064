//! Every kind of fault, declared once.

use std::fmt::Write;

use chip_models::Sensor;
use emulated_board::{Disturbance, SensorLine};

use super::distortion::{Distortion, Elements};

/// A kind of fault, at places that it has.
#[derive(Debug)]
pub struct Kind {
    /// As scripts name it.
    pub name: &'static str,
    /// Where it may be.
    pub places: &'static [&'static str],
    /// What its size says; none where it has no size.
    pub size: Option<Size>,
    /// What happens.
    pub meaning: &'static str,
    /// The effect at a place, with a size.
    pub(super) effect: fn(&str, f64) -> Option<Effect>,
}

/// A number that says how bad a fault is.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Unit, empty where it has none.
    pub unit: &'static str,
    /// The least and the most.
    pub range: [f64; 2],
    /// The size at which, or near which, nothing is wrong.
    pub harmless: f64,
}

/// What a fault does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effect {
    /// A sensor delivers something else than it reads.
    Signal(Elements, Distortion),
    /// A motor, from 0, gives a share of its thrust.
    Motor(usize, f64),
    /// The battery holds a share of its charge at most.
    Charge(f64),
    /// The battery's inner resistance is so many times as large.
    Resistance(f64),
    /// The battery gives so many volts less.
    Sag(f64),
    /// What the ground station sends, or does not.
    Said(Said),
    /// A chip's supply dips: its registers are those of a start.
    BrownOut(Chip),
    /// A bit turns over: of the MPU6050's GYRO_CONFIG, of a die's threshold.
    FlippedBit(Chip, u8),
    /// A chip's clock is faster by a share.
    Rate(Chip, f64),
    /// No fit of a model succeeds.
    Unfit,
    /// The inertial sensor's bus, or an interrupt line.
    Bus(Disturbance),
}

/// A chip with registers of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chip {
    /// The MPU6050.
    Imu,
    /// A die with a clock of its own, by its place.
    Die(usize),
}

/// What becomes of the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Said {
    /// Nothing is sent.
    Silent,
    /// Neither setpoints nor goals are sent.
    NoSetpoints,
    /// The drone's place is not sent; goals are.
    NoPlaces,
    /// Each setpoint or goal is sent so many times.
    Storm(u32),
    /// Random bytes are sent too, so many a second.
    Garbage(u32),
}

const SENSORS: &[&str] = &[
    "gyroscope",
    "gyroscope.x",
    "gyroscope.y",
    "gyroscope.z",
    "imu_accelerometer",
    "imu_accelerometer.x",
    "imu_accelerometer.y",
    "imu_accelerometer.z",
    "accelerometer",
    "accelerometer.x",
    "accelerometer.y",
    "accelerometer.z",
    "magnetometer",
    "magnetometer.x",
    "magnetometer.y",
    "magnetometer.z",
];
const GYROSCOPE: &[&str] = &["gyroscope", "gyroscope.x", "gyroscope.y", "gyroscope.z"];
const ACCELEROMETERS: &[&str] = &[
    "imu_accelerometer",
    "imu_accelerometer.x",
    "imu_accelerometer.y",
    "imu_accelerometer.z",
    "accelerometer",
    "accelerometer.x",
    "accelerometer.y",
    "accelerometer.z",
];
const MAGNETOMETER: &[&str] = &[
    "magnetometer",
    "magnetometer.x",
    "magnetometer.y",
    "magnetometer.z",
];
const MOTORS: &[&str] = &[
    "motor1", "motor2", "motor3", "motor4", "motor5", "motor6", "motor7", "motor8",
];
const BATTERY: &[&str] = &["battery"];
const LINK: &[&str] = &["link"];
const CHIPS: &[&str] = &["imu", "accelerometer", "magnetometer"];
const MODELS: &[&str] = &["models"];
const BUS: &[&str] = &["imu_bus"];
const LINES: &[&str] = &["imu_line", "accelerometer_line", "magnetometer_line"];

const fn size(unit: &'static str, range: [f64; 2], harmless: f64) -> Option<Size> {
    Some(Size {
        unit,
        range,
        harmless,
    })
}

const fn kind(
    name: &'static str,
    places: &'static [&'static str],
    size: Option<Size>,
    meaning: &'static str,
    effect: fn(&str, f64) -> Option<Effect>,
) -> Kind {
    Kind {
        name,
        places,
        size,
        meaning,
        effect,
    }
}

const fn bias(places: &'static [&'static str], size: Option<Size>) -> Kind {
    kind(
        "bias",
        places,
        size,
        "is added to samples",
        |place, size| signal(place, Distortion::Bias(size)),
    )
}

/// All kinds; those of one name are at different places.
pub const KINDS: &[Kind] = &[
    kind(
        "stuck",
        SENSORS,
        None,
        "the newest sample repeats itself, bit by bit",
        |place, _| signal(place, Distortion::Stuck),
    ),
    kind("zero", SENSORS, None, "all samples are zero", |place, _| {
        signal(place, Distortion::Zero)
    }),
    kind(
        "garbage",
        SENSORS,
        None,
        "random samples over the whole range",
        |place, _| signal(place, Distortion::Garbage),
    ),
    kind(
        "saturated",
        SENSORS,
        None,
        "samples at the end of the range",
        |place, _| signal(place, Distortion::Saturated),
    ),
    kind(
        "scaled",
        SENSORS,
        size("", [-10.0, 10.0], 1.0),
        "samples are so many times as large",
        |place, size| signal(place, Distortion::Scaled(size)),
    ),
    bias(GYROSCOPE, size("deg/s", [-500.0, 500.0], 0.0)),
    bias(ACCELEROMETERS, size("g", [-4.0, 4.0], 0.0)),
    bias(MAGNETOMETER, size("gauss", [-10.0, 10.0], 0.0)),
    kind(
        "drift",
        GYROSCOPE,
        size("deg/s2", [-10.0, 10.0], 0.0),
        "a bias that grows by this each second",
        |place, size| signal(place, Distortion::Drift(size)),
    ),
    kind(
        "turned",
        &["magnetometer"],
        size("deg", [-180.0, 180.0], 0.0),
        "the field is turned about the drone's vertical",
        |place, size| signal(place, Distortion::Turned(size)),
    ),
    kind("lost", MOTORS, None, "the motor stands", |place, _| {
        motor(place, 0.0)
    }),
    kind(
        "weak",
        MOTORS,
        size("", [0.0, 1.0], 1.0),
        "the motor gives this share of its thrust",
        motor,
    ),
    kind(
        "charge",
        BATTERY,
        size("", [0.0, 1.0], 1.0),
        "this share of the charge is left",
        |_, size| Some(Effect::Charge(size)),
    ),
    kind(
        "resistance",
        BATTERY,
        size("", [1.0, 100.0], 1.0),
        "the inner resistance is so many times as large",
        |_, size| Some(Effect::Resistance(size)),
    ),
    kind(
        "sag",
        BATTERY,
        size("V", [0.0, 30.0], 0.0),
        "the battery gives so much less than its charge says",
        |_, size| Some(Effect::Sag(size)),
    ),
    kind(
        "silent",
        LINK,
        None,
        "the ground station sends nothing",
        |_, _| Some(Effect::Said(Said::Silent)),
    ),
    kind(
        "no_setpoints",
        LINK,
        None,
        "neither setpoints nor goals are sent",
        |_, _| Some(Effect::Said(Said::NoSetpoints)),
    ),
    kind(
        "no_places",
        LINK,
        None,
        "the drone's place is not sent, goals are",
        |_, _| Some(Effect::Said(Said::NoPlaces)),
    ),
    kind(
        "storm",
        LINK,
        size("", [2.0, 50.0], 2.0),
        "each setpoint or goal is sent so many times",
        |_, size| Some(Effect::Said(Said::Storm(size as u32))),
    ),
    kind(
        "garbage",
        LINK,
        size("B/s", [100.0, 80_000.0], 100.0),
        "random bytes between the frames",
        |_, size| Some(Effect::Said(Said::Garbage(size as u32))),
    ),
    kind(
        "brown_out",
        CHIPS,
        None,
        "the chip forgets its registers, once",
        |place, _| Some(Effect::BrownOut(chip(place)?)),
    ),
    kind(
        "flipped_bit",
        CHIPS,
        size("", [0.0, 7.0], 0.0),
        "this bit of the gyroscope's range, or of the threshold, turns over, once",
        |place, size| Some(Effect::FlippedBit(chip(place)?, size as u8)),
    ),
    kind(
        "rate",
        CHIPS,
        size("%", [-20.0, 20.0], 0.0),
        "the chip's clock is faster by this",
        |place, size| Some(Effect::Rate(chip(place)?, size * 1e-2)),
    ),
    kind(
        "unfit",
        MODELS,
        None,
        "no fit succeeds: native only",
        |_, _| Some(Effect::Unfit),
    ),
    kind(
        "no_acknowledge",
        BUS,
        None,
        "nobody acknowledges",
        |_, _| bus(Disturbance::NoAcknowledge),
    ),
    kind(
        "bus_error",
        BUS,
        None,
        "each byte ends with a bus error",
        |_, _| bus(Disturbance::BusError),
    ),
    kind(
        "arbitration_lost",
        BUS,
        None,
        "another master wins",
        |_, _| bus(Disturbance::ArbitrationLost),
    ),
    kind("data_held", BUS, None, "SDA is held low", |_, _| {
        bus(Disturbance::DataHeld)
    }),
    kind(
        "data_held_by_chip",
        BUS,
        size("clocks", [1.0, 100.0], 1.0),
        "the chip holds SDA until it has seen so many clocks",
        |_, size| bus(Disturbance::DataHeldByChip { clocks: size as u8 }),
    ),
    kind("clock_held", BUS, None, "SCL is held low", |_, _| {
        bus(Disturbance::ClockHeld)
    }),
    kind(
        "stretched",
        BUS,
        size("%", [100.0, 1000.0], 100.0),
        "all takes so much of its time",
        |_, size| {
            bus(Disturbance::Stretched {
                percent: size as u32,
            })
        },
    ),
    kind(
        "dma_late",
        BUS,
        size("us", [1.0, 10_000.0], 1.0),
        "flags of the DMA come late by this",
        |_, size| {
            bus(Disturbance::DmaLate {
                by_ns: (size * 1e3) as u64,
            })
        },
    ),
    kind("dma_error", BUS, None, "the DMA's accesses fail", |_, _| {
        bus(Disturbance::DmaError)
    }),
    kind(
        "held_high",
        LINES,
        None,
        "the interrupt line is stuck at 1",
        |place, _| {
            bus(Disturbance::LineHeld {
                line: line(place)?,
                high: true,
            })
        },
    ),
    kind(
        "held_low",
        LINES,
        None,
        "the interrupt line is stuck at 0",
        |place, _| {
            bus(Disturbance::LineHeld {
                line: line(place)?,
                high: false,
            })
        },
    ),
    kind(
        "deaf",
        LINES,
        size("%", [0.0, 100.0], 0.0),
        "edges are lost, or come late, in this share of milliseconds",
        |place, size| {
            bus(Disturbance::LineDeaf {
                line: line(place)?,
                percent: size as u32,
            })
        },
    ),
    kind(
        "storm",
        LINES,
        size("Hz", [1.0, 50_000.0], 1.0),
        "the interrupt line picks up a square wave",
        |place, size| {
            bus(Disturbance::LineStorm {
                line: line(place)?,
                period_ns: (1e9 / size) as u64,
            })
        },
    ),
];

impl Effect {
    /// Only the emulated board can play it.
    #[must_use]
    pub fn needs_emulator(self) -> bool {
        match self {
            Self::Bus(Disturbance::NoAcknowledge) => false,
            Self::Bus(Disturbance::LineHeld { line, .. }) => line != SensorLine::ImuReady,
            Self::Bus(_) => true,
            _ => false,
        }
    }

    /// Only the native tier can: firmware fits its models by itself.
    #[must_use]
    pub fn needs_native(self) -> bool {
        self == Self::Unfit
    }

    /// It acts on the body of a drone.
    #[must_use]
    pub fn needs_drone(self) -> bool {
        matches!(
            self,
            Self::Motor(..) | Self::Charge(_) | Self::Resistance(_)
        )
    }
}

fn signal(place: &str, how: Distortion) -> Option<Effect> {
    let (name, axis) = place.split_once('.').unwrap_or((place, ""));
    let of = match name {
        "gyroscope" => Sensor::Gyroscope,
        "imu_accelerometer" => Sensor::ImuAccelerometer,
        "accelerometer" => Sensor::Accelerometer,
        _ => Sensor::Magnetometer,
    };
    let axes = ["x", "y", "z"].map(|name| axis.is_empty() || axis == name);
    Some(Effect::Signal(Elements { of, axes }, how))
}

fn motor(place: &str, share: f64) -> Option<Effect> {
    let index = MOTORS.iter().position(|motor| *motor == place)?;
    Some(Effect::Motor(index, share))
}

fn chip(place: &str) -> Option<Chip> {
    let place = CHIPS.iter().position(|chip| *chip == place)?;
    Some(place.checked_sub(1).map_or(Chip::Imu, Chip::Die))
}

fn line(place: &str) -> Option<SensorLine> {
    let place = LINES.iter().position(|line| *line == place)?;
    SensorLine::ALL.get(place).copied()
}

fn bus(what: Disturbance) -> Option<Effect> {
    Some(Effect::Bus(what))
}

/// Every kind with its places and its size, a row each of a table.
#[must_use]
pub fn list() -> String {
    let mut text = "| what | where | size | meaning |\n|---|---|---|---|\n".to_owned();
    for kind in KINDS {
        let size = kind.size.map_or("-".to_owned(), |size| size.to_string());
        let places = kind.places.iter().filter(|place| !place.contains('.'));
        let names: Vec<&str> = places.copied().collect();
        let axes = if names.len() < kind.places.len() {
            ", or one axis (`.x`)"
        } else {
            ""
        };
        let _ = writeln!(
            text,
            "| `{}` | {}{axes} | {size} | {} |",
            kind.name,
            names.join(", "),
            kind.meaning
        );
    }
    text
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [least, most] = self.range;
        write!(
            f,
            "{}",
            format!("{least} to {most} {}", self.unit).trim_end()
        )
    }
}
