//! What the linked firmware itself shows: a bounded stack, no panics, its size.

mod panics;
mod program;
mod reduced;
mod stack;
mod thumb;
