//! Every control logic in four ways, from one page: what does each cost?
//!
//! | way | is |
//! |---|---|
//! | `straight_line` | time-triggered: one function that computes everything |
//! | the page's own | ours |
//! | `callbacks` | a callback for each value, depth first from each input |
//! | `pointer_vector` | the layout of RP-Embedded |

use reflex::airframe::MotorShares;
use reflex_bench_macros::every_way;

use crate::step::Step;

/// A control logic, run in some way.
pub trait Way {
    /// At its start, with the gains that were built in.
    fn configured() -> Self
    where
        Self: Sized;

    /// Sets the inputs of a step, runs, and says what the command is then.
    fn take(&mut self, step: &Step) -> MotorShares;
}

/// Every logic of the one list.
macro_rules! all_in_every_way {
    ($($(#[$doc:meta])* $module:ident: $name:literal, $Logic:ident;)*) => {
        $(every_way!($module);)*
    };
}

reflex_settings::control_logics!(all_in_every_way);
