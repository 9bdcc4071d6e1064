//! The firmware's calls made again on the host, which must compute the same bits.

use anyhow::{Result, bail};
use reflex::app::{Autopilot, Call, Event, Ran, Reason, Recorder, Stamped};
use reflex::sensors::Inputs;
use reflex::time::Instant;

use crate::logics::{AnyLogic, Start};

/// An autopilot on the host that is given the very calls of the firmware.
pub(crate) struct Mirror(Autopilot<NewestRun, AnyLogic>);

impl Mirror {
    /// A mirror of firmware that is given this at its start.
    pub(crate) fn new(start: &Start) -> Self {
        Self(start.autopilot(NewestRun::default()))
    }

    /// Makes a call again.
    ///
    /// # Errors
    /// The call reports a run, and the host's run has another stamp or another bit.
    pub(crate) fn take(&mut self, stamped: &Stamped) -> Result<()> {
        stamped.call.replay(stamped.at, &mut self.0);
        match &stamped.call {
            Call::Ran(ran) => self.0.recorder().check(stamped.at, ran),
            _ => Ok(()),
        }
    }

    /// The autopilot behind the calls so far.
    pub(crate) fn autopilot(&self) -> &Autopilot<impl Recorder, AnyLogic> {
        &self.0
    }

    /// The oldest event of the calls so far that was not taken yet.
    pub(crate) fn next_event(&mut self) -> Option<Event> {
        self.0.next_event()
    }

    /// The control logic behind the calls so far.
    pub(crate) fn logic(&mut self) -> &AnyLogic {
        self.0.logic()
    }
}

/// Keeps the newest run.
#[derive(Default)]
struct NewestRun(Option<(Instant, Ran)>);

impl NewestRun {
    fn check(&mut self, at: Instant, firmware: &Ran) -> Result<()> {
        let host = self.0.take();
        let is_same =
            |(host_at, host): (Instant, Ran)| host_at == at && bits(&host) == bits(firmware);
        if host.is_some_and(is_same) {
            return Ok(());
        }
        let seconds = at.ticks() as f64 * 1e-6;
        bail!(
            "the same calls gave another command on the host, at {seconds:.6} s of the \
             firmware's clock: firmware {firmware:?}, host {host:?}"
        )
    }
}

/// A run to the letter: unlike `==`, zeros of different signs differ, and NaN is itself.
fn bits(ran: &Ran) -> (Reason, Inputs, Option<u32>, Vec<u32>) {
    let expected = ran.expected.map(f32::to_bits);
    (
        ran.reason,
        ran.asked,
        expected,
        ran.shares.iter().map(|share| share.to_bits()).collect(),
    )
}

impl Recorder for NewestRun {
    fn record(&mut self, at: Instant, call: &Call) {
        if let Call::Ran(ran) = call {
            self.0 = Some((at, *ran));
        }
    }
}
