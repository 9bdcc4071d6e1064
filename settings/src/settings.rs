//! What may be chosen at each start, without a build.

use crate::choices::{Feedback, MotorProtocol, Pairs, Policy, Reference};
use crate::declare;
use crate::declare::{Declared, Field};
use crate::inputs::Inputs;
use crate::range::{above, between, within};
use crate::sensors::{HARD_IRON, SOFT_IRON_DIAGONAL, SOFT_IRON_OFF_DIAGONAL};
use crate::setting::{Kind, Limit, Limits, OutOfRange, Setting, Value};
use crate::time::{Duration, micros};

/// The largest trim of an accelerometer, in m/s2: 6 degrees, or twice an MPU6050's zero-g output.
pub const LARGEST_TRIM: f32 = 1.0;

/// How long control runs time-triggered to learn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum WarmUp {
    /// Until every relevant model has its labels and is stable, 3 s to `T_boot`.
    Automatic,
    /// For this long, to the next refit behind it.
    Fixed(Duration),
}

declare! {
    /// Everything that may be chosen at each start, without a build.
    pub struct Settings {
        /// When control runs: when a sensor's change calls for it, or time-triggered.
        policy: Policy = Setting::of(["runs", "policy"], Kind::word::<Policy>(), "")
            .default("reactive").option("policy", ""),
        /// Runs per second of the periodic policy.
        period: Duration = Setting::of(
            ["runs", "periodic_rate_hz"], Kind::Rate(within(1.0, 1000.0)), "Hz")
            .limited(Limit::OncePerHyperperiod)
            .default("400").only_of(Policy::Periodic).option("rate", "HZ"),
        /// What a change is measured against.
        reference: Reference = Setting::of(["runs", "reference"], Kind::word::<Reference>(), "")
            .default("last-run").only_of(Policy::Reactive).option("reference", ""),
        /// Inputs that may ask for a run.
        triggers: Inputs = Setting::of(["inputs", "triggers"], Kind::Inputs, "")
            .only_of(Policy::Reactive).option("triggers", "INPUT,..."),
        /// Pairs of samples and commands that the warm-up learns from.
        pairs: Pairs = Setting::of(["warm_up", "pairs"], Kind::word::<Pairs>(), "")
            .default("first-crossings").only_of(Policy::Reactive).option("pairs", ""),
        /// Runs that reactive control learns from.
        feedback: Feedback = Setting::of(["learning", "feedback"], Kind::word::<Feedback>(), "")
            .default("every").only_of(Policy::Reactive).option("feedback", ""),
        /// Probability of a changed command that calls for a run.
        p_run: f32 = Setting::of(["runs", "p_run"], Kind::Number(between(0.0, 1.0)), "")
            .default("0.8").only_of(Policy::Reactive).option("p-run", "P"),
        /// How long control runs at every sample to learn.
        warm_up: WarmUp = Setting::of(
            ["warm_up", "length"], Kind::WordOrSpan(&["automatic", "auto"], within(0.0, 30.0)), "s")
            .limited(Limit::LongestWarmUp)
            .default("automatic").only_of(Policy::Reactive).option("warm-up", "auto|SECONDS"),
        /// Runs per second while learning; at every hyperperiod where that is less often.
        warm_up_period: Duration = Setting::of(
            ["warm_up", "rate_hz"], Kind::Rate(within(10.0, 1000.0)), "Hz")
            .default("1000").only_of(Policy::Reactive).option("warm-up-rate", "HZ"),
        /// Longest time between two runs.
        failsafe: Duration = Setting::of(
            ["runs", "failsafe_s"], Kind::Span(above(0.0, 1.0)), "s")
            .limited(Limit::AboveTwoHyperperiods)
            .default("0.1").option("failsafe", "SECONDS"),
        /// Change of a motor command that counts, as a share of full scale such as 0.004 or 1/255.
        quantum: f32 = Setting::of(
            ["runs", "quantum_steps"],
            Kind::Step { share: above(0.0, 0.5), steps: within(2.0, 65_535.0) },
            "")
            .default("255").option("quantum", "SHARE"),
        /// How long the held command may be off by a quantum: the impulse that calls for a run.
        budget: Duration = Setting::of(
            ["runs", "budget_s"], Kind::Span(within(0.0005, 0.5)), "s")
            .default("0.0125").only_of(Policy::Reactive).option("budget", "SECONDS"),
        /// Motor pulses: 125 to 250 us at 2 kHz, or 1000 to 2000 us at 400 Hz.
        motors: MotorProtocol = Setting::of(
            ["motors", "protocol"], Kind::word::<MotorProtocol>(), "")
            .of_board()
            .default("oneshot125").option("motors", ""),
        /// Seed of the exploration runs; in simulation, of noise and oscillators too.
        seed: u32 = Setting::of(
            ["learning", "exploration_seed"], Kind::Count(within(0.0, 4_294_967_295.0)), "")
            .default("1").option("seed", "NUMBER"),
        /// What the inertial sensor's accelerometer shows beyond gravity while the drone stands level.
        accel_trim: [f32; 3] = Setting::of(
            ["calibration", "accel_trim_m_s2"], Kind::Axes(within(-LARGEST_TRIM as f64, LARGEST_TRIM as f64)), "m/s2")
            .of_board()
            .default("[0, 0, 0]"),
        /// Field of the magnets that travel with the magnetometer, in body axes.
        hard_iron: [f32; 3] = Setting::of(
            ["magnetometer", "hard_iron_gauss"], Kind::Axes(HARD_IRON), "gauss")
            .of_board()
            .default("[0, 0, 0]"),
        /// Of the symmetric matrix that undoes what steel bends: xx, yy, zz.
        soft_iron_diagonal: [f32; 3] = Setting::of(
            ["magnetometer", "soft_iron_diagonal"], Kind::Axes(SOFT_IRON_DIAGONAL), "")
            .of_board()
            .default("[1, 1, 1]"),
        /// Of the same matrix: xy, xz, yz.
        soft_iron_off_diagonal: [f32; 3] = Setting::of(
            ["magnetometer", "soft_iron_off_diagonal"], Kind::Axes(SOFT_IRON_OFF_DIAGONAL), "")
            .of_board()
            .default("[0, 0, 0]"),
    }
}

impl Settings {
    fn is_periodic(&self) -> bool {
        self.policy == Policy::Periodic
    }

    /// With another value of one field, checked as it is written and as it is stored.
    ///
    /// # Errors
    /// The value is out of its range, or another one is.
    pub fn checked(self, place: usize, value: Value, limits: &Limits) -> Result<Self, OutOfRange> {
        if let Some(setting) = Self::SETTINGS.get(place) {
            setting.check(value, Some(limits))?;
        }
        let settings = self.with(place, value).unwrap_or(self);
        settings.check(limits)?;
        Ok(settings)
    }

    /// Checks every range; those of periodic control only where it is chosen.
    ///
    /// # Errors
    /// The first value that is out of its range, in the order of the fields.
    pub fn check(&self, limits: &Limits) -> Result<(), OutOfRange> {
        self.values()
            .filter(|(setting, _)| setting.policy != Some(Policy::Periodic) || self.is_periodic())
            .try_for_each(|(setting, value)| setting.check(value, Some(limits)))
    }
}

impl Field for WarmUp {
    fn value(self, kind: Kind) -> Value {
        match self {
            Self::Automatic => Value::Word(0),
            Self::Fixed(length) => length.value(kind),
        }
    }

    fn from_value(value: Value, kind: Kind) -> Option<Self> {
        match value {
            Value::Word(_) => Some(Self::Automatic),
            _ => Duration::from_value(value, kind).map(Self::Fixed),
        }
    }

    fn write(self, put: &mut dyn FnMut([u8; 4])) {
        match self {
            Self::Automatic => AUTOMATIC.write(put),
            Self::Fixed(length) => length.write(put),
        }
    }

    fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self> {
        Some(match u32::read(take)? {
            AUTOMATIC => Self::Automatic,
            length => Self::Fixed(micros(length.into())),
        })
    }
}

/// An automatic warm-up among lengths in microseconds.
const AUTOMATIC: u32 = u32::MAX;
