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

    /// How a chip lies in the drone: the turn that takes its axes to the body's, by right angles.
    ///
    /// Words are MAVLink's (MAV_SENSOR_ROTATION): roll, then pitch, then yaw, about the body's axes. Right
    /// angles alone, because a chip that compares its axes one by one must compare the body's.
    #[expect(missing_docs, reason = "each name says it")]
    Mounting {
        None = "none",
        Yaw90 = "yaw90",
        Yaw180 = "yaw180",
        Yaw270 = "yaw270",
        Roll90 = "roll90",
        Roll90Yaw90 = "roll90yaw90",
        Roll90Yaw180 = "roll90yaw180",
        Roll90Yaw270 = "roll90yaw270",
        Roll180 = "roll180",
        Roll180Yaw90 = "roll180yaw90",
        Roll180Yaw180 = "roll180yaw180",
        Roll180Yaw270 = "roll180yaw270",
        Roll270 = "roll270",
        Roll270Yaw90 = "roll270yaw90",
        Roll270Yaw180 = "roll270yaw180",
        Roll270Yaw270 = "roll270yaw270",
        Pitch90 = "pitch90",
        Pitch90Yaw90 = "pitch90yaw90",
        Pitch90Yaw180 = "pitch90yaw180",
        Pitch90Yaw270 = "pitch90yaw270",
        Pitch270 = "pitch270",
        Pitch270Yaw90 = "pitch270yaw90",
        Pitch270Yaw180 = "pitch270yaw180",
        Pitch270Yaw270 = "pitch270yaw270",
    }

    /// How a motor command becomes a pulse.
    MotorProtocol {
        /// 125 to 250 us, 2000 times a second.
        OneShot125 = "oneshot125",
        /// 1000 to 2000 us, 400 times a second.
        Pwm = "pwm",
    }
}

impl Mounting {
    /// A vector along the chip's axes, along the body's.
    ///
    /// Known when the firmware is built: a chip that is not turned costs nothing.
    #[inline(always)]
    #[must_use]
    pub const fn turned(self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = match self as u8 / 4 {
            0 => [x, y, z],
            1 => [x, -z, y],
            2 => [x, -y, -z],
            3 => [x, z, -y],
            4 => [z, y, -x],
            _ => [-z, y, x],
        };
        match self as u8 % 4 {
            0 => [x, y, z],
            1 => [-y, x, z],
            2 => [-x, -y, z],
            _ => [y, -x, z],
        }
    }

    /// The chip's x, y and z along the body's axes.
    #[must_use]
    pub fn axes(self) -> [[f64; 3]; 3] {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        axes.map(|axis| self.turned(axis).map(f64::from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mountings_are_all_the_turns_by_right_angles_each_once() {
        let matrices: std::vec::Vec<[[i8; 3]; 3]> = Mounting::ALL
            .iter()
            .map(|mounting| mounting.axes().map(|axis| axis.map(|part| part as i8)))
            .collect();
        for (place, [x, y, z]) in matrices.iter().enumerate() {
            let turned = [
                x[1] * y[2] - x[2] * y[1],
                x[2] * y[0] - x[0] * y[2],
                x[0] * y[1] - x[1] * y[0],
            ];
            assert_eq!(turned, *z, "{:?}", Mounting::ALL[place]);
            assert!(!matrices[..place].contains(&matrices[place]));
        }
        assert_eq!(matrices.len(), 24);
    }

    #[test]
    fn a_vector_of_the_chip_is_turned_to_the_bodys_axes() {
        // Its x axis to the right: what it feels along y comes from behind.
        assert_eq!(Mounting::Yaw90.turned([0.0, 1.0, 0.0]), [-1.0, 0.0, 0.0]);
        assert_eq!(Mounting::Roll180.turned([1.0, 2.0, 3.0]), [1.0, -2.0, -3.0]);
        assert_eq!(Mounting::Pitch90.turned([0.0, 0.0, 1.0]), [1.0, 0.0, 0.0]);
    }
}
