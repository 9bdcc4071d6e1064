//! What the accelerometer's high-pass filter explains, and nothing else.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use reflex_drivers::lsm303agr::{AccelDataRate, HighPassMode};

use super::accelerometer::{Rig, Runs, Setting, lowered_sweep, sweep, watch};
use super::comparison::Decision;
use super::streams::Kind;
use chip_models::testing::{exact, force_g};

/// The failsafe runs, at the latest, when a reference is this old.
const FAILSAFE_S: f64 = 0.1;
/// A count of INT1_THS_A at +-2 g in m/s2.
const CODE: f64 = 0.016 * 9.806_65;
/// Room for the rounding of the chip model's own arithmetic, in m/s2.
const ROUNDING: f64 = 1e-9;
const RATES: [AccelDataRate; 6] = [
    AccelDataRate::Hz10,
    AccelDataRate::Hz25,
    AccelDataRate::Hz50,
    AccelDataRate::Hz100,
    AccelDataRate::Hz200,
    AccelDataRate::Hz400,
];

fn setting(rate: AccelDataRate, runs: Runs) -> Setting {
    Setting { rate, runs }
}

/// Samples between failsafe runs.
fn failsafe(rate: AccelDataRate) -> u32 {
    (f64::from(rate.nominal().0) * FAILSAFE_S) as u32
}

/// The share of a past change that the zero can have followed.
fn forgotten(decision: &Decision, memory: f64) -> f64 {
    1.0 - (-f64::from(decision.age - 1) / memory).exp()
}

/// Disagreement only as far from the threshold as the zero has moved.
fn is_explained(decision: &Decision, memory: f64) -> bool {
    let moved = forgotten(decision, memory) * decision.largest;
    decision.software == decision.chip || decision.distance() <= moved + ROUNDING
}

/// Every decision over all codes and streams.
fn over_all_codes(setting: &Setting, samples: u32, mut judge: impl FnMut(&Decision)) {
    for code in 1..=127 {
        for (n, kind) in (0..).zip(Kind::ALL) {
            let seed = 10_000 + u64::from(code) * 16 + n;
            watch(setting, code, (kind, seed), samples, &mut judge);
        }
    }
}

#[test]
fn over_all_codes_each_disagreement_lies_within_what_the_filter_forgot() {
    for rate in [AccelDataRate::Hz100, AccelDataRate::Hz400] {
        for runs in [Runs::Blind(160), Runs::AfterInterrupts(failsafe(rate))] {
            let setting = setting(rate, runs);
            over_all_codes(&setting, 400, |decision| {
                assert!(
                    is_explained(decision, setting.memory()),
                    "{setting:?} {decision:?}"
                );
            });
        }
    }
}

#[test]
fn within_a_fifth_of_the_time_constant_a_change_is_off_by_less_than_a_fifth() {
    let setting = setting(AccelDataRate::Hz100, Runs::Blind(16));
    let young = setting.memory() / 5.0;
    let mut seen = 0;
    over_all_codes(&setting, 400, |decision| {
        if f64::from(decision.age) <= young && decision.software != decision.chip {
            // 1 - exp(-1/5)
            let most = 0.1813 * decision.largest + ROUNDING;
            assert!(decision.distance() <= most, "{decision:?}");
            seen += 1;
        }
    });
    assert!(seen > 0, "the streams never came near the bound");
}

#[test]
fn re_armed_at_every_sample_the_chip_compares_with_the_previous_one() {
    for rate in RATES {
        let setting = setting(rate, Runs::EverySample);
        let mut asked = 0;
        over_all_codes(&setting, 100, |decision| {
            // A change of 800 or 1600 digits is code 49 or 98 to the last bit.
            assert!(
                decision.software == decision.chip || decision.distance() <= ROUNDING,
                "{rate:?} {decision:?}"
            );
            asked += u64::from(decision.software);
        });
        assert!(asked > 1000, "{rate:?}: {asked}");
    }
}

#[test]
fn before_its_interrupt_the_chip_misses_no_change_beyond_its_age_in_time_constants() {
    for rate in RATES {
        let setting = setting(rate, Runs::AfterInterrupts(failsafe(rate).max(1)));
        over_all_codes(&setting, 200, |decision| {
            // The zero moves by at most threshold / memory per sample.
            let grown = 1.0 + f64::from(decision.age - 1) / setting.memory();
            let most = decision.threshold * grown + ROUNDING;
            assert!(
                !decision.is_missed() || decision.change <= most,
                "{rate:?} {decision:?}"
            );
        });
    }
}

#[test]
fn before_any_change_above_the_threshold_the_chip_asks_only_for_what_is_left_of_it() {
    for rate in RATES {
        let setting = setting(rate, Runs::AfterInterrupts(failsafe(rate).max(1)));
        over_all_codes(&setting, 200, |decision| {
            let left = 1.0 - forgotten(decision, setting.memory());
            let least = decision.threshold * left - ROUNDING;
            let first = decision.largest <= decision.threshold;
            assert!(
                !(first && decision.is_extra()) || decision.change >= least,
                "{rate:?} {decision:?}"
            );
        });
    }
}

#[test]
fn a_code_lowered_by_the_worst_decay_misses_nothing() {
    for rate in [AccelDataRate::Hz200, AccelDataRate::Hz400] {
        let setting = setting(rate, Runs::AfterInterrupts(failsafe(rate)));
        let tally = lowered_sweep(&setting, 1..=127, (failsafe(rate), 200));
        assert!(tally.asked > 50, "{rate:?} {tally:?}");
        assert_eq!(tally.missed, 0, "{rate:?} {tally:?}");
    }
}

#[test]
fn a_ramp_as_fast_as_the_filter_hides_a_change_of_its_age_in_time_constants() {
    // 90 % of the threshold at once, and as much again per time constant.
    let setting = setting(AccelDataRate::Hz400, Runs::AfterInterrupts(40));
    let tau = setting.memory() / setting.rate_hz();
    let level = 0.9 * 50.0 * 0.016;
    let ramp = move |t: f64| {
        if t < 0.02 {
            0.0
        } else {
            level * (1.0 + (t - 0.02) / tau)
        }
    };
    let hidden = |code: u8| {
        let source = force_g(move |t| [ramp(t), 0.0, 1.0]);
        let mode = HighPassMode::ResetByReading;
        let mut rig = Rig::on(&setting, code, mode, (source, exact()));
        let decisions = (0..40).map(|_| rig.next());
        let missed = decisions.take_while(|decision| !decision.chip);
        missed.fold(0.0, |most: f64, decision| {
            most.max(decision.change / (50.0 * CODE))
        })
    };
    let (plain, scaled) = (hidden(50), hidden(26));
    assert!((1.35..1.63).contains(&plain), "{plain}");
    assert!(scaled < 1.0, "50 codes times exp(-0.628) = 26: {scaled}");
}

#[test]
fn the_board_s_rate_needs_no_lowering_and_its_fastest_does() {
    // The share of a time constant between two failsafe runs; a fifth is allowed.
    let shares = RATES.map(|rate| {
        let setting = setting(rate, Runs::EverySample);
        (FAILSAFE_S * setting.rate_hz() / setting.memory() * 1000.0).round() as u32
    });
    assert_eq!(shares, [13, 31, 63, 126, 314, 628]);
}

#[test]
fn reset_by_its_own_interrupt_the_chip_compares_with_the_last_interrupt_s_sample() {
    let setting = setting(AccelDataRate::Hz100, Runs::AfterInterrupts(1));
    let mut interrupts = 0;
    for code in 4..=127 {
        for (n, kind) in (0..).zip(Kind::ALL) {
            let seed = 30_000 + u64::from(code) * 16 + n;
            let samples = (200, HighPassMode::ResetAtInterrupt);
            let mut rig = Rig::new(&setting, code, (kind, seed), samples);
            // From power-up the zero is 0 g, not a sample: gravity trips it.
            let mut armed = false;
            for _ in 0..samples.0 {
                let decision = rig.next();
                if armed {
                    interrupts += u64::from(decision.chip);
                    let grown = 1.0 + f64::from(decision.age - 1) / setting.memory();
                    let most = decision.threshold * grown + ROUNDING;
                    assert!(
                        !decision.is_missed() || decision.change <= most,
                        "code {code} {decision:?}"
                    );
                }
                if decision.chip {
                    rig.run_without_the_bus();
                    armed = true;
                }
            }
        }
    }
    assert!(interrupts > 1000, "{interrupts}");
}

#[test]
fn the_streams_cross_every_threshold() {
    let setting = setting(AccelDataRate::Hz100, Runs::AfterInterrupts(10));
    for code in 1..=127 {
        let tally = sweep(&setting, [code], 400);
        assert!(tally.asked > 10, "code {code}: {tally:?}");
        assert!(tally.agreed() * 100 > tally.decisions * 90, "{tally:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 200,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_stream_code_and_rate_is_explained_by_the_filter(
        seed: u64,
        code in 1..=127_u8,
        kind in prop::sample::select(&Kind::ALL[..]),
        rate in prop::sample::select(&RATES[..]),
        longest in 1..400_u32,
        follows: bool,
    ) {
        let runs = if follows { Runs::AfterInterrupts(longest) } else { Runs::Blind(longest) };
        let setting = setting(rate, runs);
        let mut unexplained = None;
        watch(&setting, code, (kind, seed), 600, &mut |decision| {
            if !is_explained(decision, setting.memory()) {
                unexplained = Some(*decision);
            }
        });
        prop_assert!(unexplained.is_none(), "{:?}", unexplained);
    }
}
