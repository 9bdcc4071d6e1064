//! Runs, motor writes and edges matched, and the two clocks with them.
//!
//! The firmware stamps with its own clock, which starts some time after reset; edges and
//! register writes carry the board's time. Every run writes the motors once, so runs and
//! writes pair off one to one, and each pair must hold the same command.

use anyhow::{Result, bail};
use reflex::app::{Call, Ran};
use reflex::settings::MotorProtocol;

use super::motor_timers::exact_pulse_ns;
use super::observation::Observation;
use emulated_board::SensorLine;

/// A pulse may be this far from the command, in ns: one tick and rounding.
const PULSE_SLACK_NS: f64 = 60.0;

/// A run with its motor write and the sample it answered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AlignedRun {
    /// The firmware's stamp of the run, in us.
    pub(crate) at_us: u64,
    pub(crate) ran: Ran,
    /// When the motors were written, in ns of the board's time.
    pub(crate) written_ns: u64,
    /// When the interrupt of the newest gating sample came, in ns of the board's time.
    pub(crate) interrupt_ns: Option<u64>,
}

/// The pairs, and how the clocks lie to each other.
pub(crate) struct Alignment {
    pub(crate) runs: Vec<AlignedRun>,
    /// The board's time at which the firmware's clock stood at zero, in us.
    clock_start_us: f64,
}

impl Alignment {
    /// Pairs runs with writes from the end, where both end.
    pub(crate) fn of(observation: &Observation, protocol: MotorProtocol) -> Result<Self> {
        let mut runs = runs(observation);
        let surplus = surplus(&runs, observation, protocol)?;
        for (run, write) in runs.iter_mut().zip(&observation.motors[surplus..]) {
            run.written_ns = write.at_ns;
        }
        // A write may still be under way when the replay ends.
        runs.truncate(observation.motors.len() - surplus);
        let Some(earliest) = runs
            .iter()
            .map(|run| run.written_ns as f64 * 1e-3 - run.at_us as f64)
            .min_by(f64::total_cmp)
        else {
            bail!("the firmware never wrote its motors");
        };
        let mut alignment = Self {
            runs,
            clock_start_us: earliest,
        };
        alignment.match_edges(observation);
        Ok(alignment)
    }

    /// Finds every run's interrupt, and with them where the clock starts to the microsecond.
    fn match_edges(&mut self, observation: &Observation) {
        let edges = &observation.edges[SensorLine::ImuReady as usize];
        let stamps = newest_samples(observation);
        // A write comes at most some 100 us behind the run's stamp, a tenth of a period.
        let rough = self.clock_start_us;
        let nearest = |stamp_us: u64| {
            let wanted = ((stamp_us as f64 + rough) * 1e3) as u64;
            let after = edges.partition_point(|edge| *edge < wanted);
            [after.wrapping_sub(1), after]
                .into_iter()
                .filter_map(|index| edges.get(index).copied())
                .min_by_key(|edge| edge.abs_diff(wanted))
                .filter(|edge| edge.abs_diff(wanted) < 450_000)
        };
        let mut starts = Vec::new();
        for (run, stamp) in self.runs.iter_mut().zip(stamps) {
            run.interrupt_ns = stamp.and_then(nearest);
            if let (Some(stamp), Some(edge)) = (stamp, run.interrupt_ns) {
                starts.push(edge as f64 * 1e-3 - stamp as f64);
            }
        }
        starts.sort_by(f64::total_cmp);
        if let Some(median) = starts.get(starts.len() / 2) {
            self.clock_start_us = *median;
        }
    }

    /// The firmware's clock at an instant of the board's time, in us.
    pub(crate) fn clock_us(&self, board_ns: u64) -> u64 {
        (board_ns as f64 * 1e-3 - self.clock_start_us).max(0.0) as u64
    }

    /// The board's time at an instant of the firmware's clock, in ns.
    pub(crate) fn board_ns(&self, clock_us: u64) -> u64 {
        ((clock_us as f64 + self.clock_start_us) * 1e3).max(0.0) as u64
    }
}

fn runs(observation: &Observation) -> Vec<AlignedRun> {
    observation
        .calls
        .iter()
        .filter_map(|stamped| match stamped.call {
            Call::Ran(ran) => Some(AlignedRun {
                at_us: stamped.at.ticks(),
                ran,
                written_ns: 0,
                interrupt_ns: None,
            }),
            _ => None,
        })
        .collect()
}

/// For every run, the stamp of the newest gating sample before it.
fn newest_samples(observation: &Observation) -> Vec<Option<u64>> {
    let mut newest = None;
    let mut stamps = Vec::new();
    for stamped in &observation.calls {
        match stamped.call {
            Call::Imu(_) => newest = Some(stamped.at.ticks()),
            Call::Ran(_) => stamps.push(newest),
            _ => {}
        }
    }
    stamps
}

/// How many writes came before the first run: start-up sets the motors to rest.
///
/// The replay may end between a run's record and its write, hence two candidates.
fn surplus(
    runs: &[AlignedRun],
    observation: &Observation,
    protocol: MotorProtocol,
) -> Result<usize> {
    let writes = observation.motors.len();
    let candidates = [0, 1].map(|unwritten| (writes + unwritten).checked_sub(runs.len()));
    let mut first_mismatch = None;
    for surplus in candidates.into_iter().flatten() {
        let mismatch = runs
            .iter()
            .zip(&observation.motors[surplus.min(writes)..])
            .find(|(run, write)| !holds(&run.ran, &write.pulse_ns, protocol));
        match mismatch {
            None => return Ok(surplus),
            Some((run, _)) => first_mismatch = first_mismatch.or(Some(run.at_us)),
        }
    }
    let at = first_mismatch.unwrap_or(0) as f64 * 1e-6;
    bail!(
        "the motor registers do not hold what the firmware computed: {} runs, {writes} writes, \
         first difference at {at:.6} s of its clock",
        runs.len()
    )
}

fn holds(ran: &Ran, pulses: &[u32], protocol: MotorProtocol) -> bool {
    ran.shares.iter().zip(pulses).all(|(share, pulse)| {
        let wanted = exact_pulse_ns(protocol, *share);
        (wanted - f64::from(*pulse)).abs() <= PULSE_SLACK_NS
    })
}
