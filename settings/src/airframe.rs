//! An airframe: where its motors are, how they turn, what each can do.
//!
//! Each axis has a *pattern*: what a share of full scale on each motor does about it. What of a
//! pattern lies across all others is the *own* part: moving the motors along it acts on that axis
//! alone, and nothing that does so moves them less. Scaled, these are the columns of the
//! pseudo-inverse of the patterns; they are found by Gram-Schmidt.
//!
//! The same arithmetic checks `config/` while building and makes the mixer when the firmware starts.

use core::f64::consts::{PI, SQRT_2};
use core::fmt;

use crate::range::{Range, from_below, within};

/// Most motors that an airframe has.
pub const MOST_MOTORS: usize = 8;
/// Fewest motors that an airframe has.
pub const FEWEST_MOTORS: usize = 4;

/// Directions of arms, in degrees.
pub const DIRECTION: Range = from_below(0.0, 360.0);
/// The least command of an armed motor, as a share of full scale.
pub const ARMED_MINIMUM: Range = within(0.0, 0.3);

/// Least authority about an axis, where 1 is that of evenly spaced arms.
const LEAST_AUTHORITY: f64 = 0.2;
/// Most lever of equal thrust on all motors, in arms.
const MOST_PULL: f64 = 0.01;
/// Squares of lengths below this are rounding.
const ROUNDING: f64 = 1e-12;

/// A number for each motor, zero where there is none.
type Pattern = [f64; MOST_MOTORS];

/// The pattern of what no motor does.
const NOTHING: Pattern = [0.0; MOST_MOTORS];

/// One motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motor {
    /// Direction of its arm in degrees from forward, clockwise seen from above.
    pub angle_deg: f32,
    /// Its propeller turns clockwise, seen from above.
    pub clockwise: bool,
}

/// Where the motors are, in the order of the outputs, and the least that they are given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Airframe {
    armed_minimum: f32,
    count: u8,
    motors: [Motor; MOST_MOTORS],
}

/// Why an airframe is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum AirframeError {
    /// Too few motors, or too many.
    Count(usize),
    /// The direction of an arm is not within 0 to less than 360 degrees.
    Direction(f32),
    /// Propellers do not turn half one way and half the other: so many of all turn clockwise.
    Spins(usize, usize),
    /// The least command is no share of full scale within 0 to 0.3.
    ArmedMinimum(f32),
    /// Equal thrust would turn the drone about this axis, by this lever in arms.
    Pull(&'static str, f64),
    /// The motors can hardly turn the drone about this axis alone: the share of the usual.
    Authority(&'static str, f64),
}

impl fmt::Display for AirframeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(count) => write!(
                f,
                "{count} motors are out of range, must be {FEWEST_MOTORS} to {MOST_MOTORS}"
            ),
            Self::Spins(clockwise, count) => {
                write!(f, "{clockwise} of {count} spin cw, must be half of them")
            }
            Self::Direction(degrees) => {
                write!(f, "{degrees} degrees are out of range, must be {DIRECTION}")
            }
            Self::ArmedMinimum(share) => {
                write!(f, "{share} is out of range, must be {ARMED_MINIMUM}")
            }
            Self::Pull(axis, lever) => write!(
                f,
                "equal thrust would {axis}: the mean lever is {lever:.2} of an arm, at most {MOST_PULL}"
            ),
            Self::Authority(axis, share) => write!(
                f,
                "authority to {axis} and nothing else is {share:.2} of the usual, must be at least \
                 {LEAST_AUTHORITY}: spread the arms, and let neighbours turn opposite ways"
            ),
        }
    }
}

/// The number of a propeller that turns clockwise; another's is less than zero by as much.
const CLOCKWISE: f32 = 1.0;

fn is_clockwise(number: f32) -> Option<bool> {
    let clockwise = number > 0.0;
    (number.abs() == CLOCKWISE).then_some(clockwise)
}

impl Airframe {
    /// How many numbers [`Self::write`] hands on.
    pub(crate) const WORDS: usize = 2 + 2 * MOST_MOTORS;

    /// An airframe of up to [`MOST_MOTORS`] motors, not yet checked; more are left out.
    #[must_use]
    pub const fn new(armed_minimum: f32, motors: &[Motor]) -> Self {
        let mut airframe = Self {
            armed_minimum,
            count: 0,
            motors: [Motor {
                angle_deg: 0.0,
                clockwise: false,
            }; MOST_MOTORS],
        };
        let (mut left, mut places) = (motors, airframe.motors.as_mut_slice());
        while let ([motor, rest @ ..], [place, places_left @ ..]) = (left, places) {
            *place = *motor;
            airframe.count += 1;
            (left, places) = (rest, places_left);
        }
        airframe
    }

    /// Reads what [`Self::write`] wrote, not yet checked; `None` where numbers are missing or mean
    /// nothing.
    pub(crate) fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self> {
        let mut number = || take().map(f32::from_le_bytes);
        let (armed_minimum, count) = (number()?, number()?);
        let mut airframe = Self::new(armed_minimum, &[]);
        for motor in &mut airframe.motors {
            *motor = Motor {
                angle_deg: number()?,
                clockwise: is_clockwise(number()?)?,
            };
        }
        airframe.count = count as u8;
        (f32::from(airframe.count) == count).then_some(airframe)
    }

    /// Hands its numbers' bytes on: least command, motors, then direction and turn of each place
    /// for a motor.
    pub(crate) fn write(&self, put: &mut dyn FnMut([u8; 4])) {
        put(self.armed_minimum.to_le_bytes());
        put(f32::from(self.count).to_le_bytes());
        for motor in &self.motors {
            put(motor.angle_deg.to_le_bytes());
            put(if motor.clockwise {
                CLOCKWISE
            } else {
                -CLOCKWISE
            }
            .to_le_bytes());
        }
    }

    /// The motors in the order of the outputs.
    #[must_use]
    pub fn motors(&self) -> &[Motor] {
        self.motors.get(..self.count()).unwrap_or_default()
    }

    /// How many motors there are.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count as usize
    }

    /// Least command of an armed motor, as a share of full scale.
    #[must_use]
    pub const fn armed_minimum(&self) -> f32 {
        self.armed_minimum
    }

    /// Refuses motors that cannot hold a drone level, or cannot turn it about one axis alone.
    ///
    /// # Errors
    /// The first rule that it breaks.
    #[inline(never)]
    pub fn check(&self) -> Result<(), AirframeError> {
        let count = self.count();
        if !(FEWEST_MOTORS..=MOST_MOTORS).contains(&count) {
            return Err(AirframeError::Count(count));
        }
        for Motor { angle_deg, .. } in self.motors() {
            if !DIRECTION.contains(f64::from(*angle_deg)) {
                return Err(AirframeError::Direction(*angle_deg));
            }
        }
        let clockwise = self.motors().iter().filter(|it| it.clockwise).count();
        if clockwise * 2 != count {
            return Err(AirframeError::Spins(clockwise, count));
        }
        if !ARMED_MINIMUM.contains(f64::from(self.armed_minimum)) {
            return Err(AirframeError::ArmedMinimum(self.armed_minimum));
        }
        let (axes, motors) = (self.axes(), count as f64);
        for axis in &axes {
            let pull = axis.pattern.iter().sum::<f64>() / motors;
            if pull.abs() > MOST_PULL {
                return Err(AirframeError::Pull(axis.name, pull.abs()));
            }
        }
        for axis in &axes {
            let own = self.own_part(&axes, axis);
            let authority = dot(&own, &own) * motors / (axis.unit * axis.unit);
            if authority < LEAST_AUTHORITY {
                return Err(AirframeError::Authority(axis.name, authority));
            }
        }
        Ok(())
    }

    /// Share of full scale by which a unit of demand moves each motor, zero where there is none:
    /// about roll, pitch and yaw, of an airframe that [`Self::check`] accepts.
    ///
    /// A unit is the same torque per motor on every airframe: of roll and pitch, all motors' full
    /// scale on the lever that the motors of an X quadrotor have, 1/sqrt(2) of an arm; of yaw, the
    /// reaction of all propellers at full scale. So gains carry over between airframes, but for
    /// what their inertia differs by.
    #[must_use]
    #[inline(never)]
    pub fn allocation(&self) -> [[f32; MOST_MOTORS]; 3] {
        let axes = self.axes();
        axes.each_ref()
            .map(|axis| axis.steps(&self.own_part(&axes, axis)))
    }

    /// A pattern of the motors that there are.
    fn pattern(&self, effect: impl Fn(&Motor) -> f64) -> Pattern {
        let mut pattern = [0.0; MOST_MOTORS];
        for (place, motor) in pattern.iter_mut().zip(self.motors()) {
            *place = effect(motor);
        }
        pattern
    }

    /// Roll, pitch and yaw; a motor on the right rolls to the left.
    #[inline(never)]
    fn axes(&self) -> [Axis; 3] {
        let count = self.count() as f64;
        [
            Axis {
                name: "roll",
                pattern: self.pattern(|motor| -sine(f64::from(motor.angle_deg))),
                unit: count / SQRT_2,
            },
            Axis {
                name: "pitch",
                pattern: self.pattern(|motor| sine(f64::from(motor.angle_deg) + 90.0)),
                unit: count / SQRT_2,
            },
            Axis {
                name: "yaw",
                // The body turns against the propeller.
                pattern: self.pattern(|motor| if motor.clockwise { -1.0 } else { 1.0 }),
                unit: count,
            },
        ]
    }

    /// What of one axis' pattern acts on no other axis, nor on the thrust.
    #[inline(never)]
    fn own_part(&self, axes: &[Axis; 3], axis: &Axis) -> Pattern {
        let mut others = [self.pattern(|_| 1.0), NOTHING, NOTHING];
        let of_others = axes.iter().filter(|other| other.name != axis.name);
        for (place, other) in of_others.enumerate() {
            let part = across(&other.pattern, &others);
            if let Some(next) = others.get_mut(place + 1) {
                *next = part;
            }
        }
        across(&axis.pattern, &others)
    }
}

/// One axis of torque.
struct Axis {
    name: &'static str,
    /// Torque per share of full scale, in arms for roll and pitch, in reactions for yaw.
    pattern: Pattern,
    /// The torque that a unit of demand stands for.
    unit: f64,
}

impl Axis {
    /// The motor steps of a unit of demand, along the pattern's own part.
    fn steps(&self, own: &Pattern) -> [f32; MOST_MOTORS] {
        let step = self.unit / dot(own, own);
        own.map(|part| exact_zero(part * step) as f32)
    }
}

/// What of a pattern lies across all of some that lie across each other; those of no length count
/// for nothing.
#[inline(never)]
fn across(pattern: &Pattern, others: &[Pattern]) -> Pattern {
    let mut rest = *pattern;
    for other in others {
        let length = dot(other, other);
        if length > ROUNDING {
            let along = dot(&rest, other) / length;
            rest.iter_mut()
                .zip(other)
                .for_each(|(rest, other)| *rest -= along * other);
        }
    }
    rest
}

fn dot(a: &Pattern, b: &Pattern) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Sine of an angle in degrees, 0 to 450, to the last digits of `f64`.
///
/// By its series: a quarter turn in degrees is exact, so that nothing is left of a turn. `libm::sin`
/// takes 6.5 KiB of flash to find quarter turns in any number of radians.
#[inline(never)]
fn sine(degrees: f64) -> f64 {
    let quarter = match degrees {
        ..90.0 => degrees,
        ..270.0 => 180.0 - degrees,
        _ => degrees - 360.0,
    };
    let x = quarter * (PI / 180.0);
    // The 27th power of a quarter turn over 27! is below the last digit.
    let terms = (1..14).rev().map(|n| f64::from(2 * n * (2 * n + 1)));
    x * terms.fold(1.0, |sum, below| 1.0 - sum * x * x / below)
}

/// A motor on an axis has no lever: what rounding left of it would only be hard to read.
fn exact_zero(step: f64) -> f64 {
    if step * step < ROUNDING { 0.0 } else { step }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::string::{String, ToString};

    const CW: bool = true;
    const CCW: bool = false;

    fn airframe<const N: usize>(angles: [f32; N], spins: [bool; N]) -> Airframe {
        let mut motors = [Motor::default(); N];
        for ((motor, angle_deg), clockwise) in motors.iter_mut().zip(angles).zip(spins) {
            *motor = Motor {
                angle_deg,
                clockwise,
            };
        }
        Airframe::new(0.05, &motors)
    }

    fn refusal<const N: usize>(angles: [f32; N], spins: [bool; N]) -> String {
        let refused = airframe(angles, spins).check();
        refused.expect_err("refused").to_string()
    }

    #[test]
    fn the_sine_of_a_direction_is_that_of_the_standard_library() {
        for tenth in 0..=4500 {
            let degrees = f64::from(tenth) * 0.1;
            assert!(
                (sine(degrees) - degrees.to_radians().sin()).abs() < 1e-15,
                "{degrees}"
            );
        }
        assert_eq!([0.0, 180.0, 360.0].map(sine), [0.0; 3]);
    }

    #[test]
    fn arms_along_one_line_cannot_turn_about_it() {
        let message = refusal([0.0, 180.0, 0.0, 180.0], [CW, CW, CCW, CCW]);
        assert!(message.contains("to roll and nothing else is 0.00 of the usual"));
        let message = refusal([45.0, 225.0, 45.0, 225.0], [CW, CW, CCW, CCW]);
        assert!(message.contains("to roll and nothing else is 0.00 of the usual"));
        let message = refusal([90.0, 270.0, 90.0, 270.0], [CW, CW, CCW, CCW]);
        assert!(message.contains("to pitch and nothing else is 0.00 of the usual"));
    }

    #[test]
    fn a_side_that_turns_one_way_cannot_yaw_without_rolling() {
        let message = refusal([45.0, 135.0, 225.0, 315.0], [CW, CW, CCW, CCW]);
        assert!(message.contains("to roll and nothing else is 0.00 of the usual"));
        let message = refusal(
            [30.0, 90.0, 150.0, 210.0, 270.0, 330.0],
            [CW, CW, CW, CCW, CCW, CCW],
        );
        // 1 less the square of the cosine between the patterns, (4 / sqrt(3 * 6))^2.
        assert!(message.contains("to roll and nothing else is 0.11 of the usual"));
    }

    #[test]
    fn arms_that_gather_in_front_would_raise_the_nose() {
        let message = refusal([30.0, 330.0, 120.0, 240.0], [CW, CCW, CCW, CW]);
        // (2 cos 30 - 2 cos 60) / 4.
        assert!(
            message.contains("would pitch: the mean lever is 0.18 of an arm"),
            "{message}"
        );
    }

    #[test]
    fn arms_askew_are_told_apart_all_the_same() {
        // Rows of arms at 20 and 110 degrees: roll and pitch share motors unequally.
        let askew = airframe(
            [10.0, 70.0, 190.0, 250.0, 100.0, 280.0],
            [CW, CCW, CCW, CW, CW, CCW],
        );
        assert_eq!(askew.check(), Ok(()));
        let axes = askew.axes();
        for (demanded, axis) in axes.iter().enumerate() {
            let own = askew.own_part(&axes, axis);
            let step = axis.unit / dot(&own, &own);
            let steps = own.map(|part| exact_zero(part * step));
            assert!(steps.iter().sum::<f64>().abs() < 1e-9);
            for (at, Axis { pattern, unit, .. }) in axes.iter().enumerate() {
                let expected = if at == demanded { *unit } else { 0.0 };
                assert!((dot(pattern, &steps) - expected).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn what_was_written_is_read() {
        let quad = airframe([45.0, 225.0, 315.0, 135.0], [CCW, CCW, CW, CW]);
        let mut bytes = std::vec::Vec::new();
        quad.write(&mut |number| bytes.push(number));
        assert_eq!(bytes.len(), Airframe::WORDS);
        let read = |bytes: std::vec::Vec<[u8; 4]>| {
            let mut left = bytes.into_iter();
            Airframe::read(&mut || left.next())
        };
        assert_eq!(read(bytes.clone()), Some(quad));
        bytes[1] = 9.0_f32.to_le_bytes();
        let nine = read(bytes.clone()).expect("complete");
        assert_eq!(nine.check(), Err(AirframeError::Count(9)));
        bytes.pop();
        assert_eq!(read(bytes), None);
    }

    #[test]
    fn directions_and_least_commands_that_are_none_are_refused() {
        for wrong in [-1.0, 360.0, f32::NAN] {
            let message = refusal([wrong, 225.0, 315.0, 135.0], [CCW, CCW, CW, CW]);
            assert!(
                message.ends_with("degrees are out of range, must be 0 to 360, 360 excluded"),
                "{message}"
            );
        }
        for wrong in [-0.1, 0.31, f32::NAN] {
            let airframe = Airframe {
                armed_minimum: wrong,
                ..airframe([45.0, 225.0, 315.0, 135.0], [CCW, CCW, CW, CW])
            };
            assert!(matches!(
                airframe.check(),
                Err(AirframeError::ArmedMinimum(_))
            ));
        }
    }

    #[test]
    fn a_quadrotor_moves_every_motor_by_the_whole_demand() {
        let quad = airframe([45.0, 225.0, 315.0, 135.0], [CCW, CCW, CW, CW]);
        let [roll, pitch, yaw] = quad.allocation();
        assert_eq!(roll[..4], [-1.0, 1.0, 1.0, -1.0]);
        assert_eq!(pitch[..4], [1.0, -1.0, 1.0, -1.0]);
        assert_eq!(yaw[..4], [1.0, 1.0, -1.0, -1.0]);
    }
}
