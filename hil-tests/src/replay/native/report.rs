//! The report of a native replay: what both tiers know.

use reflex::app::{Call, Ran};
use reflex::settings::MotorProtocol;
use reflex::time::at_micros;

use crate::native::{NativeBoard, nanos};
use crate::record::Look;
use crate::record::motor_timers::pulse_ns;
use crate::replay::options::ReplayOptions;
use crate::replay::report::{ChipEvidence, Evidence, scored_from_us};
use crate::replay::timeline::Timeline;
use crate::scoring::{MotorDigest, RunReport, Tier};
use emulated_board::SensorLine;
use recorded_flights::{Flight, Setpoints};

/// The report of a board that flew to its end.
pub(super) fn report(
    options: &ReplayOptions,
    flight: &Flight,
    setpoints: &Setpoints,
    timeline: &Timeline<'_>,
    board: &NativeBoard,
    looks: &[Look],
) -> RunReport {
    let runs: Vec<(u64, Ran)> = (timeline.calls.iter())
        .filter_map(|stamped| match stamped.call {
            Call::Ran(ran) => Some((stamped.at.ticks(), ran)),
            _ => None,
        })
        .collect();
    let mut edges = [const { Vec::new() }; SensorLine::ALL.len()];
    edges[SensorLine::ImuReady as usize] = board.imu.with(|wired| wired.rises.clone());
    for (line, wire) in SensorLine::OF_DIES.into_iter().zip(&board.dies) {
        edges[line as usize] = wire.with(|wired| wired.rises.clone());
    }
    let evidence = Evidence {
        options,
        flight,
        setpoints,
        timeline,
        chips: ChipEvidence {
            from_ns: nanos(at_micros(scored_from_us(timeline))),
            edges: edges.each_ref().map(Vec::as_slice),
            looks,
        },
    };
    evidence.report(Tier::Native, digest(&runs, options.settings.motors))
}

/// The pulses that the commands stand for, at the instants of their runs: no timer wrote them.
fn digest(runs: &[(u64, Ran)], protocol: MotorProtocol) -> String {
    let pulse = |share: &f32| pulse_ns(protocol, *share);
    let mut digest = MotorDigest::new();
    for (at_us, ran) in runs {
        let pulses: Vec<u32> = ran.shares.iter().map(pulse).collect();
        digest.write(nanos(at_micros(*at_us)), &pulses);
    }
    digest.hex()
}
