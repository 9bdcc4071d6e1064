//! Random scripts, which shrink: fewer faults, sooner, shorter, milder.
//!
//! They are strategies of `proptest`, whose values know how to become simpler.

use proptest::collection::vec;
use proptest::prelude::{Strategy, any};
use proptest::sample::{Index, select};

use super::kinds::{KINDS, Kind, Size};
use super::script::{Entry, Limits};

/// Most faults of a script.
const MOST: usize = 3;
/// Seeds of what is random in a fault.
const SEEDS: u32 = 1000;
/// Shares of the longest time from which on a fault holds for ever.
const FOR_EVER: f64 = 1.0;

/// Any script that a flight of these limits can play.
pub fn any_script(limits: Limits) -> impl Strategy<Value = Vec<Entry>> {
    vec(any_fault(limits), 1..=MOST)
}

fn any_fault(limits: Limits) -> impl Strategy<Value = Entry> {
    let of_kind = |kind: &'static Kind| {
        let places = kind.places.iter().copied();
        let playable: Vec<_> = places.filter(|place| limits.allow(kind, place)).collect();
        (!playable.is_empty()).then_some((kind, playable))
    };
    let kinds: Vec<_> = KINDS.iter().filter_map(of_kind).collect();
    // Another kind or place is no simpler.
    let what = (select(kinds), any::<Index>()).no_shrink();
    let shares = (0.0..1.0, 0.0..1.3 * FOR_EVER, 0.0..=1.0);
    let rest = (shares, any::<bool>(), 0..SEEDS);
    (what, rest).prop_map(move |(what, ((begins, lasts, size), most, seed))| {
        let ((kind, places), place) = what;
        let at_s = thousandths(begins * limits.duration_s);
        let left_s = limits.duration_s - at_s;
        let for_s = (lasts < FOR_EVER).then(|| thousandths(cubed(lasts) * left_s));
        Entry {
            what: kind.name.to_owned(),
            place: (*place.get(&places)).to_owned(),
            at_s,
            for_s,
            size: kind.size.map(|of| of.at(size, most)),
            unit: kind.size.map(|of| of.unit.to_owned()),
            seed,
        }
    })
}

impl Limits {
    /// The flight can play a kind at a place.
    fn allow(&self, kind: &Kind, place: &str) -> bool {
        let size = kind.size.map_or(0.0, |size| size.range[1]);
        let effect = (kind.effect)(place, size);
        effect.is_some_and(|effect| self.refusal(effect).is_none())
    }
}

impl Size {
    /// A size, from harmless at 0 to the most or the least at 1.
    fn at(&self, share: f64, most: bool) -> f64 {
        let [least, largest] = self.range;
        let worst = if most { largest } else { least };
        let size = self.harmless + cubed(share) * (worst - self.harmless);
        let digits = 10_f64.powi(2 - size.abs().max(1e-3).log10().floor() as i32);
        ((size * digits).round() / digits).clamp(least, largest)
    }
}

/// Small values are as likely as large ones are.
fn cubed(share: f64) -> f64 {
    share * share * share
}

/// As people write it; never later.
fn thousandths(seconds: f64) -> f64 {
    (seconds * 1e3).floor() / 1e3
}

#[cfg(test)]
mod tests {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;

    use super::super::script::Script;
    use super::*;

    const LIMITS: Limits = Limits {
        take_off_ns: 1_500_000_000,
        duration_s: 15.0,
        motors: Some(4),
        is_native: false,
    };

    fn read(text: &str) -> Script {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("faults.toml");
        std::fs::write(&file, text).unwrap();
        Script::read(&file, &LIMITS).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    #[test]
    fn every_random_script_is_one_that_can_be_written_and_read() {
        let mut runner = TestRunner::deterministic();
        let mut kinds = std::collections::BTreeSet::new();
        for _ in 0..2_000 {
            let script = any_script(LIMITS).new_tree(&mut runner).unwrap().current();
            let faults = read(&Script::written(&script).unwrap());
            assert_eq!(faults.iter().count(), script.len());
            kinds.extend(script.into_iter().map(|fault| fault.what));
        }
        let missing = KINDS.iter().map(|kind| kind.name);
        let missing: Vec<_> = missing.filter(|name| !kinds.contains(*name)).collect();
        assert_eq!(missing, ["unfit"], "native only");
    }

    #[test]
    fn the_simplest_of_a_script_is_one_mild_fault_at_once() {
        let mut runner = TestRunner::deterministic();
        let mut tree = any_script(LIMITS).new_tree(&mut runner).unwrap();
        while tree.simplify() {}
        let [fault] = &*tree.current() else {
            panic!("{:?}", tree.current());
        };
        assert!(fault.at_s < 0.01, "{fault:?}");
        assert!(fault.for_s.is_some_and(|for_s| for_s < 0.01), "{fault:?}");
    }
}
