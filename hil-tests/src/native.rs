//! The native tier: the autopilot in lockstep with a recorded flight.
//!
//! ```text
//! log -> flight -> chip models -> drivers -> [ autopilot ] -> calls -> the same score
//!           \-> setpoints -> link frames -> parser -^
//! ```
//! The chip models, their seeds, the drivers that program them, the tasks around the autopilot and
//! the autopilot are those of the emulated tier; what is left out is the processor. A small board
//! (`board`, `events`) keeps virtual time and calls the tasks, with what they take as constants
//! (`timing`). So this tier is some hundred times faster than the flight was, and says what
//! control does; what it costs on the target, and whether the firmware does it, only the
//! emulated tier says. The two agree in what they decide, not bit by bit: their samples differ
//! by microseconds.
//!
//! Virtual time is handed in, nothing is shared between flights and no thread is started: any
//! number of flights may go on at once, in threads of the caller.

mod agenda;
mod board;
mod events;
mod gauge;
mod imu_line;
mod serial_line;
mod timing;
mod vectors;
mod wires;

pub(crate) use board::NativeBoard;
pub(crate) use timing::{RUN_NS, clock, nanos};
#[cfg(test)]
pub(crate) use wires::DieWire;
