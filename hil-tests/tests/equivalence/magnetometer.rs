//! The LSM303AGR's magnetometer beside the software: exact.
//!
//! The OFFSET registers hold the reference and INT_on_DataOFF compares what is
//! left of each sample. Data, offset and threshold weigh the same 1.5 mG, both
//! comparisons are strict, and nothing is filtered between: every decision must
//! be the same. The one exception is outside what a flight sees: a change
//! beyond 32767 counts (49 gauss) is clipped in the data registers, where it
//! looks no larger than 32767, and not in the comparator.

use std::sync::Arc;

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use reflex::math::Vec3;
use reflex::settings::Reference;
use reflex_drivers::lsm303agr::halves::{Half, Halves, Rates};
use reflex_drivers::lsm303agr::{
    Axes, MagCompare, MagCounts, MagInterrupt, MagOffset, MagPin, MagThreshold,
    Magnetometer as Driver,
};
use reflex_drivers::orders::ComparingSensor;
use reflex_drivers::quantity::Seconds;

use super::comparison::{Comparison, Decision, Sample, Tally};
use super::ports::SpiPort;
use super::streams::{Dice, Kind, Stream};
use chip_models::Stimulus;
use chip_models::bus::{Chip, SpiChip};
use chip_models::lsm303agr::{Accelerometer, Magnetometer};
use chip_models::testing::{real, write_spi};

/// One count in gauss.
const COUNT: f64 = 1.5e-3;
/// CFG_REG_A_M: continuous at 100 Hz, CFG_REG_C_M: block data update; the chip corrects its errors.
const SAMPLING: [(u8, u8); 3] = [(0x62, 0x10), (0x61, 0x02), (0x60, 0x8C)];
const PERIOD_NS: u64 = 10_000_000;
/// The field at rest, in gauss.
const REST: [f64; 3] = [0.2, 0.0, -0.4];

/// When the reference is taken anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Runs {
    /// After every sample: the chip compares with the previous one.
    EverySample,
    /// After 1 to this many samples.
    Within(u32),
}

/// As the firmware sets the comparator up (`mag_interrupt`).
fn interrupt(code: u16) -> MagInterrupt {
    MagInterrupt {
        compare: MagCompare::ChangeFromOffset,
        axes: Axes::ALL,
        threshold: MagThreshold::from_code(code).expect("codes start at 1"),
        latch: true,
        pin: MagPin::Threshold,
    }
}

fn driver(chip: &mut Magnetometer, now_ns: u64) -> Driver<SpiPort<'_>> {
    Driver::new(SpiPort { chip, now_ns })
}

/// The field in whole counts, from what is left of it above the offset.
fn whole(difference: MagCounts, offset: MagOffset) -> (MagCounts, Sample) {
    let ends = |count: i16| count == i16::MAX || count == i16::MIN;
    let clipped = difference.0.into_iter().any(ends);
    let field = difference.with_offset_restored(offset);
    let [x, y, z] = field.0.map(f32::from);
    let axes = Vec3::new(x, y, z);
    (field, Sample { axes, clipped })
}

/// Every decision of one stream under one threshold.
fn watch(
    runs: Runs,
    code: u16,
    (stream, seed): (Stream, u64),
    samples: u32,
    judge: &mut dyn FnMut(&Decision),
) {
    let mut chip = Magnetometer::new(stream.into_field(), real(seed));
    write_spi(&mut chip, 0, &SAMPLING);
    let set = driver(&mut chip, 0).configure_interrupt(interrupt(code));
    set.expect("the chip holds what was written");
    let mut dice = Dice::new(!seed);
    let mut offset = MagOffset::default();
    let mut comparison: Option<Comparison> = None;
    let mut left = 1;
    for _ in 0..samples {
        let at_ns = chip.next_event();
        chip.advance(at_ns);
        let fired = chip.interrupt();
        let mut port = driver(&mut chip, at_ns);
        let difference = port.read_sample().expect("the bus works");
        port.clear_request().expect("the bus works");
        let (field, sample) = whole(difference, offset);
        if let Some(comparison) = &mut comparison {
            judge(&comparison.decide(sample, fired));
        }
        left -= 1;
        if left > 0 {
            continue;
        }
        let gap_ns = chip.next_event() - at_ns;
        let later_ns = at_ns + (gap_ns as f64 * dice.within(0.0, 0.9)) as u64;
        offset = MagOffset::at(field);
        let written = driver(&mut chip, later_ns).set_offset(offset);
        written.expect("the chip holds what was written");
        match &mut comparison {
            Some(comparison) => comparison.rearm(),
            None => {
                let reference = match runs {
                    Runs::EverySample => Reference::PreviousSample,
                    Runs::Within(_) => Reference::LastRun,
                };
                let new = Comparison::new(reference, f32::from(code), COUNT, sample);
                comparison = Some(new);
            }
        }
        left = match runs {
            Runs::EverySample => 1,
            Runs::Within(longest) => dice.count(1, longest),
        };
    }
}

fn stream(kind: Kind, seed: u64, samples: u32, size: f64) -> (Stream, u64) {
    let stream = Stream::new((kind, seed), (samples, PERIOD_NS), size, REST);
    (stream, seed)
}

/// All small codes, then every power of two with its neighbours.
pub fn codes() -> Vec<u16> {
    let powers = (6..=14).map(|n| 1 << n);
    let around = powers.flat_map(|power| [power - 1, power, power + 1]);
    (1..=63).chain(around).chain([32_766, 32_767]).collect()
}

/// Decisions over a range of codes, all kinds of streams for each.
pub fn sweep(runs: Runs, codes: impl IntoIterator<Item = u16>, samples: u32) -> Tally {
    let mut tally = Tally::default();
    for code in codes {
        for (n, kind) in (0..).zip(Kind::ALL) {
            // Single samples differ by less than the field moves in all.
            let wide = if runs == Runs::EverySample { 3.0 } else { 1.0 };
            let size = f64::from(code) * COUNT * wide;
            let stream = stream(kind, u64::from(code) * 16 + n, samples, size);
            watch(runs, code, stream, samples, &mut |decision| {
                tally.note(decision);
            });
        }
    }
    tally
}

/// Whether the registers show less than what the comparator saw.
fn looks_smaller(code: u16, decision: &Decision) -> bool {
    let shows_the_most = decision.distance() < COUNT / 2.0;
    code == 32_767 && decision.clipped && decision.is_extra() && shows_the_most
}

#[test]
fn over_all_codes_chip_and_software_agree_on_every_sample() {
    for runs in [Runs::EverySample, Runs::Within(20)] {
        for code in codes() {
            for (n, kind) in (0..).zip(Kind::ALL) {
                let size = f64::from(code) * COUNT;
                let seed = 10_000_000 + u64::from(code) * 16 + n;
                let stream = stream(kind, seed, 200, size);
                watch(runs, code, stream, 200, &mut |decision| {
                    assert!(
                        decision.software == decision.chip || looks_smaller(code, decision),
                        "{runs:?} code {code} {kind:?} {decision:?}"
                    );
                });
            }
        }
    }
}

#[test]
fn fields_that_saturate_differ_at_the_largest_code_alone() {
    let mut differ = 0;
    for runs in [Runs::EverySample, Runs::Within(20)] {
        for code in codes() {
            // Steps of up to 100 gauss, where the converter ends at 49.
            let stream = stream(Kind::Steps, u64::from(code), 200, 50.0);
            watch(runs, code, stream, 200, &mut |decision| {
                let agree = decision.software == decision.chip;
                let small = looks_smaller(code, decision);
                assert!(agree || small, "{runs:?} code {code} {decision:?}");
                differ += u64::from(!agree);
            });
        }
    }
    assert!(differ > 0, "no stream reached beyond the registers");
}

#[test]
fn a_change_of_the_threshold_itself_asks_for_nothing_and_one_count_more_does() {
    let mut equal = 0;
    for code in 1..=63 {
        let size = f64::from(code) * COUNT;
        let stream = stream(Kind::Steps, u64::from(code), 400, size);
        watch(Runs::Within(20), code, stream, 400, &mut |decision| {
            let above = (decision.change - decision.threshold) / COUNT;
            let counts = above.round() as i32;
            if counts == 0 || counts == 1 {
                assert_eq!(
                    (decision.chip, decision.software),
                    (counts == 1, counts == 1)
                );
                equal += i32::from(counts == 0);
            }
        });
    }
    assert!(equal > 20, "{equal}");
}

#[test]
fn as_the_firmware_sets_it_up_the_chip_shows_none_of_its_own_offset() {
    fn nothing(_: u64) -> Stimulus {
        Stimulus {
            temperature_c: 70.0,
            ..Stimulus::default()
        }
    }
    let shown = |set_up: fn(&mut Magnetometer)| {
        let mut chip = Magnetometer::new(Arc::new(nothing), real(2));
        set_up(&mut chip);
        let mut sum = [0.0; 3];
        for n in 1..=50 {
            chip.advance(n * 2 * PERIOD_NS);
            let read = driver(&mut chip, n * 2 * PERIOD_NS).read_sample();
            for (sum, axis) in sum.iter_mut().zip(read.expect("the bus works").0) {
                *sum += f64::from(axis) * COUNT / 50.0;
            }
        }
        sum.into_iter()
            .fold(0.0, |most: f64, axis| most.max(axis.abs()))
    };
    let by_firmware = shown(|mag| {
        let mut accel = Accelerometer::new(Arc::new(nothing), real(2));
        let [accel, mag] =
            [&mut accel as &mut dyn SpiChip, mag].map(|chip| SpiPort { chip, now_ns: 0 });
        let rates = Rates::from_hz(100, 100).expect("both halves have these rates");
        let mut halves = Halves::new(accel, mag, rates, Seconds(0.1));
        let set = halves.half(Half::Mag).set_up();
        set.expect("both halves answer");
    });
    let by_the_crate_alone = shown(|mag| write_spi(mag, 0, &[(0x62, 0x10), (0x60, 0x0C)]));
    assert!(by_firmware < 2e-3, "{by_firmware}");
    assert!(by_the_crate_alone > 2e-2, "{by_the_crate_alone}");
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 200,
        rng_seed: RngSeed::Fixed(2),
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_stream_and_code_agree(
        seed: u64,
        code in 1..=32_766_u16,
        kind in prop::sample::select(&Kind::ALL[..]),
        longest in 1..100_u32,
    ) {
        let stream = stream(kind, seed, 300, f64::from(code) * COUNT);
        let mut disagreement = None;
        watch(Runs::Within(longest), code, stream, 300, &mut |decision| {
            if decision.software != decision.chip {
                disagreement = Some(*decision);
            }
        });
        prop_assert!(disagreement.is_none(), "{:?}", disagreement);
    }
}
