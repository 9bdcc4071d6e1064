//! Reactive control: when does a change in a sensor call for new motor commands?
//!
//! For each input a logistic regression gives the probability that a run now would change the
//! command by a quantum or more; its inverse is a threshold, so that the hot path is one
//! comparison (Bregu et al., MobiSys 2016, sections 4 and 5). Labels come from shadow holds in
//! the warm-up, later from the runs that one input alone asked for.

mod decision;
mod exploration;
mod fit;
mod labels;
mod limits;
mod logistic;
mod sample;
mod shadow_holds;
mod supervisor;
mod watch;

pub use decision::Decision;
pub use exploration::Exploration;
pub use fit::{Fit, Refit, RefitJob};
pub use labels::{BIN_COUNT, Label, Labels};
pub use limits::Limits;
pub use logistic::Logistic;
pub use sample::Sample;
pub use shadow_holds::{Held, Lead, Rule, ShadowHolds, differs};
pub use supervisor::{FallbackReason, Phase, PhaseEvent, Supervisor};
pub use watch::Watch;
