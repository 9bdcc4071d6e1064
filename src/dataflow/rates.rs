//! Periods and rates, computed by the compiler.

/// The longest hyperperiod that is accepted, in us: what waits for a run ages.
pub const LONGEST_HYPERPERIOD: u64 = 20_000;

/// The least common multiple of a period (us) and, where it gates, of one more.
///
/// Zero stands for no period yet; a multiple that no `u64` holds counts as the longest.
#[must_use]
pub const fn joint_period(until: u64, period: u64, gates: bool) -> u64 {
    if !gates || period == 0 {
        return until;
    }
    if until == 0 {
        return period;
    }
    let (mut a, mut b) = (until, period);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    (until / a).saturating_mul(period)
}

/// The most updates of a value in 1000 s (so, in mHz) that inputs of these periods (us) cause.
///
/// Inputs are taken together at the end of a hyperperiod, so there are no more updates than
/// hyperperiods; zero stands for none. Runs of the failsafe come on top.
#[must_use]
pub const fn most_updates(periods: &[u64], hyperperiod: u64) -> u64 {
    let mut sum = 0u64;
    let mut left = periods;
    while let [period, rest @ ..] = left {
        // The compiler refuses a period of zero where it is declared.
        sum = sum.saturating_add(match 1_000_000_000u64.checked_div(*period) {
            Some(rate) => rate,
            None => 0,
        });
        left = rest;
    }
    if hyperperiod == 0 || sum < 1_000_000_000 / hyperperiod {
        sum
    } else {
        1_000_000_000 / hyperperiod
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_joint_period_is_a_multiple_of_both_and_the_least(a in 1u64..2000, b in 1u64..2000) {
            let joint = joint_period(joint_period(0, a, true), b, true);
            let least = (1..).map(|times| times * a).find(|it| it % b == 0);
            prop_assert_eq!(Some(joint), least);
        }
    }

    #[test]
    fn what_does_not_gate_leaves_the_period_alone() {
        assert_eq!(joint_period(1000, 2500, false), 1000);
        assert_eq!(joint_period(1000, 2500, true), 5000);
        assert_eq!(joint_period(u64::MAX, 2, true), u64::MAX);
    }

    #[test]
    fn a_value_is_updated_as_often_as_its_inputs_come_but_once_a_hyperperiod() {
        assert_eq!(most_updates(&[20_000, 100_000], 1000), 60_000);
        assert_eq!(most_updates(&[1000, 1000], 1000), 1_000_000);
        assert_eq!(most_updates(&[1000, 1000], 0), 2_000_000);
    }
}
