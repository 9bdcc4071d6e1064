//! Settings that are one of a few words.

/// An enum whose variants are written as words, the same ones everywhere.
pub trait Choice: Copy + PartialEq + 'static {
    /// The enum's name, and each variant's name and word, in the order of their numbers.
    const CHOICES: Choices;

    /// The variant of a number, `None` past the last.
    fn from_number(number: u32) -> Option<Self>;

    /// The variant's number.
    fn number(self) -> u32;
}

/// What a [`Choice`] can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choices {
    /// The enum's name.
    pub name: &'static str,
    /// Each variant's name and its word.
    pub variants: &'static [[&'static str; 2]],
}

/// Declares enums and their words.
macro_rules! choices {
    ($($(#[$of:meta])* $name:ident { $($(#[$doc:meta])* $variant:ident = $word:literal,)* })*) => {
        $(
            $(#[$of])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            #[cfg_attr(target_os = "none", derive(defmt::Format))]
            pub enum $name { $($(#[$doc])* $variant,)* }

            impl $name {
                /// All of them, in the order of their numbers.
                pub const ALL: &[Self] = &[$(Self::$variant,)*];

                /// The word that stands for it everywhere.
                #[must_use]
                pub const fn word(self) -> &'static str {
                    match self { $(Self::$variant => $word,)* }
                }
            }

            impl Choice for $name {
                const CHOICES: Choices = Choices {
                    name: stringify!($name),
                    variants: &[$([stringify!($variant), $word],)*],
                };

                fn from_number(number: u32) -> Option<Self> {
                    Self::ALL.get(number as usize).copied()
                }

                fn number(self) -> u32 {
                    self as u32
                }
            }
        )*
    };
}

choices! {
    /// When control runs.
    Policy {
        /// When a sensor's change calls for it.
        Reactive = "reactive",
        /// Time-triggered, at the first hyperperiod's end that reaches the period.
        Periodic = "periodic",
    }

    /// What a change is measured against.
    Reference {
        /// The sample before, as published (Bregu et al. 2016, section 4).
        PreviousSample = "previous-sample",
        /// The sample that the last run used.
        LastRun = "last-run",
    }

    /// Which pairs of samples and commands become labels in the warm-up.
    Pairs {
        /// Shadow holds end at the first crossing of a candidate threshold; those of an input that
        /// this teaches too little go on as with [`Self::WeightedLags`].
        FirstCrossings = "first-crossings",
        /// Shadow holds end after a number of samples of their own: pairs at several lags, and as
        /// pairs do not overlap, as many of each as the inverse of the lag.
        WeightedLags = "weighted-lags",
        /// Consecutive samples, as published (Bregu et al. 2016, section 4).
        Published = "published",
    }

    /// Which runs become labels in reactive control.
    Feedback {
        /// Every run that one input alone asked for, failsafe runs, exploration runs.
        Every = "every",
        /// False positives, and failsafe runs that changed a command, as published (section 4).
        Published = "published",
    }

    /// How a motor command becomes a pulse.
    MotorProtocol {
        /// 125 to 250 us, 2000 times a second.
        OneShot125 = "oneshot125",
        /// 1000 to 2000 us, 400 times a second.
        Pwm = "pwm",
    }
}
