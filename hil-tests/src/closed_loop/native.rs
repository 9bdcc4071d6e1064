//! The native tier in closed loop: chips, drivers, autopilot, no processor.

use std::sync::Arc;

use anyhow::Result;
use reflex::app::{Call, Fault, Telemetry};
use reflex::battery::BatteryState;
use reflex::settings::MotorProtocol;

use super::desired::Desired;
use super::flying_board::{Applied, Ended, FlyingBoard, News};
use crate::faults::Script;
use crate::ground_station::LinkFrame;
use crate::logics::Start;
use crate::native::{NativeBoard, RUN_NS, nanos};
use crate::record::motor_timers::{pulse_ns, throttle, update_period_ns};
use crate::scoring::MotorDigest;
use chip_models::{ChipOptions, StimulusSource};

/// A native board with what the motors' timers would make of its commands.
pub(super) struct FlyingNativeBoard {
    board: NativeBoard,
    protocol: MotorProtocol,
    digest: MotorDigest,
}

impl FlyingNativeBoard {
    /// Boots a board whose chips feel a source.
    pub(super) fn boot(
        start: &Start,
        source: &Arc<dyn StimulusSource>,
        chips: ChipOptions,
        faults: &Script,
    ) -> Self {
        let mut board = NativeBoard::boot(start, source, chips, Vec::new());
        board.disturb(faults);
        Self {
            board,
            protocol: start.settings.motors,
            digest: MotorDigest::new(),
        }
    }
}

/// The first update event behind the instant at which a command was written, ns.
fn applied_ns(protocol: MotorProtocol, written_ns: u64) -> u64 {
    let period_ns = update_period_ns(protocol);
    (written_ns / period_ns)
        .saturating_add(1)
        .saturating_mul(period_ns)
}

impl FlyingBoard for FlyingNativeBoard {
    fn run_until(&mut self, until_ns: u64) -> Result<()> {
        self.board.run_until(until_ns);
        Ok(())
    }

    fn transmit(&mut self, frame: LinkFrame) {
        self.board.transmit(frame);
    }

    fn take(&mut self, news: &mut News) {
        for stamped in self.board.drain_calls() {
            news.calls.push(stamped);
            let Call::Ran(ran) = stamped.call else {
                continue;
            };
            let written_ns = nanos(stamped.at) + RUN_NS;
            let pulses = ran
                .shares
                .iter()
                .map(|share| pulse_ns(self.protocol, *share));
            let pulses: Vec<u32> = pulses.collect();
            self.digest.write(written_ns, &pulses);
            let throttles = pulses.iter().map(|pulse| throttle(self.protocol, *pulse));
            news.applied.push(Applied {
                at_ns: applied_ns(self.protocol, written_ns),
                throttles: throttles.map(Option::unwrap_or_default).collect(),
            });
            news.runs.push((written_ns, ran));
        }
    }

    fn desired(&mut self) -> Desired {
        Desired::of(self.board.pilot.logic())
    }

    fn telemetry(&self) -> Telemetry {
        self.board.pilot.telemetry()
    }

    fn counted(&self, fault: Fault) -> u32 {
        self.board.pilot.faults(fault)
    }

    fn measure(&mut self, pins_mv: [u32; 2]) {
        self.board.gauge.pins_mv = pins_mv;
    }

    fn battery(&self) -> BatteryState {
        self.board.pilot.battery().state()
    }

    fn longest_transfer_ns(&self) -> Option<u64> {
        Some(self.board.longest_transfer_ns())
    }

    fn update_offset_ns(&self) -> u64 {
        0
    }

    fn soonest_command_ns(&self) -> u64 {
        let written_ns = self.board.soonest_run_ns().saturating_add(RUN_NS);
        applied_ns(self.protocol, written_ns)
    }

    fn finish(self: Box<Self>, _from_ns: u64) -> Result<Ended> {
        Ok(Ended {
            digest: self.digest.hex(),
            ..Ended::default()
        })
    }
}
