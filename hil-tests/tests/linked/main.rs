//! What the linked firmware itself shows: its stack has a bound, no task panics.

mod panics;
mod program;
mod stack;
mod thumb;
