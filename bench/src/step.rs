//! What a control logic is given before a run, as words in memory.

use reflex::control::{Goal, Setpoint, Yaw};
use reflex::estimate::{Increment, Place, Rotation};
use reflex::math::{Quaternion, Vec3};
use reflex::units::{BodyRates, Thrust};

/// The inputs that were set since the last run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Step {
    /// Sums of the arrival stage.
    pub motion: Option<Increment>,
    /// Rates and angular acceleration.
    pub rotation: Option<Rotation>,
    /// The error of the heading, rad.
    pub heading: Option<Option<f32>>,
    /// What to fly.
    pub setpoint: Option<Setpoint>,
    /// Where to fly.
    pub goal: Option<Option<Goal>>,
    /// Where the drone is.
    pub place: Option<Place>,
    /// No motion is seen.
    pub blind: Option<bool>,
}

/// Words of one step.
pub const STEP_WORDS: usize = 48;

/// Bits of a step's first word.
mod flag {
    pub const MOTION: u32 = 1;
    pub const ROTATION: u32 = 1 << 1;
    pub const HEADING: u32 = 1 << 2;
    pub const SETPOINT: u32 = 1 << 3;
    pub const GOAL: u32 = 1 << 4;
    pub const PLACE: u32 = 1 << 5;
    pub const BLIND: u32 = 1 << 6;
    pub const SOME_HEADING: u32 = 1 << 7;
    pub const SOME_ATTITUDE: u32 = 1 << 8;
    pub const HOLDS_HEADING: u32 = 1 << 9;
    pub const SOME_GOAL: u32 = 1 << 10;
    pub const IS_BLIND: u32 = 1 << 11;
}

/// Writes or reads words one after the other: the same code says the order for both ways.
trait Words {
    fn number(&mut self, value: &mut f32);
    fn flag(&mut self, bit: u32, value: &mut bool);

    fn axes(&mut self, value: &mut Vec3) {
        self.number(&mut value.x);
        self.number(&mut value.y);
        self.number(&mut value.z);
    }
}

struct Writer {
    words: [u32; STEP_WORDS],
    at: usize,
}

impl Words for Writer {
    fn number(&mut self, value: &mut f32) {
        if let Some(word) = self.words.get_mut(self.at) {
            *word = value.to_bits();
        }
        self.at += 1;
    }

    fn flag(&mut self, bit: u32, value: &mut bool) {
        if *value {
            self.words[0] |= bit;
        }
    }
}

struct Reader<'a> {
    words: &'a [u32; STEP_WORDS],
    at: usize,
}

impl Words for Reader<'_> {
    fn number(&mut self, value: &mut f32) {
        *value = self
            .words
            .get(self.at)
            .map_or(0.0, |word| f32::from_bits(*word));
        self.at += 1;
    }

    fn flag(&mut self, bit: u32, value: &mut bool) {
        *value = self.words[0] & bit != 0;
    }
}

/// A step with every field there, and which of them are.
#[derive(Default)]
struct Flat {
    step: [bool; 7],
    motion: Increment,
    rotation: Rotation,
    heading: Optional<f32>,
    attitude: Optional<Quaternion>,
    rates: Vec3,
    holds_heading: bool,
    thrust: f32,
    goal: Optional<Goal>,
    place: Place,
    blind: bool,
}

/// An option whose value has a place in memory all the same.
#[derive(Default)]
struct Optional<T> {
    there: bool,
    value: T,
}

impl<T: Default> From<Option<T>> for Optional<T> {
    fn from(option: Option<T>) -> Self {
        Self {
            there: option.is_some(),
            value: option.unwrap_or_default(),
        }
    }
}

impl<T> From<Optional<T>> for Option<T> {
    fn from(optional: Optional<T>) -> Self {
        optional.there.then_some(optional.value)
    }
}

impl Flat {
    fn pass(&mut self, words: &mut impl Words) {
        let marks = [
            flag::MOTION,
            flag::ROTATION,
            flag::HEADING,
            flag::SETPOINT,
            flag::GOAL,
            flag::PLACE,
            flag::BLIND,
        ];
        for (mark, there) in marks.into_iter().zip(&mut self.step) {
            words.flag(mark, there);
        }
        for axes in [
            &mut self.motion.angle,
            &mut self.motion.coning,
            &mut self.motion.swept,
            &mut self.motion.velocity,
            &mut self.motion.down,
            &mut self.rotation.rates.0,
            &mut self.rotation.acceleration,
            &mut self.rates,
            &mut self.attitude.value.v,
            &mut self.goal.value.position.0,
            &mut self.goal.value.velocity.0,
            &mut self.place.position.0,
            &mut self.place.velocity.0,
        ] {
            words.axes(axes);
        }
        for number in [
            &mut self.motion.dt,
            &mut self.heading.value,
            &mut self.attitude.value.w,
            &mut self.thrust,
            &mut self.goal.value.heading,
            &mut self.place.dt,
        ] {
            words.number(number);
        }
        words.flag(flag::SOME_HEADING, &mut self.heading.there);
        words.flag(flag::SOME_ATTITUDE, &mut self.attitude.there);
        words.flag(flag::HOLDS_HEADING, &mut self.holds_heading);
        words.flag(flag::SOME_GOAL, &mut self.goal.there);
        words.flag(flag::IS_BLIND, &mut self.blind);
    }
}

impl Step {
    /// True where every input is set: then time-triggered control computes the same.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.motion.is_some()
            && self.rotation.is_some()
            && self.heading.is_some()
            && self.setpoint.is_some()
            && self.goal.is_some()
            && self.place.is_some()
            && self.blind.is_some()
    }

    /// These inputs, and those of another step where this one has none.
    #[must_use]
    pub fn over(&self, other: &Self) -> Self {
        Self {
            motion: self.motion.or(other.motion),
            rotation: self.rotation.or(other.rotation),
            heading: self.heading.or(other.heading),
            setpoint: self.setpoint.or(other.setpoint),
            goal: self.goal.or(other.goal),
            place: self.place.or(other.place),
            blind: self.blind.or(other.blind),
        }
    }

    /// As words.
    #[must_use]
    pub fn to_words(&self) -> [u32; STEP_WORDS] {
        let setpoint = self.setpoint.unwrap_or_default();
        let mut flat = Flat {
            step: [
                self.motion.is_some(),
                self.rotation.is_some(),
                self.heading.is_some(),
                self.setpoint.is_some(),
                self.goal.is_some(),
                self.place.is_some(),
                self.blind.is_some(),
            ],
            motion: self.motion.unwrap_or_default(),
            rotation: self.rotation.unwrap_or_default(),
            heading: self.heading.flatten().into(),
            attitude: setpoint.attitude.into(),
            rates: setpoint.rates.0,
            holds_heading: setpoint.yaw == Yaw::Heading,
            thrust: setpoint.thrust.share(),
            goal: self.goal.flatten().into(),
            place: self.place.unwrap_or_default(),
            blind: self.blind.unwrap_or_default(),
        };
        let mut writer = Writer {
            words: [0; STEP_WORDS],
            at: 1,
        };
        flat.pass(&mut writer);
        writer.words
    }

    /// From words.
    #[must_use]
    pub fn from_words(words: &[u32; STEP_WORDS]) -> Self {
        let mut flat = Flat::default();
        flat.pass(&mut Reader { words, at: 1 });
        let [motion, rotation, heading, setpoint, goal, place, blind] = flat.step;
        let flown = Setpoint {
            attitude: flat.attitude.into(),
            rates: BodyRates(flat.rates),
            yaw: if flat.holds_heading {
                Yaw::Heading
            } else {
                Yaw::Rate
            },
            thrust: Thrust::new(flat.thrust).unwrap_or_default(),
        };
        Self {
            motion: motion.then_some(flat.motion),
            rotation: rotation.then_some(flat.rotation),
            heading: heading.then_some(flat.heading.into()),
            setpoint: setpoint.then_some(flown),
            goal: goal.then_some(flat.goal.into()),
            place: place.then_some(flat.place),
            blind: blind.then_some(flat.blind),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflex::units::{Position, Velocity};

    #[test]
    fn what_was_written_is_read() {
        let axes = |x: f32| Vec3::new(x, x + 0.1, x + 0.2);
        let full = Step {
            motion: Some(Increment {
                angle: axes(1.0),
                coning: axes(2.0),
                swept: axes(3.0),
                velocity: axes(4.0),
                down: axes(5.0),
                dt: 0.01,
            }),
            rotation: Some(Rotation {
                rates: BodyRates(axes(6.0)),
                acceleration: axes(7.0),
            }),
            heading: Some(Some(0.25)),
            setpoint: Some(Setpoint {
                attitude: Some(Quaternion::from_heading(0.5)),
                rates: BodyRates(axes(8.0)),
                yaw: Yaw::Heading,
                thrust: Thrust::new(0.75).expect("in range"),
            }),
            goal: Some(Some(Goal {
                position: Position(axes(9.0)),
                velocity: Velocity(axes(10.0)),
                heading: 0.5,
            })),
            place: Some(Place {
                position: Position(axes(11.0)),
                velocity: Velocity(axes(12.0)),
                dt: 0.02,
            }),
            blind: Some(true),
        };
        for step in [full, Step::default()] {
            assert_eq!(Step::from_words(&step.to_words()), step);
        }
    }
}
