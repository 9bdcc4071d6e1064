//! The emulated tier in closed loop: unmodified firmware, checked by the host.
//!
//! Every call of the firmware is made again on a native autopilot as soon as it is known, and must
//! compute the same command bit by bit; at the end every timer register must have held it.

use std::num::NonZeroU64;
use std::sync::Arc;

use anyhow::{Context, Result};
use reflex::app::{Call, Fault, Telemetry};
use reflex::battery::BatteryState;
use reflex::settings::MotorProtocol;

use super::Core;
use super::desired::Desired;
use super::flying_board::{Applied, Ended, FlyingBoard, News, TimedRan};
use super::report::Cpu;
use crate::faults::{Script, Strikes};
use crate::ground_station::LinkFrame;
use crate::logics::Start;
use crate::native::nanos;
use crate::record::motor_timers::{throttle, update_period_ns};
use crate::record::{Alignment, CountedFrom, Mirror, Observation, run_struck};
use crate::scoring::MotorDigest;
use chip_models::{ChipOptions, SharedChips, StimulusSource};
use emulated_board::emulated::{EmulatedBoard, Sensors};
use emulated_board::{Board, Elf, Options, SensorLine};

/// The shortest time between two samples of the MPU6050: 1 ms less its clock's tolerance.
const SHORTEST_PERIOD_NS: u64 = 950_000 / reflex::config::IMU_RATE as u64 * 1_000;
/// From a sample's interrupt to the motors at the soonest: its burst of 18 bytes at 400 kHz.
const SHORTEST_ANSWER_NS: u64 = 400_000;

/// An emulated board, the mirror of its calls, and what was observed so far.
pub(super) struct FlyingEmulatedBoard {
    board: Box<EmulatedBoard>,
    chips: SharedChips,
    strikes: Strikes,
    observation: Observation,
    /// Makes the firmware's calls again.
    mirror: Mirror,
    /// How many calls were mirrored, how many of them and of motor writes were taken.
    mirrored: usize,
    taken: usize,
    written: usize,
    runs: Vec<TimedRan>,
    protocol: MotorProtocol,
    motor_count: usize,
    /// The instructions of the scored part are to be counted.
    counts: bool,
    counted_from: Option<CountedFrom>,
}

impl FlyingEmulatedBoard {
    /// Boots firmware on a core, with chips that feel a source.
    pub(super) fn boot(
        core: &Core<'_>,
        start: &Start,
        source: &Arc<dyn StimulusSource>,
        chips: ChipOptions,
        faults: &Script,
    ) -> Result<Self> {
        let chips = SharedChips::feeling(source, chips);
        let sensors = Sensors::from(&chips);
        let elf = Arc::new(Elf::parse(core.firmware.bytes.clone())?);
        let instructions_per_second = NonZeroU64::new(u64::from(core.mhz) * 1_000_000);
        let options = Options {
            settings: Some(start.to_bytes()),
            bus_faults: faults.on_wires(),
            instructions_per_second: instructions_per_second.context("no clock")?,
            ..Options::default()
        };
        Ok(Self {
            chips,
            strikes: Strikes::of(faults),
            board: Box::new(EmulatedBoard::boot(&elf, sensors, &options)?),
            observation: Observation::new(None),
            mirror: Mirror::new(start),
            mirrored: 0,
            taken: 0,
            written: 0,
            runs: Vec::new(),
            protocol: start.settings.motors,
            motor_count: start.airframe.count(),
            counts: core.counts,
            counted_from: None,
        })
    }

    /// Makes the calls that are new; each run must give the same bits.
    fn mirror(&mut self) -> Result<()> {
        self.observation.check()?;
        for stamped in &self.observation.calls[self.mirrored..] {
            self.mirror.take(stamped)?;
            if let Call::Ran(ran) = stamped.call {
                self.runs.push((nanos(stamped.at), ran));
            }
        }
        self.mirrored = self.observation.calls.len();
        Ok(())
    }
}

impl FlyingBoard for FlyingEmulatedBoard {
    fn run_until(&mut self, until_ns: u64) -> Result<()> {
        let (board, chips) = (&mut *self.board, &mut self.chips);
        run_struck(
            board,
            chips,
            &mut self.strikes,
            until_ns,
            &mut self.observation,
        )?;
        self.mirror()
    }

    fn transmit(&mut self, frame: LinkFrame) {
        self.board.transmit(frame.at_ns, &frame.bytes);
    }

    fn take(&mut self, news: &mut News) {
        for write in &self.observation.motors[self.written..] {
            let motor = |index: usize| {
                let driven = write.driven & (1 << index) != 0;
                let pulse_ns = if driven { write.pulse_ns[index] } else { 0 };
                throttle(self.protocol, pulse_ns).unwrap_or_default()
            };
            news.applied.push(Applied {
                at_ns: write.applied_ns,
                throttles: (0..self.motor_count).map(motor).collect(),
            });
        }
        self.written = self.observation.motors.len();
        news.runs.append(&mut self.runs);
        let calls = &self.observation.calls;
        news.calls.extend_from_slice(&calls[self.taken..]);
        self.taken = calls.len();
    }

    fn desired(&mut self) -> Desired {
        Desired::of(self.mirror.logic())
    }

    fn telemetry(&self) -> Telemetry {
        self.mirror.autopilot().telemetry()
    }

    fn counted(&self, fault: Fault) -> u32 {
        self.mirror.autopilot().faults(fault)
    }

    fn measure(&mut self, [voltage_mv, current_mv]: [u32; 2]) {
        self.board.measure(voltage_mv, current_mv);
    }

    fn battery(&self) -> BatteryState {
        self.mirror.autopilot().battery().state()
    }

    fn update_offset_ns(&self) -> u64 {
        let newest = self.observation.motors.last();
        newest.map_or(0, |write| {
            write.applied_ns % update_period_ns(self.protocol)
        })
    }

    /// Between the run that answers a sample and the next sample's there is time; a run of the
    /// failsafe's timer in it would come late by half a step.
    fn soonest_command_ns(&self) -> u64 {
        let samples = &self.observation.edges[SensorLine::ImuReady as usize];
        let newest_ns = samples.last().copied().unwrap_or_default();
        let answered = self.observation.motors.last();
        let answered = answered.is_some_and(|write| write.at_ns >= newest_ns);
        let sample_ns = newest_ns + if answered { SHORTEST_PERIOD_NS } else { 0 };
        sample_ns + SHORTEST_ANSWER_NS
    }

    fn begin_scored(&mut self) {
        if self.counts {
            let counted_from = CountedFrom::here(&mut *self.board, &self.observation);
            self.counted_from = Some(counted_from);
        }
    }

    fn finish(self: Box<Self>, from_ns: u64) -> Result<Ended> {
        let outcome = self.board.finish()?;
        Alignment::of(&self.observation, self.protocol)?;
        let mut digest = MotorDigest::new();
        for write in &self.observation.motors {
            digest.write(write.at_ns, &write.pulse_ns);
        }
        let cpu = Cpu {
            busy_fraction: outcome.load.busy_fraction(from_ns),
            exceptions_per_second: outcome.load.exceptions_per_second(from_ns),
            busy_with_exceptions: outcome.load.busy_with_exceptions(from_ns),
        };
        let counted = |from: CountedFrom| from.to_end(&self.observation, &outcome);
        Ok(Ended {
            cpu: Some(cpu),
            digest: digest.hex(),
            counted: self.counted_from.and_then(counted),
        })
    }
}
