//! What a run in reactive control turned out to be, and what it teaches.
//!
//! As published, only surprises are fed back: false positives, and failsafe runs that changed the
//! command. As old labels are forgotten, nothing then says that a threshold is right, and it
//! drifts. So by default every run teaches that one input alone asked for, every failsafe run,
//! and exploration runs by the inverse of their probability. Runs that several inputs asked for
//! teach nothing in either case: whose change was it?

use super::{Exploration, Reason};
use crate::numbered::numbered;
use crate::sensors::Inputs;
use crate::settings::Feedback;

numbered! {
    /// What a run in reactive control turned out to be.
    Outcome {
        /// One input asked for it, and it changed the command.
        TruePositive,
        /// One input asked for it, and it changed nothing.
        FalsePositive,
        /// Several inputs asked for it.
        SeveralAsked,
        /// No input asked, and the failsafe changed the command: the paper's false negative.
        FailsafeChanged,
        /// No input asked, and the failsafe changed nothing.
        FailsafeUnchanged,
        /// No input asked, and chance changed the command.
        ExploredChanged,
        /// No input asked, and chance changed nothing.
        ExploredUnchanged,
    }
}

/// Labels that a run adds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Teaching {
    /// To whom.
    pub(super) inputs: Inputs,
    /// The run was, or would have been, *changed*.
    pub(super) changed: bool,
    /// What each label weighs.
    pub(super) weight: f32,
}

impl Outcome {
    /// The outcome of a run; `None` where no model was asked.
    pub(super) fn of(reason: Reason, asked: Inputs, changed: bool) -> Option<Self> {
        let choose = |if_changed, if_not| Some(if changed { if_changed } else { if_not });
        match reason {
            Reason::Trigger if asked.sole().is_none() => Some(Self::SeveralAsked),
            Reason::Trigger => choose(Self::TruePositive, Self::FalsePositive),
            // The timer came before the end of the hyperperiod in which something was asked.
            Reason::Failsafe if !asked.is_empty() => None,
            Reason::Failsafe => choose(Self::FailsafeChanged, Self::FailsafeUnchanged),
            Reason::Exploration => choose(Self::ExploredChanged, Self::ExploredUnchanged),
            Reason::WarmUp
            | Reason::Setpoint
            | Reason::Periodic
            | Reason::Fallback
            | Reason::Ground => None,
        }
    }

    /// What it teaches by a rule; `asked` is who asked for the run.
    pub(super) fn teaches(self, feedback: Feedback, asked: Inputs) -> Option<Teaching> {
        let label = |inputs, changed, weight| {
            Some(Teaching {
                inputs,
                changed,
                weight,
            })
        };
        let every = feedback == Feedback::Every;
        match self {
            Self::FalsePositive => label(asked, false, 1.0),
            Self::FailsafeChanged => label(Inputs::ALL, true, 1.0),
            Self::TruePositive if every => label(asked, true, 1.0),
            Self::FailsafeUnchanged if every => label(Inputs::ALL, false, 1.0),
            Self::ExploredChanged if every => label(Inputs::ALL, true, Exploration::WEIGHT),
            Self::ExploredUnchanged if every => label(Inputs::ALL, false, Exploration::WEIGHT),
            Self::TruePositive
            | Self::SeveralAsked
            | Self::FailsafeUnchanged
            | Self::ExploredChanged
            | Self::ExploredUnchanged => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensors::Input;

    const GYRO: Inputs = Inputs::NONE.with(Input::Gyro);
    const TWO: Inputs = GYRO.with(Input::ChipMag);

    #[test]
    fn runs_that_several_inputs_asked_for_teach_nothing() {
        let outcome = Outcome::of(Reason::Trigger, TWO, true).expect("judged");
        assert_eq!(outcome, Outcome::SeveralAsked);
        for feedback in [Feedback::Every, Feedback::Published] {
            assert_eq!(outcome.teaches(feedback, TWO), None);
        }
    }

    #[test]
    fn as_published_only_surprises_teach() {
        let taught: Vec<Outcome> = Outcome::ALL
            .iter()
            .copied()
            .filter(|outcome| outcome.teaches(Feedback::Published, GYRO).is_some())
            .collect();
        assert_eq!(taught, [Outcome::FalsePositive, Outcome::FailsafeChanged]);
    }

    #[test]
    fn a_triggered_run_teaches_the_input_that_asked_and_a_failsafe_run_all() {
        let teaches = |reason, asked, changed| {
            let outcome = Outcome::of(reason, asked, changed)?;
            let teaching = outcome.teaches(Feedback::Every, asked)?;
            Some((teaching.inputs, teaching.changed, teaching.weight))
        };
        assert_eq!(
            teaches(Reason::Trigger, GYRO, true),
            Some((GYRO, true, 1.0))
        );
        assert_eq!(
            teaches(Reason::Trigger, GYRO, false),
            Some((GYRO, false, 1.0))
        );
        let all = Inputs::ALL;
        assert_eq!(
            teaches(Reason::Failsafe, Inputs::NONE, false),
            Some((all, false, 1.0))
        );
        assert_eq!(
            teaches(Reason::Exploration, Inputs::NONE, true),
            Some((all, true, Exploration::WEIGHT))
        );
    }

    #[test]
    fn where_no_model_was_asked_there_is_nothing_to_judge() {
        for reason in [
            Reason::WarmUp,
            Reason::Setpoint,
            Reason::Periodic,
            Reason::Ground,
        ] {
            assert_eq!(Outcome::of(reason, GYRO, true), None);
        }
        assert_eq!(Outcome::of(Reason::Failsafe, GYRO, true), None);
    }
}
