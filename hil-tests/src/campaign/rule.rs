//! Rules by which loops are made as fast as their margins allow.

use std::fmt;

use crate::closed_loop::Stress;

/// Delays that loops must bear, ms.
const DELAYS_MS: [u32; 3] = [5, 10, 20];
/// Most that a drone turns which bears its strain, RMS in mrad/s.
///
/// Wind alone turns slow loops by up to 120 in arch. What has no margin left oscillates at 400 and
/// more; in between loops ring, and the rule decides.
const LIMITS_MRAD_S: [u32; 2] = [150, 300];

/// Who takes part where reactive control is compared other than as configured over waypoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Contender {
    /// Reactive control.
    Reactive,
    /// Time-triggered control at the usual rate.
    Usual,
    /// Time-triggered control as often as reactive control runs there.
    EqualRuns,
}

/// Loops must bear twice the gain, and a delay, without turning the drone more than a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Rule {
    /// The delay in ms.
    pub delay_ms: u32,
    /// The limit, RMS in mrad/s.
    pub limit_mrad_s: u32,
}

/// What loops must bear: a gain or a delay that they are not made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Strain {
    /// The drone answers its motors twice as strongly: a gain margin of 6 dB.
    Gain,
    /// Motor commands apply so many ms later: a delay margin.
    Delay(u32),
}

/// When control runs where a margin is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tempo {
    /// Reactive control.
    Reactive,
    /// Time-triggered control at the usual rate.
    Usual,
    /// Time-triggered control as often as reactive control runs that is tuned by a rule.
    EqualRuns(Rule),
}

impl Contender {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Reactive, Self::Usual, Self::EqualRuns];

    /// As roles are called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Reactive => "reactive",
            Self::Usual => "usual",
            Self::EqualRuns => "equal-runs",
        }
    }
}

impl Rule {
    /// The rule that headlines are written of.
    pub const MIDDLE: Self = Self::of(DELAYS_MS[1], LIMITS_MRAD_S[0]);

    /// All of them, the least delay first.
    pub const ALL: [Self; 6] = {
        let [short, middle, long] = DELAYS_MS;
        let [strict, lax] = LIMITS_MRAD_S;
        [
            Self::of(short, strict),
            Self::of(short, lax),
            Self::of(middle, strict),
            Self::of(middle, lax),
            Self::of(long, strict),
            Self::of(long, lax),
        ]
    };

    const fn of(delay_ms: u32, limit_mrad_s: u32) -> Self {
        Self {
            delay_ms,
            limit_mrad_s,
        }
    }

    /// Both strains that loops must bear.
    #[must_use]
    pub fn strains(self) -> [Strain; 2] {
        [Strain::Gain, Strain::Delay(self.delay_ms)]
    }

    /// Whether a drone that turns so much, RMS in rad/s, bears its strain.
    #[must_use]
    pub fn allows(self, turning_rad_s: f64) -> bool {
        turning_rad_s <= f64::from(self.limit_mrad_s) / 1e3
    }

    /// When control of a contender runs where its margins are seen.
    #[must_use]
    pub fn tempo(self, of: Contender) -> Tempo {
        match of {
            Contender::Reactive => Tempo::Reactive,
            Contender::Usual => Tempo::Usual,
            Contender::EqualRuns => Tempo::EqualRuns(self),
        }
    }

    /// The rule of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|rule| rule.to_string() == name)
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let limit = f64::from(self.limit_mrad_s) / 1e3;
        write!(f, "{}ms-{limit}rad_s", self.delay_ms)
    }
}

impl Strain {
    /// Those of every rule, each once.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let delays = DELAYS_MS.into_iter().map(Self::Delay);
        [Self::Gain].into_iter().chain(delays).collect()
    }

    /// The option of a flight that stands for it.
    #[must_use]
    pub fn stress(self) -> Stress {
        let none = Stress::default();
        match self {
            Self::Gain => Stress { gain: 2.0, ..none },
            Self::Delay(ms) => Stress {
                delay_s: f64::from(ms) / 1e3,
                ..none
            },
        }
    }

    /// The strain of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all()
            .into_iter()
            .find(|strain| strain.to_string() == name)
    }
}

impl fmt::Display for Strain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gain => f.write_str("gain"),
            Self::Delay(ms) => write!(f, "{ms}ms"),
        }
    }
}

impl Tempo {
    /// The tempo of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "reactive" => Some(Self::Reactive),
            "usual" => Some(Self::Usual),
            _ => Some(Self::EqualRuns(Rule::named(
                name.strip_prefix("runs-of-")?,
            )?)),
        }
    }

    /// The strains under which its margins are seen.
    #[must_use]
    pub fn strains(self) -> Vec<Strain> {
        match self {
            Self::EqualRuns(rule) => rule.strains().to_vec(),
            Self::Reactive | Self::Usual => Strain::all(),
        }
    }
}

impl fmt::Display for Tempo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Reactive => f.write_str("reactive"),
            Self::Usual => f.write_str("usual"),
            Self::EqualRuns(rule) => write!(f, "runs-of-{rule}"),
        }
    }
}
