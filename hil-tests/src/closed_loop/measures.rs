//! What a flight is judged by, gathered while it lasts.

use nalgebra::Vector3;
use reflex::app::{Ran, Reason};

use super::desired::Desired;
use super::mission::Target;
use crate::scoring::ByReason;

/// A root of a mean of squares.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rms {
    sum: f64,
    count: u64,
}

impl Rms {
    pub(super) fn add(&mut self, value: f64) {
        self.sum += value * value;
        self.count += 1;
    }

    /// The root of the mean square; none without a value.
    pub(super) fn value(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.sum / self.count as f64).sqrt())
    }
}

/// A whole flight so far; errors, runs and energy of its scored part.
#[derive(Clone, Debug, Default)]
pub(super) struct Measures {
    /// Desired less actual roll, pitch and yaw, rad.
    pub(super) attitude: [Rms; 3],
    /// Distance from where the drone shall be, m.
    pub(super) position: Rms,
    /// Body rates, rad/s.
    pub(super) turning: Rms,
    /// Runs of each second of the flight, from take-off.
    pub(super) per_second: Vec<u32>,
    /// Runs by reason.
    pub(super) by_reason: ByReason<u64>,
    /// Runs whose command differs from the one before by a quantum or more.
    pub(super) changed: u64,
    /// The newest command.
    command: Option<Vec<f32>>,
}

impl Measures {
    /// A look at the drone in the scored part.
    pub(super) fn look(
        &mut self,
        desired: &Desired,
        actual: [f64; 3],
        (target, position): (&Target, &Vector3<f64>),
    ) {
        for (rms, off) in self.attitude.iter_mut().zip(desired.less(actual)) {
            if let Some(off) = off {
                rms.add(off);
            }
        }
        self.position.add((target.position - position).norm());
    }

    /// A run, so many seconds behind take-off.
    pub(super) fn ran(&mut self, ran: &Ran, since_s: f64, scored: bool, quantum: f32) {
        if ran.reason == Reason::Ground || since_s < 0.0 {
            return;
        }
        let second = since_s as usize;
        if self.per_second.len() <= second {
            self.per_second.resize(second + 1, 0);
        }
        self.per_second[second] += 1;
        let before = self.command.replace(ran.shares.to_vec());
        if scored {
            *self.by_reason.get_mut(ran.reason) += 1;
            let differs = |before: Vec<f32>| {
                let mut pairs = before.iter().zip(ran.shares.iter());
                pairs.any(|(before, after)| (before - after).abs() >= quantum)
            };
            self.changed += u64::from(before.is_none_or(differs));
        }
    }

    /// Runs of the scored part.
    pub(super) fn runs(&self) -> u64 {
        self.by_reason.named().iter().map(|named| *named.1).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflex::sensors::Inputs;

    fn ran(reason: Reason, share: f32) -> Ran {
        Ran {
            reason,
            asked: Inputs::NONE,
            expected: None,
            shares: reflex::airframe::MotorShares::all(share, 4),
        }
    }

    #[test]
    fn runs_count_by_second_always_and_by_reason_where_scored() {
        let mut measures = Measures::default();
        for (reason, share, at_s, scored) in [
            (Reason::Ground, 0.0, -0.1, false),
            (Reason::WarmUp, 0.5, 0.2, false),
            (Reason::Trigger, 0.5, 2.1, true),
            (Reason::Trigger, 0.6, 2.2, true),
            (Reason::Failsafe, 0.6, 2.3, true),
        ] {
            measures.ran(&ran(reason, share), at_s, scored, 1.0 / 255.0);
        }
        assert_eq!(measures.per_second, [1, 0, 3]);
        assert_eq!(
            (measures.by_reason.trigger, measures.by_reason.failsafe),
            (2, 1)
        );
        assert_eq!((measures.runs(), measures.changed), (3, 1));
    }

    #[test]
    fn an_axis_that_is_not_asked_for_has_no_error() {
        let mut measures = Measures::default();
        let target = Target {
            position: Vector3::new(3.0, 4.0, 0.0),
            velocity: Vector3::zeros(),
            heading: 0.0,
        };
        let desired = Desired([Some(0.1), Some(-0.1), None]);
        measures.look(&desired, [0.0, 0.1, 1.0], (&target, &Vector3::zeros()));
        let [roll, pitch, yaw] = measures.attitude.map(|rms| rms.value());
        assert!((roll.unwrap() - 0.1).abs() < 1e-12 && (pitch.unwrap() - 0.2).abs() < 1e-12);
        assert_eq!(yaw, None);
        assert_eq!(measures.position.value(), Some(5.0));
    }
}
