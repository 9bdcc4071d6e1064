//! Settings that are one of a few choices.

use crate::time::Duration;

/// When control runs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Policy {
    /// When a sensor's change calls for it.
    Reactive,
    /// Time-triggered with this period, at the first hyperperiod's end that reaches it.
    Periodic(Duration),
}

/// What a change is measured against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Reference {
    /// The sample before, as published (Bregu et al. 2016, section 4).
    PreviousSample,
    /// The sample that the last run used.
    LastRun,
}

/// How long control runs time-triggered to learn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum WarmUp {
    /// Until every relevant model has its labels and is stable, 3 s to `T_boot`.
    Automatic,
    /// For this long, to the next refit behind it.
    Fixed(Duration),
}

/// Which pairs of samples and commands become labels in the warm-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Pairs {
    /// Shadow holds end at the first crossing of a candidate threshold; those of an input that
    /// this teaches too little go on as with [`Self::WeightedLags`].
    FirstCrossings,
    /// Shadow holds end after a number of samples of their own: pairs at several lags, and as
    /// pairs do not overlap, as many of each as the inverse of the lag.
    WeightedLags,
    /// Consecutive samples, as published (Bregu et al. 2016, section 4).
    Published,
}

/// Which runs become labels in reactive control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Feedback {
    /// Every run that one input alone asked for, failsafe runs, exploration runs.
    Every,
    /// False positives, and failsafe runs that changed a command, as published (section 4).
    Published,
}

/// How a motor command becomes a pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum MotorProtocol {
    /// 125 to 250 us, 2000 times a second.
    OneShot125,
    /// 1000 to 2000 us, 400 times a second.
    Pwm,
}
