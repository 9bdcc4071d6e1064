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
    /// Sets the inputs of a step, runs, and says what the command is then.
    fn take(&mut self, step: &Step) -> MotorShares;
}

every_way!(cascade);
every_way!(arducopter);
every_way!(cleanflight);
every_way!(openpilot);
every_way!(observer);
