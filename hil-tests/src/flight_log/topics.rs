//! What a flight log tells, each topic declared once for every format.
//!
//! A row of a topic is a list of numbers, of which each field takes its own: formats differ in how they
//! spell a field, not in what it says.

use std::fmt::Debug;

use reflex::reactive::Reason;
use reflex::reset::Mode;
use reflex::safety::FlightState;
use reflex::sensors::{Cause, Input, Unit};

/// Motors that a command has room for, as PX4 counts them; those that are not there are no numbers.
pub(super) const MOST_MOTORS: usize = 12;

/// How a field's numbers are to be read.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    Number,
    /// No is 0, yes 1.
    Flag,
    /// One of these, by its place.
    Choice(Vec<String>),
    /// x, y, z.
    Vector,
    /// w, x, y, z.
    Quaternion,
    /// One number for each motor.
    Motors,
}

impl Kind {
    /// How many numbers of a row it takes.
    pub(super) fn width(&self) -> usize {
        match self {
            Self::Number | Self::Flag | Self::Choice(_) => 1,
            Self::Vector => 3,
            Self::Quaternion => 4,
            Self::Motors => MOST_MOTORS,
        }
    }
}

/// A field of a topic.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    /// Its name.
    pub(super) name: String,
    /// Its name in a ULog, where PX4 has one.
    pub(super) px4: Option<&'static str>,
    pub(super) kind: Kind,
    /// As in text; empty where it has none.
    pub(super) unit: &'static str,
}

impl Field {
    fn new(name: impl Into<String>, kind: Kind, unit: &'static str) -> Self {
        Self {
            name: name.into(),
            px4: None,
            kind,
            unit,
        }
    }

    /// The same, under a name of PX4's in a ULog.
    fn px4(self, name: &'static str) -> Self {
        Self {
            px4: Some(name),
            ..self
        }
    }

    /// Its name in a ULog.
    pub(super) fn ulog(&self) -> &str {
        self.px4.unwrap_or(&self.name)
    }
}

/// Declares the topics: name, name in a ULog, meaning.
macro_rules! topics {
    ($($(#[doc = $meaning:literal])+ $topic:ident $name:literal $ulog:literal,)*) => {
        /// A topic of a flight log.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Topic {
            $($(#[doc = $meaning])+ $topic,)*
        }

        impl Topic {
            /// All of them, in the order of their numbers.
            pub(super) const ALL: [Self; [$(Self::$topic),*].len()] = [$(Self::$topic),*];

            /// Its name, under which tools show it.
            pub(super) const fn name(self) -> &'static str {
                match self { $(Self::$topic => $name,)* }
            }

            /// Its name in a ULog: PX4's where PX4 has one.
            pub(super) const fn ulog(self) -> &'static str {
                match self { $(Self::$topic => $ulog,)* }
            }

            /// What it tells.
            pub(super) const fn meaning(self) -> &'static str {
                match self { $(Self::$topic => concat!($($meaning),+).trim_ascii(),)* }
            }
        }
    };
}

topics! {
    /// A sample of the inertial sensor, in the body's axes; the gyroscope's bias is not removed.
    Imu "sensors/imu" "sensor_combined",
    /// A sample of the other chip's accelerometer, and why it was fetched.
    Accelerometer "sensors/accelerometer" "sensor_accel",
    /// A sample of the magnetometer, and why it was fetched.
    Magnetometer "sensors/magnetometer" "sensor_mag",
    /// What the battery was measured to give.
    Battery "sensors/battery" "battery_status",
    /// A setpoint of the pilot; no attitude where only rates are asked for.
    Setpoint "setpoint" "vehicle_attitude_setpoint",
    /// A goal of the pilot; no heading where it is free.
    Goal "goal" "trajectory_setpoint",
    /// Where the tracker sees the drone, north, east, down.
    Place "place" "vehicle_local_position",
    /// The estimated attitude behind a run, from body to north, east, down.
    Attitude "attitude" "vehicle_attitude",
    /// A run's motor command, as shares of full scale.
    Command "command" "actuator_motors",
    /// Why control ran; of each input whether it asked, its change and what its model made of it.
    Decision "decision" "reflex_decision",
    /// Whether the last run was changed, as far as time has shown.
    Verdict "verdict" "reflex_verdict",
    /// A model that was fitted anew.
    Model "model" "reflex_model",
    /// The flight state and how control runs, where either is new.
    State "state" "vehicle_status",
    /// Whether the drone stands on the ground, where that is new.
    Landed "landed" "vehicle_land_detected",
    /// The true attitude of a simulated drone.
    TrueAttitude "truth/attitude" "vehicle_attitude_groundtruth",
    /// Where a simulated drone truly is.
    TruePlace "truth/place" "vehicle_local_position_groundtruth",
}

/// Names of the outcomes of a fit; a row holds the place in this list.
pub(super) const FITS: [&str; 3] = ["Unfit", "Irrelevant", "Model"];

impl Topic {
    /// The kinds of its fields.
    pub(super) fn kinds(self) -> Vec<Kind> {
        let fields = self.fields().into_iter();
        fields.map(|field| field.kind).collect()
    }

    /// Its fields, in the order of a row.
    pub(super) fn fields(self) -> Vec<Field> {
        use Kind::{Choice, Flag, Motors, Number, Quaternion, Vector};
        let new = |name: &str, kind, unit| Field::new(name, kind, unit);
        match self {
            Self::Imu => vec![
                new("gyroscope", Vector, "rad/s").px4("gyro_rad"),
                new("accelerometer", Vector, "m/s2").px4("accelerometer_m_s2"),
                new("temperature", Number, "degC"),
            ],
            Self::Accelerometer => of_chip("m/s2"),
            Self::Magnetometer => of_chip("gauss"),
            Self::Battery => vec![
                new("voltage", Number, "V").px4("voltage_v"),
                new("current", Number, "A").px4("current_a"),
            ],
            Self::Setpoint => vec![
                new("attitude", Quaternion, "").px4("q_d"),
                new("rates", Vector, "rad/s"),
                new("thrust", Number, "share"),
                new("holds_heading", Flag, ""),
            ],
            Self::Goal => vec![
                new("position", Vector, "m"),
                new("velocity", Vector, "m/s"),
                new("heading", Number, "rad").px4("yaw"),
            ],
            Self::Place => {
                let valid = ["xy_valid", "z_valid", "v_xy_valid", "v_z_valid"];
                let flags = valid.map(|name| new(name, Flag, ""));
                place().into_iter().chain(flags).collect()
            }
            Self::TruePlace => place(),
            Self::Attitude | Self::TrueAttitude => vec![
                new("q", Quaternion, ""),
                new("roll", Number, "rad"),
                new("pitch", Number, "rad"),
                new("yaw", Number, "rad"),
            ],
            Self::Command => vec![new("motors", Motors, "share").px4("control")],
            Self::Decision => decision(),
            Self::Verdict => vec![new("changed", Flag, "")],
            Self::Model => vec![
                new("input", Choice(names(Input::ALL.map(Input::name))), ""),
                new("fit", Choice(names(FITS)), ""),
                new("b1", Number, ""),
                new("b2", Number, ""),
                new("threshold", Number, ""),
            ],
            Self::State => vec![
                new("state", Choice(words(FlightState::ALL)), ""),
                new("mode", Choice(words(Mode::ALL)), ""),
                // PX4's numbers.
                new(
                    "arming_state",
                    Choice(names(["Init", "Disarmed", "Armed"])),
                    "",
                ),
            ],
            Self::Landed => vec![new("landed", Flag, "")],
        }
    }
}

/// A sample of a chip that compares.
fn of_chip(unit: &'static str) -> Vec<Field> {
    let axes = ["x", "y", "z"].map(|axis| Field::new(axis, Kind::Number, unit));
    let causes = (0..).map_while(Cause::from_number);
    let cause = Field::new("cause", Kind::Choice(words(causes)), "");
    axes.into_iter().chain([cause]).collect()
}

/// Position and velocity, as PX4 names them.
fn place() -> Vec<Field> {
    let position = ["x", "y", "z"].map(|axis| Field::new(axis, Kind::Number, "m"));
    let velocity = ["vx", "vy", "vz"].map(|axis| Field::new(axis, Kind::Number, "m/s"));
    position.into_iter().chain(velocity).collect()
}

fn decision() -> Vec<Field> {
    let mut fields = vec![
        Field::new("reason", Kind::Choice(words(Reason::ALL)), ""),
        Field::new("expected", Kind::Number, ""),
    ];
    for input in Input::ALL {
        let name = |what: &str| format!("{}_{what}", input.name());
        let unit = unit(input);
        fields.extend([
            Field::new(name("asked"), Kind::Flag, ""),
            Field::new(name("change"), Kind::Number, unit),
            Field::new(name("probability"), Kind::Number, ""),
            Field::new(name("threshold"), Kind::Number, unit),
        ]);
    }
    fields
}

/// The unit in which the firmware counts an input's changes.
fn unit(input: Input) -> &'static str {
    match input.declaration().unit {
        Unit::Named(unit) => unit,
        Unit::Quantum => "share",
        Unit::QuantumTime => "share s",
    }
}

fn names<const N: usize>(names: [&str; N]) -> Vec<String> {
    names.map(str::to_owned).to_vec()
}

/// Values of an enum, as they are called in the sources.
fn words<T: Debug>(values: impl IntoIterator<Item = T>) -> Vec<String> {
    let word = |value| format!("{value:?}");
    values.into_iter().map(word).collect()
}
