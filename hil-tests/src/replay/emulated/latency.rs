//! From a gating sample's interrupt to the motors: how long, made of what.

use reflex::app::Reason;
use reflex::sensors::Inputs;

use crate::record::{AlignedRun, Observation};
use crate::scoring::{LatencyPart, LatencySample, Quantiles};
use emulated_board::{ENTRY_CYCLES, EXIT_CYCLES};

/// Longer than this (ns) a write belongs to no hyperperiod's handler: the failsafe has its own.
const LONGEST_RUN_NS: u64 = 300_000;

/// The parts, in order, each with the exceptions that are entered and left in it; each begins where the
/// one before ends. The bus waits for each of the burst's five steps, and its end is an exception too.
const PARTS: [(&str, [u64; 2]); 5] = [
    ("interrupt to its handler", [1, 0]),
    ("I2C burst, 18 bytes at 400 kHz", [6, 0]),
    ("filter, sum, compare", [1, 1]),
    ("run, to the last motor register", [0, 0]),
    ("all, interrupt to motors", [8, 1]),
];

/// Every run with the time from the interrupt of its newest gating sample.
pub(super) fn samples(runs: &[AlignedRun]) -> Vec<LatencySample> {
    runs.iter()
        .filter_map(|run| {
            let nanos = run.written_ns.checked_sub(run.interrupt_ns?)?;
            Some(LatencySample {
                at_us: run.at_us,
                reason: run.ran.reason,
                micros: nanos as f64 * 1e-3,
            })
        })
        .collect()
}

/// Whether a sample of the MPU6050 asked for the run, by itself or by what derives from it.
pub(super) fn is_asked_by_sample(run: &AlignedRun) -> bool {
    run.ran.reason == Reason::Trigger && run.ran.asked.meets(Inputs::OF_IMU)
}

/// What the latency of the runs that the MPU6050's samples asked for is made of.
pub(super) fn parts<'r>(
    observation: &Observation,
    runs: impl Iterator<Item = &'r AlignedRun>,
    instructions_per_second: u64,
) -> Vec<LatencyPart> {
    let mut micros: [Vec<f64>; PARTS.len()] = Default::default();
    let by_sample = runs.filter(|run| is_asked_by_sample(run));
    for way in by_sample.filter_map(|run| way(observation, run)) {
        for (part, pair) in micros.iter_mut().zip(way.windows(2)) {
            part.push((pair[1] - pair[0]) as f64 * 1e-3);
        }
        micros[PARTS.len() - 1].push((way[4] - way[0]) as f64 * 1e-3);
    }
    PARTS
        .iter()
        .zip(micros)
        .map(|((part, [entered, left]), micros)| {
            let cycles = entered * ENTRY_CYCLES + left * EXIT_CYCLES;
            LatencyPart {
                part: (*part).to_owned(),
                micros: Quantiles::of(micros),
                exceptions_us: 1e6 * cycles as f64 / instructions_per_second as f64,
            }
        })
        .collect()
}

/// The instants of a run's way: interrupt, three handlers' entries, motor write.
fn way(observation: &Observation, run: &AlignedRun) -> Option<[u64; 5]> {
    let interrupt = run.interrupt_ns?;
    let mut way = [interrupt, 0, 0, 0, run.written_ns];
    for (place, entries) in observation.entries.iter().enumerate() {
        let next = entries.partition_point(|entry| *entry < way[place]);
        way[place + 1] = *entries.get(next)?;
    }
    way.is_sorted().then_some(way)
}

/// Time from the entry of the hyperperiod's handler to the motor write; the core never sleeps
/// in between.
pub(super) fn run_lengths_ns<'r>(
    observation: &Observation,
    runs: impl Iterator<Item = &'r AlignedRun>,
) -> impl Iterator<Item = u64> {
    let [.., starts] = &observation.entries;
    runs.filter_map(|run| {
        let place = starts.partition_point(|start| *start <= run.written_ns);
        let start = *starts.get(place.checked_sub(1)?)?;
        Some(run.written_ns - start)
    })
    .filter(|length| *length < LONGEST_RUN_NS)
}
