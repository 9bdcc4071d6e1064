//! What only the emulated board shows: sizes, latencies, load, log.

use std::collections::BTreeMap;

use super::latency;
use super::session::Session;
use crate::firmware::Firmware;
use crate::record::Observation;
use crate::record::{AlignedRun, Alignment};
use crate::replay::options::ReplayOptions;
use crate::replay::report::{ChipEvidence, Evidence, scored_from_us};
use crate::replay::timeline::Timeline;
use crate::scoring::{self, BoardTime, Cpu, MotorDigest, RunReport, Tier, latencies};
use emulated_board::Outcome;
use recorded_flights::Flight;

/// Everything that the report of an emulated replay is made from.
pub(super) struct BoardEvidence<'r, 'c> {
    pub(super) options: &'r ReplayOptions,
    pub(super) flight: &'r Flight,
    pub(super) firmware: &'r Firmware,
    pub(super) session: &'r Session,
    pub(super) observation: &'r Observation,
    pub(super) outcome: &'r Outcome,
    pub(super) alignment: &'r Alignment,
    pub(super) timeline: &'r Timeline<'c>,
}

impl BoardEvidence<'_, '_> {
    pub(super) fn report(&self) -> RunReport {
        let evidence = Evidence {
            options: self.options,
            flight: self.flight,
            setpoints: &self.session.setpoints,
            timeline: self.timeline,
            chips: ChipEvidence {
                from_ns: self.scored_from_ns(),
                edges: self.observation.edges.each_ref().map(Vec::as_slice),
                looks: &self.session.looks,
            },
        };
        let report = evidence.report(Tier::Emulated, self.digest());
        RunReport {
            firmware: Some(scoring::Firmware {
                flash_bytes: self.firmware.sizes.flash_bytes.into(),
                ram_bytes: self.firmware.sizes.ram_bytes.into(),
                stack_bytes: self.outcome.stack.used.into(),
            }),
            latency_us: latencies(
                &self.timeline.flight,
                &latency::samples(&self.alignment.runs),
            ),
            latency_parts_us: latency::parts(
                self.observation,
                self.scored_runs(),
                self.outcome.load.instructions_per_second,
            ),
            cpu: Some(self.cpu()),
            board: Some(BoardTime {
                virtual_s: self.outcome.ended_ns as f64 * 1e-9,
                start_up_s: self
                    .timeline
                    .first_hyperperiod_us
                    .map_or(0.0, |at| self.alignment.board_ns(at) as f64 * 1e-9),
            }),
            counters: self.counters(report.counters),
            ..report
        }
    }

    fn scored_from_ns(&self) -> u64 {
        self.alignment.board_ns(scored_from_us(self.timeline))
    }

    fn scored_runs(&self) -> impl Iterator<Item = &AlignedRun> {
        let from = scored_from_us(self.timeline);
        let to = self.timeline.flight.last_us();
        let scored = move |run: &&AlignedRun| run.at_us > from && run.at_us <= to;
        self.alignment.runs.iter().filter(scored)
    }

    fn cpu(&self) -> Cpu {
        let from_ns = self.scored_from_ns();
        let rate = self.outcome.load.instructions_per_second as f64 * 1e-9;
        let lengths: Vec<f64> = latency::run_lengths_ns(self.observation, self.scored_runs())
            .map(|length_ns| length_ns as f64 * rate)
            .collect();
        let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
        let load = &self.outcome.load;
        let has_steps = !self.timeline.flight.steps().is_empty();
        Cpu {
            busy_fraction: has_steps.then(|| load.busy_fraction(from_ns)),
            exceptions_per_second: has_steps.then(|| load.exceptions_per_second(from_ns)),
            busy_with_exceptions: has_steps.then(|| load.busy_with_exceptions(from_ns)),
            instructions_per_run: (!lengths.is_empty()).then_some(mean),
        }
    }

    /// What the board counted, added to what both tiers know.
    fn counters(&self, mut counters: BTreeMap<String, u64>) -> BTreeMap<String, u64> {
        let link = &self.outcome.link;
        counters.extend([
            ("link_bytes_received".into(), link.received),
            ("link_bytes_sent".into(), link.sent),
            ("link_bytes_lost".into(), link.lost),
            (
                "unmodelled_registers".into(),
                self.outcome.unmodelled.len() as u64,
            ),
            ("log_lines".into(), self.observation.log_lines),
            ("log_errors".into(), self.observation.errors.len() as u64),
            ("log_frames_damaged".into(), self.outcome.damaged_log_frames),
            ("motor_writes".into(), self.observation.motors.len() as u64),
        ]);
        counters
    }

    fn digest(&self) -> String {
        let mut digest = MotorDigest::new();
        for write in &self.observation.motors {
            digest.write(write.at_ns, &write.pulse_ns);
        }
        digest.hex()
    }
}
