//! What a native replay says around its score: what both tiers know.

use reflex::app::{Call, Ran};
use reflex::settings::MotorProtocol;
use reflex::time::at_micros;

use super::board::NativeBoard;
use super::timing::nanos;
use crate::replay::about::{Known, SampleCount, Seen, scored_from_us};
use crate::replay::alignment::pulse_ns;
use crate::replay::story::Story;
use crate::replay_options::ReplayOptions;
use crate::scoring::{About, MotorDigest, Tier};
use recorded_flights::{Flight, Setpoints};

/// Tells of a board that flew to its end.
pub(super) fn tell(
    options: &ReplayOptions,
    flight: &Flight,
    setpoints: &Setpoints,
    story: &Story<'_>,
    board: &NativeBoard,
    samples: &[SampleCount],
) -> About {
    let runs: Vec<(u64, Ran)> = (story.calls.iter())
        .filter_map(|stamped| match stamped.call {
            Call::Ran(ran) => Some((stamped.at.ticks(), ran)),
            _ => None,
        })
        .collect();
    let edges = [
        board.imu.with(|wired| wired.rises.clone()),
        board.accel.with(|wired| wired.rises.clone()),
        board.mag.with(|wired| wired.rises.clone()),
    ];
    let known = Known {
        options,
        flight,
        setpoints,
        story,
        runs: &runs,
        seen: Seen {
            from_ns: nanos(at_micros(scored_from_us(story))),
            edges: edges.each_ref().map(Vec::as_slice),
            samples,
            chip_thresholds: [
                board.accel.with(|wired| wired.chip.pin_threshold()),
                board.mag.with(|wired| wired.chip.pin_threshold()),
            ],
        },
    };
    known.tell(Tier::Native, digest(&runs, options.settings.motors))
}

/// The pulses that the commands stand for, at the instants of their runs: no timer wrote them.
fn digest(runs: &[(u64, Ran)], protocol: MotorProtocol) -> String {
    let pulse = |share: f32| pulse_ns(protocol, share);
    let mut digest = MotorDigest::new();
    for (at_us, ran) in runs {
        digest.write(nanos(at_micros(*at_us)), &ran.shares.map(pulse));
    }
    digest.hex()
}
