//! The named ways in which a run fails, each told in one line.

use std::fmt;

/// Why a run ended early, and when.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// When it was noticed, in ns of the board's time.
    pub at_ns: u64,
    /// What happened.
    pub kind: FaultKind,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.at_ns as f64 / 1e9;
        write!(f, "{} (at {seconds:.6} s of the board's time)", self.kind)
    }
}

impl std::error::Error for Fault {}

/// What went wrong on the board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// The core took a HardFault.
    HardFault {
        /// The failed access, or else the last error in the firmware's log.
        detail: Option<String>,
    },
    /// The firmware panicked with this message.
    Panic(String),
    /// An interrupt or exception came that the firmware has no handler for.
    UnhandledInterrupt,
    /// An access to an address where the part has nothing.
    UnmappedAccess {
        /// The address.
        address: u64,
        /// The instruction that made the access, with its function.
        code: String,
    },
    /// An access that the part refuses, such as to an unclocked peripheral.
    RefusedAccess {
        /// The address.
        address: u64,
        /// What the part said.
        reason: String,
    },
    /// The watchdog was not fed in time and reset the processor.
    WatchdogReset,
    /// The processor was reset for another reason.
    Reset(String),
    /// The stack grew past its region of this many bytes.
    StackOverflow {
        /// Size of the region, in bytes.
        available: u32,
    },
    /// The motors were not driven within the time limit.
    NeverStarted {
        /// The limit, in ns.
        limit_ns: u64,
    },
    /// Neither a motor write nor a recorded call came for too long.
    Silent {
        /// The limit, in ns.
        limit_ns: u64,
    },
    /// The call log was overwritten before it could be read.
    CallsLost {
        /// Bytes lost.
        bytes: u32,
    },
    /// Pins, lines or buffers are not where the board is wired.
    Wiring(Vec<String>),
    /// The firmware does to the part what its reference manual forbids.
    Forbidden(String),
    /// The firmware uses hardware in a way the emulated board does not play.
    NotModelled(String),
    /// The emulator itself failed.
    Emulator(String),
}

impl FaultKind {
    /// A short name for reports: lower case, words joined by `_`.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::HardFault { .. } => "hard_fault",
            Self::Panic(_) => "panic",
            Self::UnhandledInterrupt => "unhandled_interrupt",
            Self::UnmappedAccess { .. } => "unmapped_access",
            Self::RefusedAccess { .. } => "refused_access",
            Self::WatchdogReset => "watchdog_reset",
            Self::Reset(_) => "reset",
            Self::StackOverflow { .. } => "stack_overflow",
            Self::NeverStarted { .. } => "never_started",
            Self::Silent { .. } => "silent",
            Self::CallsLost { .. } => "calls_lost",
            Self::Wiring(_) => "wiring",
            Self::Forbidden(_) => "forbidden",
            Self::NotModelled(_) => "not_modelled",
            Self::Emulator(_) => "emulator",
        }
    }
}

impl fmt::Display for FaultKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let millis = |ns: &u64| ns / 1_000_000;
        match self {
            Self::HardFault { detail: None } => f.write_str("HardFault in the firmware"),
            Self::HardFault {
                detail: Some(detail),
            } => {
                write!(f, "HardFault in the firmware: {detail}")
            }
            Self::Panic(message) => write!(f, "the firmware panicked: {message}"),
            Self::UnhandledInterrupt => f.write_str("an interrupt came that has no handler"),
            Self::UnmappedAccess { address, code } => {
                write!(f, "unmapped access to {address:#010x} by {code}")
            }
            Self::RefusedAccess { address, reason } => {
                write!(f, "refused access to {address:#010x}: {reason}")
            }
            Self::WatchdogReset => f.write_str("watchdog reset: it was not fed in time"),
            Self::Reset(cause) => write!(f, "unexpected reset: {cause}"),
            Self::StackOverflow { available } => {
                write!(f, "stack overflow: all {available} bytes were used")
            }
            Self::NeverStarted { limit_ns } => {
                let limit = millis(limit_ns);
                write!(
                    f,
                    "the firmware never started: no motor driven within {limit} ms"
                )
            }
            Self::Silent { limit_ns } => {
                let limit = millis(limit_ns);
                write!(
                    f,
                    "the firmware hangs: no motor write and no call for {limit} ms"
                )
            }
            Self::CallsLost { bytes } => write!(
                f,
                "{bytes} bytes of the call log were overwritten before they were read: poll more often"
            ),
            Self::Wiring(problems) => write!(f, "wiring: {}", problems.join("; ")),
            Self::Forbidden(what) => write!(f, "forbidden by the reference manual: {what}"),
            Self::NotModelled(what) => write!(f, "not modelled by the emulated board: {what}"),
            Self::Emulator(message) => write!(f, "the emulator failed: {message}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_is_one_line_that_names_place_and_time() {
        let fault = Fault {
            at_ns: 1_500_000_000,
            kind: FaultKind::UnmappedAccess {
                address: 0x4008_0000,
                code: "main (pc 0x08000400)".into(),
            },
        };
        assert_eq!(
            fault.to_string(),
            "unmapped access to 0x40080000 by main (pc 0x08000400) (at 1.500000 s of the board's time)"
        );
    }

    #[test]
    fn several_wiring_problems_stay_on_one_line() {
        let kind = FaultKind::Wiring(vec!["PC6 is an input".into(), "PD13 has AF3".into()]);
        assert_eq!(kind.to_string(), "wiring: PC6 is an input; PD13 has AF3");
    }
}
