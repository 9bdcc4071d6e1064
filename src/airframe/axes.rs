//! What a change of the motor command does: about three axes, and along the thrust.

use super::{Mixer, MotorShares};
use crate::math::sqrt;

/// Roll, pitch, yaw and thrust, as the motors of an airframe move them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes([MotorShares; Axes::COUNT]);

impl Axes {
    /// Roll, pitch, yaw, thrust.
    pub const COUNT: usize = 4;

    /// The axes of a mixer's airframe, each of this weight.
    ///
    /// A change that moves every motor along an axis by a share of full scale is that share of it,
    /// whatever the motors' levers; with levers of several lengths, the root mean square.
    #[must_use]
    pub fn weighted(mixer: &Mixer, weights: [f32; Self::COUNT]) -> Self {
        let [roll, pitch, yaw] = mixer.axes();
        let [of_roll, of_pitch, of_yaw, of_thrust] = weights;
        let level = of_thrust / roll.len() as f32;
        Self([
            along(roll, of_roll),
            along(pitch, of_pitch),
            along(yaw, of_yaw),
            MotorShares::all(level, roll.len()),
        ])
    }

    /// How far a command lies from another one.
    #[must_use]
    pub fn between(&self, from: &MotorShares, to: &MotorShares) -> [f32; Self::COUNT] {
        let mut change = *to;
        for (change, from) in change.iter_mut().zip(from.iter()) {
            *change -= from;
        }
        let along = |axis: &MotorShares| axis.fold_with(&change, 0.0, |sum, a, b| sum + a * b);
        self.0.each_ref().map(along)
    }
}

fn along(steps: &[f32], weight: f32) -> MotorShares {
    let square: f32 = steps.iter().map(|step| step * step).sum();
    let scale = weight / sqrt(square * steps.len() as f32);
    let mut axis = MotorShares::all(0.0, steps.len());
    for (axis, step) in axis.iter_mut().zip(steps) {
        *axis = step * scale;
    }
    axis
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::LevelFirst;
    use crate::math::Vec3;
    use crate::units::{Thrust, TorqueDemand};

    const EVEN: [f32; 4] = [1.0; 4];

    fn command(torque: [f32; 3], thrust: f32) -> MotorShares {
        let thrust = Thrust::new(thrust).expect("in range");
        let torque = TorqueDemand(Vec3::from_array(torque));
        Mixer::default().mix(torque, thrust, &LevelFirst).shares
    }

    #[test]
    fn a_demand_about_one_axis_moves_that_axis_alone() {
        let axes = Axes::weighted(&Mixer::default(), EVEN);
        let level = command([0.0; 3], 0.5);
        for axis in 0..3 {
            let mut torque = [0.0; 3];
            torque[axis] = 0.05;
            let moved = axes.between(&level, &command(torque, 0.5));
            for (other, moved) in moved.into_iter().enumerate() {
                assert_eq!(moved.abs() > 1e-6, other == axis, "{axis} {other} {moved}");
            }
        }
    }

    #[test]
    fn thrust_is_the_mean_share_and_weights_scale() {
        let change = |weights| {
            let axes = Axes::weighted(&Mixer::default(), weights);
            axes.between(&MotorShares::all(0.5, 4), &MotorShares::all(0.6, 4))[3]
        };
        assert!((change(EVEN) - 0.1).abs() < 1e-6);
        assert!((change([1.0, 1.0, 1.0, 0.5]) - 0.05).abs() < 1e-6);
    }
}
