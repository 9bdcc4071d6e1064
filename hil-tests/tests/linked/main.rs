//! What the linked firmware's own instructions show: a bound of its stack, and no panic in flight.

mod panics;
mod program;
mod stack;
mod thumb;
