//! The inputs whose change may call for a run, and sets of them.

/// The inputs whose change may call for a run, one model each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[repr(u8)]
pub enum Input {
    /// MPU6050 gyroscope: gates the hyperperiod.
    Gyro = 0,
    /// MPU6050 accelerometer: gates the hyperperiod.
    Accel = 1,
    /// LSM303AGR accelerometer: triggers, does not gate.
    ChipAccel = 2,
    /// LSM303AGR magnetometer: triggers, does not gate.
    ChipMag = 3,
    /// Derived: the angle turned since the last run.
    Turned = 4,
    /// Derived: the command that a run would come to, against the one applied.
    Command = 5,
}

impl Input {
    /// How many inputs may trigger.
    pub const COUNT: usize = 6;

    /// All of them, in the order of their numbers.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Gyro,
        Self::Accel,
        Self::ChipAccel,
        Self::ChipMag,
        Self::Turned,
        Self::Command,
    ];

    /// Those that a sensor delivers.
    pub const SENSED: [Self; 4] = [Self::Gyro, Self::Accel, Self::ChipAccel, Self::ChipMag];

    /// The input of a number, `None` past the last.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// The name used in logs, reports and configuration.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gyro => "mpu6050_gyro",
            Self::Accel => "mpu6050_accel",
            Self::ChipAccel => "lsm303agr_accel",
            Self::ChipMag => "lsm303agr_mag",
            Self::Turned => "angle_turned",
            Self::Command => "command_change",
        }
    }

    /// Its name among options.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Gyro => "gyro",
            Self::Accel => "accel",
            Self::ChipAccel => "chip-accel",
            Self::ChipMag => "chip-mag",
            Self::Turned => "turned",
            Self::Command => "command",
        }
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

    /// Those that a sample of the MPU6050 delivers, or that are derived from it.
    pub const OF_IMU: Self = Self::NONE
        .with(Input::Gyro)
        .with(Input::Accel)
        .with(Input::Turned)
        .with(Input::Command);

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
