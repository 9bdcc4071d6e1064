//! What flies the simulated drone: firmware on a board, or the same code natively.

use anyhow::Result;
use reflex::app::{Fault, Ran, Stamped, Telemetry};
use reflex::battery::BatteryState;

use super::desired::Desired;
use super::report::Cpu;
use crate::ground_station::LinkFrame;
use crate::record::Counted;

/// A motor command, from the update event of the timers that applies it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Applied {
    pub(super) at_ns: u64,
    /// One throttle per motor, 0 to 1: what a speed controller reads from the pulse.
    pub(super) throttles: Vec<f64>,
}

/// A run with the virtual time of its motor command.
pub(super) type TimedRan = (u64, Ran);

/// What is new of a board, in order of time.
#[derive(Default)]
pub(super) struct News {
    pub(super) calls: Vec<Stamped>,
    pub(super) runs: Vec<TimedRan>,
    pub(super) applied: Vec<Applied>,
}

/// What only the end of a flight shows.
#[derive(Default)]
pub(super) struct Ended {
    /// What the processor did in the scored part, where there is one.
    pub(super) cpu: Option<Cpu>,
    /// The digest of all motor commands.
    pub(super) digest: String,
    /// The instructions of the scored part, where they were to be counted.
    pub(super) counted: Option<Counted>,
}

/// One flight's autopilot with its sensors, buses and timers.
pub(super) trait FlyingBoard {
    /// Runs to an instant of virtual time, ns.
    ///
    /// # Errors
    /// A fault of the board, or firmware that contradicts the host.
    fn run_until(&mut self, until_ns: u64) -> Result<()>;

    /// Sends a frame to the autopilot, from its instant on.
    fn transmit(&mut self, frame: LinkFrame);

    /// Adds calls, runs and commands since the last time.
    fn take(&mut self, news: &mut News);

    /// The attitude steered to.
    fn desired(&mut self) -> Desired;

    /// How the firmware is.
    fn telemetry(&self) -> Telemetry;

    /// How often the firmware counted a fault.
    fn counted(&self, fault: Fault) -> u32;

    /// What the battery's divider and shunt put on their pins from now on, mV.
    fn measure(&mut self, pins_mv: [u32; 2]);

    /// How full the firmware takes the battery for.
    fn battery(&self) -> BatteryState;

    /// The longest time that a task kept a bus, ns, where that is known.
    fn longest_transfer_ns(&self) -> Option<u64> {
        None
    }

    /// The offset of the timers' update events from whole periods, ns.
    fn update_offset_ns(&self) -> u64;

    /// The soonest that a command which is not given yet may apply, ns; 0 where it is unknown.
    fn soonest_command_ns(&self) -> u64;

    /// The scored part begins here.
    fn begin_scored(&mut self) {}

    /// Ends the flight; its scored part began at an instant.
    ///
    /// # Errors
    /// What only the end shows of the firmware.
    fn finish(self: Box<Self>, from_ns: u64) -> Result<Ended>;
}
