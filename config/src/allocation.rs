//! From where the motors are to what each must do for a torque.
//!
//! Each axis has a *pattern*: what a share of full scale on each motor does about it. What of a
//! pattern lies across all others is the *own* part: moving the motors along it acts on that axis
//! alone, and nothing that does so moves them less. Scaled, these are the columns of the
//! pseudo-inverse of the patterns; they are found by Gram-Schmidt.

use std::f64::consts::SQRT_2;

use crate::{Motor, Spin};

/// Least authority about an axis, where 1 is that of evenly spaced arms.
const LEAST_AUTHORITY: f64 = 0.2;
/// Most lever of equal thrust on all motors, in arms.
const MOST_PULL: f64 = 0.01;
/// Squares of lengths below this are rounding.
const ROUNDING: f64 = 1e-12;

/// Share of full scale by which a unit of demand moves each motor.
///
/// A unit is the same torque per motor on every airframe: of roll and pitch, all motors' full
/// scale on the lever that the motors of an X quadrotor have, 1/sqrt(2) of an arm; of yaw, the
/// reaction of all propellers at full scale. So gains carry over between airframes, but for
/// what their inertia differs by.
#[derive(Clone, Debug, PartialEq)]
pub struct Allocation {
    /// For a torque that lowers the right side.
    pub roll: Vec<f64>,
    /// For a torque that raises the nose.
    pub pitch: Vec<f64>,
    /// For a torque that turns the nose to the right.
    pub yaw: Vec<f64>,
}

impl Allocation {
    /// The allocation of motors that [`check`] accepts.
    pub(crate) fn of(motors: &[Motor]) -> Self {
        let axes = Axis::of(motors);
        let [roll, pitch, yaw] = [0, 1, 2].map(|place| {
            let own = own_part(&axes, place, motors.len());
            let step = axes[place].unit / dot(&own, &own);
            own.iter().map(|part| exact_zero(part * step)).collect()
        });
        Self { roll, pitch, yaw }
    }
}

/// Refuses motors that cannot hold a drone level, or cannot turn it about one axis alone.
pub(crate) fn check(motors: &[Motor]) -> Result<(), String> {
    let count = motors.len() as f64;
    let axes = Axis::of(motors);
    for axis in &axes {
        let pull = axis.pattern.iter().sum::<f64>() / count;
        if pull.abs() > MOST_PULL {
            return Err(format!(
                "equal thrust would {}: the mean lever is {:.2} of an arm, at most {MOST_PULL}",
                axis.name,
                pull.abs()
            ));
        }
    }
    for (place, axis) in axes.iter().enumerate() {
        let own = own_part(&axes, place, motors.len());
        let authority = dot(&own, &own) * count / (axis.unit * axis.unit);
        if authority < LEAST_AUTHORITY {
            return Err(format!(
                "authority to {} and nothing else is {authority:.2} of the usual, must be at least \
                 {LEAST_AUTHORITY}: spread the arms, and let neighbours turn opposite ways",
                axis.name
            ));
        }
    }
    Ok(())
}

/// One axis of torque.
struct Axis {
    name: &'static str,
    /// Torque per share of full scale, in arms for roll and pitch, in reactions for yaw.
    pattern: Vec<f64>,
    /// The torque that a unit of demand stands for.
    unit: f64,
}

impl Axis {
    /// Roll, pitch and yaw; a motor on the right rolls to the left.
    fn of(motors: &[Motor]) -> [Self; 3] {
        let pattern = |effect: fn(&Motor) -> f64| motors.iter().map(effect).collect();
        let count = motors.len() as f64;
        [
            Self {
                name: "roll",
                pattern: pattern(|motor| -motor.angle_deg.to_radians().sin()),
                unit: count / SQRT_2,
            },
            Self {
                name: "pitch",
                pattern: pattern(|motor| motor.angle_deg.to_radians().cos()),
                unit: count / SQRT_2,
            },
            Self {
                name: "yaw",
                // The body turns against the propeller.
                pattern: pattern(|motor| match motor.spin {
                    Spin::Cw => -1.0,
                    Spin::Ccw => 1.0,
                }),
                unit: count,
            },
        ]
    }
}

/// What of an axis' pattern acts on no other axis, nor on the thrust.
fn own_part(axes: &[Axis; 3], place: usize, motors: usize) -> Vec<f64> {
    let mut others = vec![vec![1.0; motors]];
    for (_, other) in axes.iter().enumerate().filter(|(at, _)| *at != place) {
        let part = across(&other.pattern, &others);
        if dot(&part, &part) > ROUNDING {
            others.push(part);
        }
    }
    across(&axes[place].pattern, &others)
}

/// What of a pattern lies across all of some that lie across each other.
fn across(pattern: &[f64], others: &[Vec<f64>]) -> Vec<f64> {
    others.iter().fold(pattern.to_vec(), |rest, other| {
        let along = dot(&rest, other) / dot(other, other);
        rest.iter().zip(other).map(|(r, o)| r - along * o).collect()
    })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A motor on an axis has no lever: what rounding left of it would only be hard to read.
fn exact_zero(step: f64) -> f64 {
    if step * step < ROUNDING { 0.0 } else { step }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Spin::{Ccw, Cw};

    fn motors<const N: usize>(angles: [f64; N], spins: [Spin; N]) -> Vec<Motor> {
        let pairs = angles.into_iter().zip(spins);
        pairs
            .map(|(angle_deg, spin)| Motor { angle_deg, spin })
            .collect()
    }

    fn refusal<const N: usize>(angles: [f64; N], spins: [Spin; N]) -> String {
        check(&motors(angles, spins)).expect_err("refused")
    }

    #[test]
    fn arms_along_one_line_cannot_turn_about_it() {
        let message = refusal([0.0, 180.0, 0.0, 180.0], [Cw, Cw, Ccw, Ccw]);
        assert!(message.contains("to roll and nothing else is 0.00 of the usual"));
        let message = refusal([45.0, 225.0, 45.0, 225.0], [Cw, Cw, Ccw, Ccw]);
        assert!(message.contains("to roll and nothing else is 0.00 of the usual"));
        let message = refusal([90.0, 270.0, 90.0, 270.0], [Cw, Cw, Ccw, Ccw]);
        assert!(message.contains("to pitch and nothing else is 0.00 of the usual"));
    }

    #[test]
    fn a_side_that_turns_one_way_cannot_yaw_without_rolling() {
        let message = refusal([45.0, 135.0, 225.0, 315.0], [Cw, Cw, Ccw, Ccw]);
        assert!(message.contains("to roll and nothing else is 0.00 of the usual"));
        let message = refusal(
            [30.0, 90.0, 150.0, 210.0, 270.0, 330.0],
            [Cw, Cw, Cw, Ccw, Ccw, Ccw],
        );
        // 1 less the square of the cosine between the patterns, (4 / sqrt(3 * 6))^2.
        assert!(message.contains("to roll and nothing else is 0.11 of the usual"));
    }

    #[test]
    fn arms_that_gather_in_front_would_raise_the_nose() {
        let message = refusal([30.0, 330.0, 120.0, 240.0], [Cw, Ccw, Ccw, Cw]);
        // (2 cos 30 - 2 cos 60) / 4.
        assert!(
            message.contains("would pitch: the mean lever is 0.18 of an arm"),
            "{message}"
        );
    }

    #[test]
    fn arms_askew_are_told_apart_all_the_same() {
        // Rows of arms at 20 and 110 degrees: roll and pitch share motors unequally.
        let askew = motors(
            [10.0, 70.0, 190.0, 250.0, 100.0, 280.0],
            [Cw, Ccw, Ccw, Cw, Cw, Ccw],
        );
        assert_eq!(check(&askew), Ok(()));
        let Allocation { roll, pitch, yaw } = Allocation::of(&askew);
        let axes = Axis::of(&askew);
        for (demanded, steps) in [roll, pitch, yaw].iter().enumerate() {
            assert!(steps.iter().sum::<f64>().abs() < 1e-9);
            for (axis, Axis { pattern, unit, .. }) in axes.iter().enumerate() {
                let expected = if axis == demanded { *unit } else { 0.0 };
                assert!((dot(pattern, steps) - expected).abs() < 1e-9);
            }
        }
    }
}
