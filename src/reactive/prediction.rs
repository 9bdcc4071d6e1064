//! The command that a run would compute, to first order.
//!
//! Between two runs a command moves with what the body does: its rates, its angular acceleration,
//! the angle that it turned. Where the body does nothing it drifts, as integrals grow and
//! estimates are put right. Around the last run:
//!
//! ```text
//! command = at the last run + slopes * (rates, acceleration, angle turned since) + drift * time
//! ```
//!
//! Slopes and a first drift are differences of the control logic itself, which a [`Sounding`]
//! takes in idle; nothing here knows which logic it is. Every run shows by how much the prediction
//! missed, and puts the drift right.
//!
//! What is wanted of it is its integral over time, the [`Impulse`]. That is linear in sums which
//! the arrival stage keeps anyway, so nothing is integrated here: a [`Form`] holds coefficients,
//! and a sample costs eleven products for each axis.
//!
//! What cuts a demand is not linear. Where the last run left little slack, and before the first
//! sounding, the command is foreseen exactly, and its impulse summed.

mod form;
mod sounding;
#[cfg(test)]
mod tests;

pub use sounding::{Column, Feature, Situation, Sounding};

use super::owed::{Impulse, OfAxes};
use crate::airframe::{Axes, Mixed, MotorShares};
use crate::estimate::{Motion, Rotation};
use crate::time::{Duration, Instant, micros};
use form::{Form, Slopes};

/// Slack (share of full scale) of a run below which what follows is foreseen exactly: by as much a
/// command may move within a millisecond before the budget is used up.
const LEAST_SLACK: f32 = 0.05;

/// A miss (weighted share of full scale) that refutes the slopes where it comes twice in a row.
///
/// On five recorded flights with four logics one miss in a thousand is above 0.09 at most, and none
/// above 0.1 is followed by another.
const WORST_MISS: f32 = 0.1;

/// Time between two soundings: slopes follow thrust and tilt.
const INTERVAL: Duration = micros(250_000);

/// A drift that was seen over this time (s) is believed by half.
const DRIFT_TIME: f32 = 0.005;

/// What the held command owes, by prediction where that suffices.
#[derive(Clone, Debug)]
pub struct Prediction {
    axes: Axes,
    slopes: Slopes,
    /// Features that were sounded, a bit for each.
    sounded: u16,
    /// The last prediction missed by more than [`WORST_MISS`].
    missed: bool,
    /// When the next sounding is due.
    due: Instant,
    /// The rotation at the last run.
    rotation: Rotation,
    /// The command that the control logic computed last.
    command: MotorShares,
    form: Form,
    /// What is owed as of the last sample.
    owed: Impulse,
    /// By how much the command that was foreseen last is off from the held one.
    foreseen_off: OfAxes,
    /// The time (s) since the last run that `owed` covers, where it is summed.
    covered: f32,
    /// Commands are foreseen exactly until the next run.
    exact: bool,
}

impl Prediction {
    /// About these axes of so many motors, for a control logic whose angular acceleration is
    /// filtered at a corner (Hz).
    #[must_use]
    pub fn new(axes: Axes, motors: usize, derivative_cutoff: f32) -> Self {
        let (slopes, still) = (Slopes::new(derivative_cutoff), Rotation::default());
        Self {
            axes,
            slopes,
            sounded: 0,
            missed: false,
            due: Instant::from_ticks(0),
            rotation: still,
            command: MotorShares::all(0.0, motors),
            form: Form::of(&slopes, &still, &OfAxes::default(), &Impulse::default()),
            owed: Impulse::default(),
            foreseen_off: OfAxes::default(),
            covered: 0.0,
            exact: true,
        }
    }

    /// The axes that impulses are about.
    #[must_use]
    pub fn axes(&self) -> &Axes {
        &self.axes
    }

    /// True where commands must be foreseen exactly until the next run.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.exact
    }

    /// What is owed since the last run, as of the last sample.
    #[must_use]
    pub fn owed(&self) -> &Impulse {
        &self.owed
    }

    /// By how much the command is off from the held one after this motion, which was shown.
    #[must_use]
    pub fn off(&self, motion: &Motion) -> OfAxes {
        if self.exact {
            self.foreseen_off
        } else {
            self.form.off(motion)
        }
    }

    /// What is owed after this motion since the last run, by prediction.
    #[inline(never)] // Samples, runs and what joins between them all predict.
    pub fn predict(&mut self, motion: &Motion) -> &Impulse {
        self.owed = self.form.impulse(motion);
        &self.owed
    }

    /// What is owed after this motion, for which a command was foreseen exactly.
    pub fn foresee(
        &mut self,
        command: &MotorShares,
        held: &MotorShares,
        motion: &Motion,
    ) -> &Impulse {
        let off = self.axes.between(held, command);
        self.owed = self.owed.grown(off, motion.sums.dt - self.covered);
        self.foreseen_off = off;
        self.covered = motion.sums.dt;
        &self.owed
    }

    /// The control logic ran on a motion; its command is applied, and nothing owed any more.
    ///
    /// The gate may apply another one than the control logic computed. False where its slopes are
    /// refuted.
    pub fn on_run(&mut self, command: &Mixed, applied: &MotorShares, motion: &Motion) -> bool {
        let sound = self.learn_from(command, motion);
        self.owed = Impulse::default();
        self.begin(command, applied, motion);
        sound
    }

    /// The control logic ran on a motion, but another command is held on: what is owed stays.
    pub fn on_advance(&mut self, command: &Mixed, held: &MotorShares, motion: &Motion) {
        if !self.exact {
            self.predict(motion);
        }
        self.begin(command, held, motion);
    }

    /// A setpoint or a place joined: the control logic's command changed with no new motion.
    pub fn on_joined(&mut self, command: &Mixed, motion: &Motion) {
        let jump = self.axes.between(&self.command, &command.shares);
        self.command = command.shares;
        if self.exact {
            return;
        }
        if command.slack < LEAST_SLACK {
            self.predict(motion);
            self.covered = motion.sums.dt;
            self.exact = true;
        } else {
            self.form.jump(&jump, motion.sums.dt);
        }
    }

    /// From here on motion counts anew.
    fn begin(&mut self, command: &Mixed, held: &MotorShares, motion: &Motion) {
        self.rotation = motion.rotation;
        self.command = command.shares;
        self.covered = 0.0;
        self.exact = command.slack < LEAST_SLACK || self.sounded != Feature::EVERY;
        if !self.exact {
            let off = self.axes.between(held, &command.shares);
            self.form = Form::of(&self.slopes, &self.rotation, &off, &self.owed);
        }
    }

    /// Puts the drift right by what the prediction missed; false where it missed too often.
    fn learn_from(&mut self, command: &Mixed, motion: &Motion) -> bool {
        let time = motion.sums.dt;
        if self.exact || time <= 0.0 {
            return true;
        }
        let moved = self.axes.between(&self.command, &command.shares);
        let mut miss = self.slopes.change(&self.rotation, motion);
        for (miss, moved) in miss.iter_mut().zip(moved) {
            *miss = moved - *miss;
        }
        let missed = !miss.iter().all(|miss| miss.abs() <= WORST_MISS);
        let refuted = missed && self.missed;
        self.missed = missed;
        if refuted {
            self.distrust();
        } else if !missed {
            let gain = time / (time * time + DRIFT_TIME * DRIFT_TIME);
            self.slopes.correct_drift(&miss.map(|miss| miss * gain));
        }
        !refuted
    }

    /// Foresees exactly until every feature is sounded anew.
    fn distrust(&mut self) {
        self.sounded = 0;
    }

    /// True where the control logic is to be sounded.
    #[must_use]
    pub fn is_sounding_due(&self, now: Instant) -> bool {
        now >= self.due
    }

    /// A sounding ended.
    pub fn on_sounded(&mut self, now: Instant) {
        self.due = now + INTERVAL;
    }

    /// Takes what a sounding found of one feature; false where that is not finite.
    pub fn on_column(&mut self, column: &Column) -> bool {
        let finite = column.of_axes.iter().all(|slope| slope.is_finite());
        if finite {
            self.slopes.set(column);
            self.sounded |= column.feature.bit();
        } else {
            self.distrust();
        }
        finite
    }
}
