//! The inputs whose change may call for a run, each declared once; sets of them.
//!
//! What is declared here is said nowhere else: tables of the configuration, learners, gates of the
//! hyperperiod, sets and records, the option `--triggers`, names in logs and reports follow from
//! it. What an input needs beyond that asks for it by an exhaustive match or by an array of
//! [`Input::COUNT`], so that a forgotten place does not compile.

/// What is known of one input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Declaration {
    /// Its name in logs and reports.
    pub name: &'static str,
    /// Its name among options; with underscores, its table of the configuration.
    pub key: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// The unit of its changes.
    pub unit: Unit,
    /// Where its samples come from.
    pub source: Source,
    /// The rate of its sensor.
    pub rate: Option<&'static Rate>,
    /// Whether it gates the hyperperiod, in the configuration as it is shipped.
    pub gates: bool,
    /// The ends of the bins that its changes are counted in, as shipped, in its unit.
    pub changes: [f64; 2],
}

/// The unit of an input's changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// As named.
    Named(&'static str),
    /// The quantum of the motor command, which is a setting; the firmware counts in shares of
    /// full scale.
    Quantum,
    /// A quantum for a millisecond; the firmware counts in shares of full scale times seconds.
    QuantumTime,
}

/// How often a sensor samples: a setting in a board's file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// Its key in the table `sensors`.
    pub key: &'static str,
    /// The constant that holds it.
    pub name: &'static str,
    /// The rates that the sensor has, in Hz.
    pub allowed: &'static [f64],
    /// The rate as shipped, in Hz.
    pub default: &'static str,
    /// What it is the rate of, as a sentence.
    pub meaning: &'static str,
}

/// Where the samples of an input come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A sensor in the burst of the inertial measurement unit: three axes.
    Imu,
    /// A chip with a clock of its own: three axes.
    Chip,
    /// Computed at every burst: three axes.
    Derived,
    /// Computed at every burst: a share of full scale for every motor.
    Command,
    /// Computed at every burst: an impulse about every axis.
    Impulse,
}

/// A rate that is given or not.
const fn given(rate: &[&'static Rate]) -> Option<&'static Rate> {
    match rate {
        [rate] => Some(rate),
        _ => None,
    }
}

/// Declares the inputs in the order of their numbers: those with three axes first.
macro_rules! inputs {
    (
        $($(#[doc = $meaning:literal])+ $axes:ident {
            name: $name:literal, key: $key:literal, unit: $unit:expr, source: $source:ident,
            $(rate: $rate:ident, gates: $gates:literal,)? changes: $changes:expr,
        })*
        ---
        $($(#[doc = $other_meaning:literal])+ $other:ident {
            name: $other_name:literal, key: $other_key:literal, unit: $other_unit:expr,
            source: $other_source:ident, changes: $other_changes:expr,
        })*
    ) => {
        /// The inputs whose change may call for a run, one model each.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(target_os = "none", derive(defmt::Format))]
        #[repr(u8)]
        pub enum Input {
            $($(#[doc = $meaning])+ $axes,)*
            $($(#[doc = $other_meaning])+ $other,)*
        }

        impl Input {
            /// Those with three axes, in the order of their numbers.
            pub const OF_AXES: [Self; [$(Self::$axes),*].len()] = [$(Self::$axes),*];

            /// All of them, in the order of their numbers.
            pub const ALL: [Self; Self::COUNT] = [$(Self::$axes,)* $(Self::$other,)*];

            /// How many inputs may trigger.
            pub const COUNT: usize = [$(Self::$axes,)* $(Self::$other,)*].len();

            /// What is known of it.
            #[must_use]
            pub const fn declaration(self) -> Declaration {
                match self {
                    $(Self::$axes => Declaration {
                        name: $name,
                        key: $key,
                        meaning: concat!($($meaning),+).trim_ascii(),
                        unit: $unit,
                        source: Source::$source,
                        rate: given(&[$(&$rate)?]),
                        gates: false$(|| $gates)?,
                        changes: $changes,
                    },)*
                    $(Self::$other => Declaration {
                        name: $other_name,
                        key: $other_key,
                        meaning: concat!($($other_meaning),+).trim_ascii(),
                        unit: $other_unit,
                        source: Source::$other_source,
                        rate: None,
                        gates: false,
                        changes: $other_changes,
                    },)*
                }
            }

            /// A value for each input with three axes, by its number.
            ///
            /// A plain list, so that large values are built in their place: a map over
            /// [`Self::OF_AXES`] would build them on the stack.
            #[inline(always)]
            pub fn each_of_axes<T>(value: impl Fn(Self) -> T) -> [T; Self::OF_AXES.len()] {
                [$(value(Self::$axes)),*]
            }
        }
    };
}

/// Periods are whole milliseconds.
const IMU_RATE: Rate = Rate {
    key: "imu_rate_hz",
    name: "IMU_RATE",
    allowed: &[1000.0, 500.0, 250.0, 200.0, 125.0, 100.0],
    default: "1000",
    meaning: "Rate of the MPU6050.",
};

const CHIP_ACCEL_RATE: Rate = Rate {
    key: "chip_accel_rate_hz",
    name: "CHIP_ACCEL_RATE",
    allowed: &[400.0, 200.0, 100.0, 50.0, 25.0, 10.0],
    default: "100",
    meaning: "Rate of the LSM303AGR's accelerometer.",
};

const CHIP_MAG_RATE: Rate = Rate {
    key: "chip_mag_rate_hz",
    name: "CHIP_MAG_RATE",
    allowed: &[100.0, 50.0, 20.0, 10.0],
    default: "100",
    meaning: "Rate of the LSM303AGR's magnetometer.",
};

inputs! {
    /// Angular rate, from the MPU6050's gyroscope.
    Gyro {
        name: "mpu6050_gyro", key: "gyro", unit: Unit::Named("rad/s"), source: Imu,
        rate: IMU_RATE, gates: true, changes: [0.005, 4.0],
    }
    /// Specific force, from the MPU6050's accelerometer.
    Accel {
        name: "mpu6050_accel", key: "accel", unit: Unit::Named("m/s2"), source: Imu,
        rate: IMU_RATE, gates: true, changes: [0.02, 80.0],
    }
    /// Specific force, from the LSM303AGR's accelerometer, which compares by itself.
    ChipAccel {
        name: "lsm303agr_accel", key: "chip-accel", unit: Unit::Named("m/s2"), source: Chip,
        rate: CHIP_ACCEL_RATE, gates: false, changes: [0.02, 40.0],
    }
    /// Magnetic field, from the LSM303AGR's magnetometer, which compares by itself.
    ChipMag {
        name: "lsm303agr_mag", key: "chip-mag", unit: Unit::Named("gauss"), source: Chip,
        rate: CHIP_MAG_RATE, gates: false, changes: [0.0015, 0.5],
    }
    /// Angle turned since the last run.
    Turned {
        name: "angle_turned", key: "turned", unit: Unit::Named("rad"), source: Derived,
        changes: [0.0005, 0.5],
    }
    ---
    /// Command that a run would compute, against the one applied.
    Command {
        name: "command_change", key: "command", unit: Unit::Quantum, source: Command,
        changes: [0.7, 1.4],
    }
    /// Impulse that the held command owes since the last run.
    Owed {
        name: "impulse_owed", key: "owed", unit: Unit::QuantumTime, source: Impulse,
        changes: [1.0, 200.0],
    }
}

const _: () = assert!(Input::COUNT <= 8, "a set of inputs is a byte");

impl Input {
    /// Those that a sensor delivers.
    pub const SENSED: [Self; Inputs::SENSED.len()] = Inputs::SENSED.list();

    /// Those of chips with a clock of their own.
    pub const OF_CHIPS: [Self; Inputs::OF_CHIPS.len()] = Inputs::OF_CHIPS.list();

    /// The input of a number, `None` past the last.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// The name used in logs and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.declaration().name
    }

    /// Its name among options.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.declaration().key
    }

    /// Where its samples come from.
    #[must_use]
    pub const fn source(self) -> Source {
        self.declaration().source
    }
}

/// A set of inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Inputs(u8);

impl Inputs {
    /// No input.
    pub const NONE: Self = Self(0);

    /// Every input.
    pub const ALL: Self = Self((1 << Input::COUNT) - 1);

    /// Those that a sensor delivers.
    pub const SENSED: Self = Self::of(&[Source::Imu, Source::Chip]);

    /// Those of chips with a clock of their own.
    pub const OF_CHIPS: Self = Self::of(&[Source::Chip]);

    /// Those with three axes.
    pub const OF_AXES: Self = Self::of(&[Source::Imu, Source::Chip, Source::Derived]);

    /// Those that a burst of the inertial measurement unit delivers, or that are derived from it.
    pub const OF_IMU: Self = Self::of(&[
        Source::Imu,
        Source::Derived,
        Source::Command,
        Source::Impulse,
    ]);

    const fn of(sources: &[Source]) -> Self {
        let mut set = Self::NONE;
        let mut number = 0;
        while number < Input::COUNT {
            let input = Input::ALL[number];
            let mut place = 0;
            while place < sources.len() {
                if sources[place] as u8 == input.source() as u8 {
                    set = set.with(input);
                }
                place += 1;
            }
            number += 1;
        }
        set
    }

    /// How many inputs are in the set.
    #[must_use]
    pub const fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    /// The first inputs of the set, in the order of their numbers.
    const fn list<const N: usize>(self) -> [Input; N] {
        let mut list = [Input::Command; N];
        let (mut number, mut place) = (0, 0);
        while number < Input::COUNT && place < N {
            if self.contains(Input::ALL[number]) {
                list[place] = Input::ALL[number];
                place += 1;
            }
            number += 1;
        }
        list
    }

    /// The inputs of the set, in the order of their numbers.
    pub fn iter(self) -> impl Iterator<Item = Input> {
        Input::ALL
            .into_iter()
            .filter(move |input| self.contains(*input))
    }

    /// The set of a word with one bit for each input, by its number; other bits are dropped.
    #[must_use]
    pub const fn from_bits(bits: u8) -> Self {
        Self(bits & Self::ALL.0)
    }

    /// One bit for each input in the set, by its number.
    #[must_use]
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// The set with one more input.
    #[must_use]
    pub const fn with(self, input: Input) -> Self {
        Self(self.0 | 1 << input as u8)
    }

    /// The set less one input.
    #[must_use]
    pub const fn without(self, input: Input) -> Self {
        Self(self.0 & !(1 << input as u8))
    }

    /// Both sets together.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// True where some input is in both sets.
    #[must_use]
    pub const fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// True where no input is in the set.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The input that is alone in the set.
    #[must_use]
    pub fn sole(self) -> Option<Input> {
        let alone = self.0.is_power_of_two();
        Input::from_number(self.0.trailing_zeros() as u8).filter(|_| alone)
    }

    /// True where the input is in the set.
    #[must_use]
    pub const fn contains(self, input: Input) -> bool {
        self.0 >> input as u8 & 1 == 1
    }
}

impl FromIterator<Input> for Inputs {
    fn from_iter<I: IntoIterator<Item = Input>>(inputs: I) -> Self {
        inputs.into_iter().fold(Self::NONE, Self::with)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_by_number_begin_with_the_sensors_and_end_before_the_command() {
        let begins = |list: &[Input]| list == &Input::ALL[..list.len()];
        assert!(begins(&Input::SENSED) && begins(&Input::OF_AXES));
        assert_eq!(Input::OF_AXES.len(), Input::Command as usize);
    }

    #[test]
    fn the_sets_of_sources_share_no_input_and_leave_none_out() {
        assert_eq!(Inputs::OF_IMU.or(Inputs::OF_CHIPS), Inputs::ALL);
        assert!(!Inputs::OF_IMU.meets(Inputs::OF_CHIPS));
        assert!(Inputs::SENSED.iter().eq(Input::SENSED));
    }

    #[test]
    fn names_and_keys_are_each_of_one_input() {
        for input in Input::ALL {
            let same = |other: &Input| other.name() == input.name() || other.key() == input.key();
            assert_eq!(Input::ALL.iter().filter(|other| same(other)).count(), 1);
        }
    }
}
