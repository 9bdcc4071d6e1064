//! What the firmware is given at its start, checked: a checksummed block.
//!
//! A replay (or a bootloader) writes the block to the symbol `REFLEX_SETTINGS` in memory that
//! start-up leaves alone. Absent or wrong in any way, the values built from `config/` hold,
//! so that a board that was just powered behaves as configured.

pub use reflex_settings::gains;
pub use reflex_settings::{
    Airframe, AirframeError, BlockError, Declared, FEWEST_MOTORS, Feedback, LARGEST_TRIM, Limits,
    MOST_MOTORS, Motor, MotorProtocol, Mounting, OutOfRange, Pairs, Parameter, Policy, Reference,
    Settings, Start, WarmUp,
};
