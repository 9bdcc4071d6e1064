//! A half's comparator: thresholds in SI units rounded down to its codes, once.
//!
//! An owner orders a threshold in the half's SI unit. The answer says which thresholds the setting
//! serves, so that the owner need not order again while its own threshold stays among them. No
//! code leaves this crate.

use super::super::{AccelDataRate, AccelThreshold, MAG_STEP, MagThreshold};
use super::upkeep::{CORNER, FULL_SCALE};
use crate::orders::ChipSetting;
use crate::quantity::Seconds;
use crate::threshold::round_down;

/// Share of its time constant for which the high-pass filter may forget without a lower code.
const FORGOTTEN: f32 = 0.2;

/// The code of the finest threshold: code 0 would fire at every sample.
const FINEST: u16 = 1;

/// Codes of a comparator and the changes that they stand for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Comparator {
    largest: u16,
    /// Change per code, in m/s2 or in gauss.
    step: f32,
    /// Share of a change that reaches the comparison when the reference is oldest.
    kept: f32,
}

impl Comparator {
    pub(super) const MAG: Self = Self {
        largest: MagThreshold::LARGEST_USEFUL.code(),
        step: MAG_STEP.0,
        kept: 1.0,
    };

    /// The accelerometer's, whose reference is renewed every `longest_hold` or sooner.
    ///
    /// Its high-pass filter forgets the reference. Where it may forget more than a fifth of its
    /// time constant, codes are lower by the worst decay, so that no change is missed.
    pub(super) fn accel(rate: AccelDataRate, longest_hold: Seconds) -> Self {
        let age = longest_hold.0 * core::f32::consts::TAU * CORNER.frequency(rate).0;
        Self {
            largest: AccelThreshold::MAX.code() as u16,
            step: FULL_SCALE.threshold_step().0,
            kept: if age > FORGOTTEN {
                libm::expf(-age)
            } else {
                1.0
            },
        }
    }

    /// The code that a threshold is rounded down to, at most the largest; the finest for one that is
    /// finer still, or not a number.
    pub(super) fn code(&self, threshold: f32) -> u16 {
        round_down(threshold, self.largest, |code| self.change(code)).unwrap_or(FINEST)
    }

    /// What a half interrupts for under a code; 0 for every sample.
    pub(super) fn setting(&self, code: u16) -> ChipSetting {
        match code {
            0 => ChipSetting::EverySample,
            code => ChipSetting::PastThreshold {
                level: self.change(code),
                from: if code > FINEST {
                    self.change(code)
                } else {
                    f32::NEG_INFINITY
                },
                next: if code < self.largest {
                    self.change(code + 1)
                } else {
                    f32::INFINITY
                },
            },
        }
    }

    fn change(&self, code: u16) -> f32 {
        f32::from(code) * self.step / self.kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn comparators() -> [Comparator; 3] {
        let rate = AccelDataRate::Hz400;
        [
            Comparator::accel(rate, Seconds(0.01)),
            Comparator::accel(rate, Seconds(0.1)),
            Comparator::MAG,
        ]
    }

    #[test]
    fn a_setting_serves_the_thresholds_that_are_rounded_down_to_its_code_and_no_others() {
        for comparator in comparators() {
            for code in 1..=comparator.largest {
                let ChipSetting::PastThreshold { level, from, next } = comparator.setting(code)
                else {
                    panic!("code {code} compares");
                };
                assert_eq!(comparator.code(level), code);
                if code > FINEST {
                    assert_eq!((from, comparator.code(from.next_down())), (level, code - 1));
                }
                if code < comparator.largest {
                    assert_eq!(comparator.code(next.next_down()), code);
                    assert_eq!(comparator.code(next), code + 1);
                } else {
                    assert_eq!((next, comparator.code(f32::MAX)), (f32::INFINITY, code));
                }
            }
        }
    }

    #[test]
    fn what_is_finer_than_one_code_is_served_by_the_finest() {
        for comparator in comparators() {
            let finest = comparator.setting(FINEST);
            for finer in [comparator.change(FINEST).next_down(), 0.0, -1.0] {
                assert_eq!(comparator.code(finer), FINEST);
                assert!(finest.serves(finer), "{finer}");
            }
            assert_eq!(comparator.code(f32::NAN), FINEST);
            assert!(!comparator.setting(0).serves(0.0), "every sample");
        }
    }

    #[test]
    fn codes_are_lower_where_the_filter_forgets_before_its_reference_is_renewed() {
        // A corner of 1 Hz at 400 Hz: 0.1 s are 0.63 of its time constant.
        let [fresh, old, _] = comparators();
        let threshold = 100.0 * fresh.step;
        assert_eq!(fresh.code(1.001 * threshold), 100);
        assert_eq!(old.code(1.001 * threshold), 53);
    }
}
