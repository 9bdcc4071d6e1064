//! The mixer: torque demands and collective thrust to one command per motor.
//!
//! The allocation comes from the geometry of the airframe, not from a typed table: it is worked
//! out once, at the start. An airframe has four, six or eight motors, as half of them turn one
//! way: [`Mixer`] tells these apart once a run, so that the loops of a [`Sharing`] are straight
//! lines.

mod evenly;
mod level_first;

use super::MotorShares;
use crate::config::GEOMETRY;
use crate::math::{max, min, towards};
use crate::settings::{Airframe, MOST_MOTORS};
use crate::units::{Thrust, TorqueDemand};

pub use evenly::Evenly;
pub use level_first::LevelFirst;

/// The mixer of an airframe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixer(BySize);

#[derive(Clone, Copy, Debug, PartialEq)]
enum BySize {
    Four(Allocation<4>),
    Six(Allocation<6>),
    Eight(Allocation<8>),
}

/// Share of full scale that each axis moves each motor by, per unit of demand.
///
/// A unit of roll or pitch is the torque of all motors at full scale on 1/sqrt(2) of an arm, the
/// lever of an X quadrotor's motors; of yaw, the reaction of all propellers at full scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Allocation<const N: usize> {
    /// For a torque that lowers the right side.
    pub roll: [f32; N],
    /// For a torque that raises the nose.
    pub pitch: [f32; N],
    /// For a torque that turns the nose to the right.
    pub yaw: [f32; N],
    /// The least command of an armed motor, as a share of full scale.
    pub least: f32,
}

/// A motor vector and whether a demand had to be cut to reach it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixed {
    /// One command per motor, from the smallest an armed motor may have to 1.
    pub shares: MotorShares,
    /// Some demand was cut: the integrators must not grow.
    pub saturated: bool,
    /// How far (share of full scale) the motors may move before a demand is cut; 0 or less where
    /// one was.
    pub slack: f32,
}

/// What a command asks of the body, whatever that weighs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Asked {
    /// About roll and about pitch, as shares on a whole arm.
    torque: [f32; 2],
    /// Mean share.
    pub lift: f32,
}

impl Asked {
    /// Part of the way to another.
    #[must_use]
    pub fn towards(&self, other: &Self, share: f32) -> Self {
        let [lift] = towards([self.lift], [other.lift], share);
        Self {
            torque: towards(self.torque, other.torque, share),
            lift,
        }
    }

    /// Torque about roll and about pitch in motors on a whole arm, which lift as all do in the
    /// mean, but this share at least.
    #[must_use]
    pub fn motors(&self, least: f32) -> [f32; 2] {
        let lift = 1.0 / max(self.lift, least);
        self.torque.map(|torque| torque * lift)
    }
}

/// The result of a [`Sharing`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shared<const N: usize> {
    /// One command per motor.
    pub shares: [f32; N],
    /// Some demand was cut.
    pub cut: bool,
    /// How much a demand may grow before a limit of the rule's own cuts it; infinite where a motor
    /// at the end of its range is all that does.
    pub spare: f32,
}

/// How the motors' range is shared where it does not suffice for a demand.
pub trait Sharing {
    /// Shares the range out.
    fn share<const N: usize>(
        &self,
        motors: &Allocation<N>,
        torque: TorqueDemand,
        thrust: Thrust,
    ) -> Shared<N>;
}

/// The mixer of the airframe that was built in.
impl Default for Mixer {
    fn default() -> Self {
        Self::new(&GEOMETRY)
    }
}

impl Mixer {
    /// The mixer of an airframe that was checked.
    #[must_use]
    #[inline(never)]
    pub fn new(airframe: &Airframe) -> Self {
        Self(match airframe.count() {
            ..=4 => BySize::Four(Allocation::of(airframe)),
            5..=6 => BySize::Six(Allocation::of(airframe)),
            _ => BySize::Eight(Allocation::of(airframe)),
        })
    }

    /// How many motors it has.
    #[must_use]
    pub fn motors(&self) -> usize {
        let [roll, ..] = self.axes();
        roll.len()
    }

    /// Share of full scale by which a unit of roll, of pitch, of yaw moves each motor.
    #[must_use]
    pub fn axes(&self) -> [&[f32]; 3] {
        fn axes<const N: usize>(motors: &Allocation<N>) -> [&[f32]; 3] {
            [&motors.roll, &motors.pitch, &motors.yaw]
        }
        match &self.0 {
            BySize::Four(motors) => axes(motors),
            BySize::Six(motors) => axes(motors),
            BySize::Eight(motors) => axes(motors),
        }
    }

    /// The mixer of the motors that are left where one, from 0, is lost; yaw is given up.
    #[must_use]
    #[cold]
    pub fn without(&self, motor: u8) -> Self {
        let motor = usize::from(motor);
        Self(match &self.0 {
            BySize::Four(motors) => BySize::Four(motors.without(motor)),
            BySize::Six(motors) => BySize::Six(motors.without(motor)),
            BySize::Eight(motors) => BySize::Eight(motors.without(motor)),
        })
    }

    /// What a command asks for.
    #[must_use]
    pub fn asked(&self, shares: &MotorShares) -> Asked {
        let [roll, pitch, _] = self.axes();
        let (mut torque, mut lift) = ([0.0; 2], 0.0);
        for ((share, x), y) in shares.iter().zip(roll).zip(pitch) {
            torque = [torque[0] + share * x, torque[1] + share * y];
            lift += share;
        }
        Asked {
            // A unit is a torque on 1/sqrt(2) of an arm.
            torque: torque.map(|torque| torque * core::f32::consts::FRAC_1_SQRT_2),
            lift: lift / roll.len() as f32,
        }
    }

    /// The motor vector of a demand, by a rule where the motors cannot give it all.
    #[must_use]
    #[inline]
    pub fn mix(&self, torque: TorqueDemand, thrust: Thrust, rule: &impl Sharing) -> Mixed {
        match &self.0 {
            BySize::Four(motors) => motors.mixed(rule.share(motors, torque, thrust)),
            BySize::Six(motors) => motors.mixed(rule.share(motors, torque, thrust)),
            BySize::Eight(motors) => motors.mixed(rule.share(motors, torque, thrust)),
        }
    }
}

impl<const N: usize> Allocation<N> {
    fn of(airframe: &Airframe) -> Self {
        let first = |steps: &[f32; MOST_MOTORS]| *steps.first_chunk().unwrap_or(&[0.0; N]);
        let [roll, pitch, yaw] = airframe.allocation().each_ref().map(first);
        Self {
            roll,
            pitch,
            yaw,
            least: airframe.armed_minimum(),
        }
    }

    /// Roll and pitch by the motors that are left, without lift or each other.
    fn without(&self, lost: usize) -> Self {
        let mut left = [1.0; N];
        if let Some(share) = left.get_mut(lost) {
            *share = 0.0;
        }
        let kept = |axis: &[f32; N]| product(axis, &left);
        let (roll, pitch) = (kept(&self.roll), kept(&self.pitch));
        let alone = |axis: &[f32; N], other: &[f32; N], whole: &[f32; N]| {
            let own = beside(&beside(axis, &left), &beside(other, &left));
            let scale = dot(whole, whole) / max(dot(&own, axis), 1e-6);
            own.map(|step| step * scale)
        };
        Self {
            roll: alone(&roll, &pitch, &self.roll),
            pitch: alone(&pitch, &roll, &self.pitch),
            yaw: [0.0; N],
            least: self.least,
        }
    }

    fn mixed(&self, shared: Shared<N>) -> Mixed {
        let room = |slack, share: &f32| min(min(share - self.least, 1.0 - share), slack);
        Mixed {
            slack: shared.shares.iter().fold(shared.spare, room),
            saturated: shared.cut,
            shares: MotorShares::from(shared.shares),
        }
    }

    /// The range of an armed motor's command, as a share of full scale.
    #[must_use]
    pub const fn span(&self) -> f32 {
        1.0 - self.least
    }

    /// What roll and pitch move each motor by.
    #[must_use]
    pub fn tilt(&self, torque: TorqueDemand) -> [f32; N] {
        let mut tilt = self.roll;
        for (tilt, pitch) in tilt.iter_mut().zip(&self.pitch) {
            *tilt = *tilt * torque.0.x + pitch * torque.0.y;
        }
        tilt
    }

    /// These steps beside the thrust: scaled where they are wider than an armed motor's range, on
    /// a thrust that is shifted where they would pass its ends.
    fn fitted(&self, steps: [f32; N], thrust: Thrust) -> Fitted<N> {
        let (lowest, highest) = range(&steps);
        let span = self.span();
        let cut = highest - lowest > span;
        let fit = if cut { span / (highest - lowest) } else { 1.0 };
        let wanted = self.least + thrust.share() * span;
        let base = min(max(self.least - lowest * fit, wanted), 1.0 - highest * fit);
        Fitted {
            shares: steps.map(|step| base + step * fit),
            cut,
            shifted: base != wanted,
        }
    }

    /// A share from the least of an armed motor to 1; what is no number stays so, for the gate
    /// to see.
    fn armed(&self, share: f32) -> f32 {
        if share < self.least {
            self.least
        } else if share > 1.0 {
            1.0
        } else {
            share
        }
    }
}

/// Shares of steps and thrust, inside the range of every motor.
struct Fitted<const N: usize> {
    shares: [f32; N],
    /// The steps were scaled.
    cut: bool,
    /// The thrust is another than that asked for.
    shifted: bool,
}

fn product<const N: usize>(one: &[f32; N], other: &[f32; N]) -> [f32; N] {
    let mut product = *one;
    for (step, other) in product.iter_mut().zip(other) {
        *step *= other;
    }
    product
}

fn dot<const N: usize>(one: &[f32; N], other: &[f32; N]) -> f32 {
    product(one, other).iter().sum()
}

/// What of one pattern is not in another.
fn beside<const N: usize>(one: &[f32; N], other: &[f32; N]) -> [f32; N] {
    let share = dot(one, other) / max(dot(other, other), 1e-6);
    let mut left = *one;
    for (step, other) in left.iter_mut().zip(other) {
        *step -= other * share;
    }
    left
}

/// The smallest and the largest share.
fn range(shares: &[f32]) -> (f32, f32) {
    shares
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &share| {
            (min(share, low), max(share, high))
        })
}

#[cfg(test)]
mod tests;
