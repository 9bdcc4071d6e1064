//! However the sensors behave, control never pauses longer than it may.

use super::*;
use proptest::prelude::*;

/// What the sensors do for a while.
#[derive(Clone, Copy, Debug)]
enum Spell {
    /// Noise of so many counts.
    Noise(i16),
    /// The gyroscope is dead.
    Silent,
    /// It repeats itself.
    Stuck,
    /// Every sample may be missing.
    Patchy(u8),
}

fn spells() -> impl Strategy<Value = Vec<(u64, Spell)>> {
    let spell = prop_oneof![
        (0i16..4000).prop_map(Spell::Noise),
        Just(Spell::Silent),
        Just(Spell::Stuck),
        (1u8..250).prop_map(Spell::Patchy),
    ];
    prop::collection::vec((1u64..1_500, spell), 1..12)
}

fn rate(spell: Spell, random: &mut oorandom::Rand32) -> Option<i16> {
    let chance = random.rand_u32() >> 24;
    let noise = |size: i16| random.rand_range(0..2 * size as u32 + 1) as i16 - size;
    match spell {
        Spell::Noise(size) => Some({ noise }(size)),
        Spell::Silent => None,
        Spell::Stuck => Some(300),
        Spell::Patchy(share) => (chance >= u32::from(share)).then(|| { noise }(200)),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_gap_between_runs_is_longer_than_the_failsafe_and_a_hyperperiod(
        spells in spells(), seed: u64, chip_asks: bool, fixed: bool, failsafe in 10_000u64..200_000,
    ) {
        let settings = Settings {
            failsafe: micros(failsafe),
            warm_up: if fixed { WarmUp::Fixed(micros(500_000)) } else { WarmUp::Automatic },
            ..SETTINGS
        };
        let mut random = oorandom::Rand32::new(seed);
        let mut rig = Rig::armed(settings);
        rig.outputs.clear();
        let began = rig.now;
        for (length, spell) in spells {
            for _ in 0..length {
                rig.milliseconds(1, |_| rate(spell, &mut random));
                if chip_asks && random.rand_u32() >> 22 == 0 {
                    let sample = force([random.rand_u32() as i16, 0, -8192], Cause::Threshold);
                    let now = at_micros(rig.now);
                    let _ = rig.autopilot.on_chip(now, &sample);
                    if let Some(output) = rig.autopilot.on_hyperperiod(now) {
                        rig.outputs.push((rig.now, output.share()));
                    }
                }
            }
        }
        let ends = core::iter::once(began).chain(rig.outputs.iter().map(|(at, _)| *at));
        let ends: Vec<u64> = ends.chain(core::iter::once(rig.now)).collect();
        let longest = ends.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap_or(0);
        let bound = settings.failsafe + HYPERPERIOD;
        prop_assert!(longest <= bound.ticks(), "{longest} us");
        for (_, shares) in &rig.outputs {
            prop_assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)));
        }
    }
}
