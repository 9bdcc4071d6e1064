//! Soundings: how a control logic answers each feature of a motion.

use crate::airframe::{Axes, Mixed};
use crate::estimate::{Increment, Motion, Rotation, trusted_down};
use crate::graph::ControlLogic;
use crate::math::Vec3;
use crate::numbered::numbered;
use crate::reactive::owed::OfAxes;

/// The time (s) that a sounding lets pass: a few samples.
const TIME: f32 = 0.005;

numbered! {
    /// What a command moves with; three axes of each in a row.
    Feature {
        /// Rate of roll.
        RollRate,
        /// Rate of pitch.
        PitchRate,
        /// Rate of yaw.
        YawRate,
        /// Angular acceleration of roll.
        RollAcceleration,
        /// Angular acceleration of pitch.
        PitchAcceleration,
        /// Angular acceleration of yaw.
        YawAcceleration,
        /// Angle turned about roll.
        RollAngle,
        /// Angle turned about pitch.
        PitchAngle,
        /// Angle turned about yaw.
        YawAngle,
        /// Time: what integrals and estimates do by themselves.
        Time,
    }
}

/// What a sounding found of one feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// The feature.
    pub feature: Feature,
    /// The move of each axis: a weighted share of full scale per rad/s, rad/s2, rad or s.
    pub of_axes: OfAxes,
}

/// How the body moves at the moment of a sounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Situation {
    /// The newest rotation.
    pub rotation: Rotation,
    /// The filtered specific force, in m/s2.
    pub force: Vec3,
    /// The error of the heading (rad), where it is measured.
    pub heading: Option<f32>,
}

/// A copy of a control logic, to be asked what it would do.
#[derive(Clone, Debug)]
pub struct Sounding<L> {
    logic: L,
    axes: Axes,
    /// The motion gone on for a few samples.
    motion: Motion,
    heading: Option<f32>,
}

impl Feature {
    /// The bits of every feature.
    pub(super) const EVERY: u16 = (1 << Self::COUNT) - 1;

    pub(super) const fn bit(self) -> u16 {
        1 << self as u16
    }

    /// By how much it is moved: what turbulence does within a few samples.
    fn step(self) -> f32 {
        match self as u8 / 3 {
            0 => 0.05,
            1 => 2.0,
            2 => 0.01,
            _ => TIME,
        }
    }

    /// The motion with this feature moved by its step.
    fn moved(self, mut motion: Motion) -> Motion {
        let step = self.step();
        let along = match self as u8 % 3 {
            0 => Vec3::new(step, 0.0, 0.0),
            1 => Vec3::new(0.0, step, 0.0),
            _ => Vec3::new(0.0, 0.0, step),
        };
        match self as u8 / 3 {
            0 => motion.rotation.rates.0 += along,
            1 => motion.rotation.acceleration += along,
            _ => {
                motion.sums.angle += along;
                motion.sums.swept += along * (0.5 * TIME);
            }
        }
        motion
    }
}

impl<L: ControlLogic + Clone> Sounding<L> {
    /// Of a logic as it is now, in this situation.
    pub(in crate::reactive) fn new(logic: &L, axes: &Axes, situation: &Situation) -> Self {
        let &Situation {
            rotation,
            force,
            heading,
        } = situation;
        let angle = rotation.rates.0 * TIME;
        let sums = Increment {
            angle,
            swept: angle * (0.5 * TIME),
            velocity: force * TIME,
            down: trusted_down(force) * TIME,
            dt: TIME,
            ..Increment::default()
        };
        Self {
            logic: logic.clone(),
            axes: *axes,
            motion: Motion { sums, rotation },
            heading,
        }
    }

    /// What each feature does to the command; nothing more from where a demand is cut on.
    ///
    /// The long part: it runs the logic ten times, without any lock.
    pub fn columns(mut self) -> impl Iterator<Item = Column> {
        let base = self.foresee(self.motion);
        let turned = self.motion.sums.angle.to_array();
        let mut drifted = self.axes.between(&self.logic.mixed().shares, &base.shares);
        let mut features = Feature::ALL.iter();
        core::iter::from_fn(move || {
            let &feature = features.next()?;
            let moved = if feature == Feature::Time {
                drifted
            } else {
                let moved = self.foresee(feature.moved(self.motion));
                (!moved.saturated).then_some(())?;
                self.axes.between(&base.shares, &moved.shares)
            };
            let of_axes = moved.map(|moved| moved / feature.step());
            // What the turn did meanwhile is no drift.
            if let Some(turned) = turned_by(feature, &turned) {
                for (drifted, slope) in drifted.iter_mut().zip(of_axes) {
                    *drifted -= slope * turned;
                }
            }
            (!base.saturated).then_some(Column { feature, of_axes })
        })
        .fuse()
    }

    fn foresee(&mut self, motion: Motion) -> Mixed {
        self.logic.take(&motion, self.heading);
        self.logic.foresee()
    }
}

/// The angle (rad) of a feature that is one.
fn turned_by(feature: Feature, turned: &[f32; 3]) -> Option<f32> {
    let axis = (feature as usize).checked_sub(Feature::RollAngle as usize)?;
    turned.get(axis).copied()
}
