//! Numbers of a simulated flight, declared as the autopilot's settings are.

use reflex_settings::{
    HARD_IRON, Kind, MOTOR_FIELD, Range, SOFT_IRON_DIAGONAL, SOFT_IRON_OFF_DIAGONAL, Setting,
    TURN_ON, Value, WARMING, above, within,
};

use super::declared_options::{Declarations, Given, refused};
use crate::refusal::Refusal;

pub(super) const BANDWIDTH: &Setting = &number(
    ["bandwidth", "FACTOR"],
    (Kind::Number(within(0.25, 5.0)), ""),
    "1",
    "How many times as fast as configured attitude and rate loops are",
);
pub(super) const DURATION: &Setting = &number(
    ["duration", "SECONDS"],
    (Kind::Number(above(0.0, 86_400.0)), "s"),
    "60",
    "From take-off to the end",
);
// Below, start-up waits for sensors until after take-off: it counts that time in instructions.
pub(super) const CLOCK: &Setting = &number(
    ["clock-mhz", "MHZ"],
    (Kind::Count(within(36.0, 672.0)), "MHz"),
    "168",
    "Speed of the emulated core; buses and timers keep theirs",
);
pub(super) const PLANT_GAIN: &Setting = &number(
    ["plant-gain", "FACTOR"],
    (Kind::Number(within(0.1, 10.0)), ""),
    "1",
    "Stress: how many times as much the drone answers its motors",
);
pub(super) const PLANT_DELAY: &Setting = &number(
    ["plant-delay", "SECONDS"],
    (Kind::Number(within(0.0, 0.2)), "s"),
    "0",
    "Stress: how much later motor commands apply",
);

pub(super) const GYRO_BIAS: &Setting = &number(
    ["gyro-bias", "DEG_S"],
    (Kind::Number(TURN_ON), "deg/s"),
    OF_VEHICLE,
    "Sensor: most that an axis of the gyroscope shows at rest when it is turned on, by the seed",
);
pub(super) const WARM_UP: &Setting = &number(
    ["die-warms", "DEGREES"],
    (Kind::Number(WARMING), "degrees Celsius"),
    OF_VEHICLE,
    "Sensor: by how much the gyroscope warms up in the first minutes, and drifts with it",
);
pub(super) const HARD: &Setting = &axes(
    ["hard-iron", "X,Y,Z"],
    (HARD_IRON, "gauss"),
    "Sensor: field of the magnets that travel with the magnetometer, in body axes",
);
pub(super) const SOFT_DIAGONAL: &Setting = &axes(
    ["soft-iron-diagonal", "XX,YY,ZZ"],
    (SOFT_IRON_DIAGONAL, ""),
    "Sensor: of the symmetric matrix that would undo what steel bends",
);
pub(super) const SOFT_OFF_DIAGONAL: &Setting = &axes(
    ["soft-iron-off-diagonal", "XY,XZ,YZ"],
    (SOFT_IRON_OFF_DIAGONAL, ""),
    "Sensor: of the same matrix",
);
pub(super) const MOTORS: &Setting = &axes(
    ["motor-field", "X,Y,Z"],
    (MOTOR_FIELD, "gauss for each A"),
    "Sensor: field of the motors' current at the magnetometer, in body axes",
);

pub(super) const JITTER: &Setting = &number(
    ["jitter", "SECONDS"],
    (Kind::Number(within(0.0, 0.1)), "s"),
    "0",
    "Contention: most that each run's command waits for the processor",
);
pub(super) const LATE_SHARE: &Setting = &number(
    ["late-share", "SHARE"],
    (Kind::Number(within(0.0, 1.0)), ""),
    "0",
    "Contention: share of runs whose command waits longer",
);
pub(super) const LATE: &Setting = &number(
    ["late", "SECONDS"],
    (Kind::Number(within(0.0, 0.2)), "s"),
    "0.02",
    "Contention: most that these wait",
);

/// What is not given is as the file of the vehicle says.
const OF_VEHICLE: &str = "the vehicle's";

/// Three numbers of a sensor.
const fn axes(
    option: [&'static str; 2],
    (range, unit): (Range, &'static str),
    meaning: &'static str,
) -> Setting {
    number(option, (Kind::Axes(range), unit), OF_VEHICLE, meaning)
}

/// A number with its option, unit, default and meaning.
const fn number(
    [option, value]: [&'static str; 2],
    (kind, unit): (Kind, &'static str),
    default: &'static str,
    meaning: &'static str,
) -> Setting {
    Setting::of(["", option], kind, unit)
        .named(option)
        .option(option, value)
        .default(default)
        .meaning(meaning)
}

/// All of them.
#[derive(Clone, Debug)]
pub(super) struct Numbers;

impl Declarations for Numbers {
    const ALL: &'static [Setting] = &[
        *BANDWIDTH,
        *DURATION,
        *CLOCK,
        *PLANT_GAIN,
        *PLANT_DELAY,
        *GYRO_BIAS,
        *WARM_UP,
        *HARD,
        *SOFT_DIAGONAL,
        *SOFT_OFF_DIAGONAL,
        *MOTORS,
        *JITTER,
        *LATE_SHARE,
        *LATE,
    ];

    fn remark(setting: &Setting) -> String {
        format!(" [default: {}]", setting.default)
    }
}

/// The numbers that are given. Others are those of their declarations.
pub(super) type FlightNumbers = Given<Numbers>;

impl Given<Numbers> {
    /// A number, given or declared.
    ///
    /// # Errors
    /// It is out of its range.
    pub(super) fn get(&self, setting: &'static Setting) -> Result<f64, Refusal> {
        let value = match self.given(setting) {
            Some(value) => value,
            None => setting
                .parse(setting.default)
                .map_err(|unreadable| refused(setting, unreadable))?,
        };
        setting
            .check(value, None)
            .map_err(|refusal| refused(setting, refusal))?;
        match value {
            Value::Number(number) => Ok(number),
            _ => Err(refused(setting, "is no number")),
        }
    }

    /// Replaces a number of a vehicle by what is given for it.
    ///
    /// # Errors
    /// It is out of its range.
    pub(super) fn replace(
        &self,
        setting: &'static Setting,
        number: &mut f64,
    ) -> Result<(), Refusal> {
        if self.given(setting).is_some() {
            *number = self.get(setting)?;
        }
        Ok(())
    }

    /// The same of three numbers.
    ///
    /// # Errors
    /// One is out of its range.
    pub(super) fn replace_axes(
        &self,
        setting: &'static Setting,
        axes: &mut [f64; 3],
    ) -> Result<(), Refusal> {
        if let Some(value) = self.given(setting) {
            let checked = setting.check(value, None);
            checked.map_err(|refusal| refused(setting, refusal))?;
            if let Value::Axes(given) = value {
                *axes = given;
            }
        }
        Ok(())
    }

    /// What is given for a number, if anything.
    pub(super) fn given(&self, setting: &'static Setting) -> Option<Value> {
        self.of(setting.name)
    }
}
