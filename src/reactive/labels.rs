//! Bounded statistics of one input: labels counted in bins of the change.
//!
//! A label is a change `x` and whether the command would have changed. Bins are spaced by the
//! logarithm of `x`; each keeps the weight of its labels, the part that was *changed*, and the
//! weighted sum of `x`, so that a bin speaks for the mean of what fell into it and not for its
//! middle. 308 bytes an input, whatever the length of the flight.

use crate::config::Changes;

/// Number of bins.
pub const BIN_COUNT: usize = 24;

/// Labels of one input, by change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Labels {
    bins: [Bin; BIN_COUNT],
    smallest: f32,
    per_bin: f32,
    unchanged: f32,
    changed: f32,
    overtaken: f32,
    /// What the bins are still to be multiplied by.
    ///
    /// Forgetting comes with the swap of a model, under a lock that is to be short; the bins
    /// follow with the next label, or in the copy that is fitted.
    due: f32,
}

/// One label: what a run did, or would have done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Label {
    /// The change, in the input's unit.
    pub x: f32,
    /// The command changed by a quantum or more.
    pub changed: bool,
    /// How much it counts.
    pub weight: f32,
}

/// The labels whose change fell into one interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bin {
    /// Weight of all labels.
    pub(super) weight: f32,
    /// Weight of the labels that were *changed*.
    pub(super) changed: f32,
    /// Weighted sum of the changes.
    pub(super) sum: f32,
}

/// A number that grows with the logarithm of a positive `x`: its bits.
///
/// The bits of a float are its exponent followed by its mantissa, a logarithm to base two with
/// straight lines between powers: exact enough to space bins by, and one instruction.
fn logarithm(x: f32) -> f32 {
    (x.to_bits() >> 8) as f32
}

impl Labels {
    /// No labels, bins spanning the input's changes.
    #[must_use]
    pub fn new(changes: &Changes) -> Self {
        let smallest = logarithm(changes.smallest);
        let span = logarithm(changes.largest) - smallest;
        Self {
            bins: [Bin::default(); BIN_COUNT],
            smallest,
            per_bin: BIN_COUNT as f32 / span,
            unchanged: 0.0,
            changed: 0.0,
            overtaken: 0.0,
            due: 1.0,
        }
    }

    /// Counts a label; one that is not finite or negative, or of no weight, is ignored.
    pub fn add(&mut self, label: &Label) {
        let &Label { x, changed, weight } = label;
        if !(x >= 0.0 && x.is_finite() && weight > 0.0 && weight.is_finite()) {
            return;
        }
        let place = (logarithm(x) - self.smallest) * self.per_bin;
        let place = (place.max(0.0) as usize).min(BIN_COUNT - 1);
        self.settle();
        let Some(bin) = self.bins.get_mut(place) else {
            return;
        };
        bin.weight += weight;
        bin.sum += weight * x;
        if changed {
            bin.changed += weight;
            self.changed += weight;
        } else {
            self.unchanged += weight;
        }
    }

    /// Forgets: every weight is multiplied by `share`, within 0 to 1.
    pub fn fade(&mut self, share: f32) {
        let share = share.max(0.0);
        self.due *= share;
        self.changed *= share;
        self.unchanged *= share;
        self.overtaken *= share;
    }

    /// Brings the bins up to date with what was forgotten.
    pub(super) fn settle(&mut self) {
        let due = core::mem::replace(&mut self.due, 1.0);
        if due == 1.0 {
            return;
        }
        for bin in &mut self.bins {
            bin.weight *= due;
            bin.changed *= due;
            bin.sum *= due;
        }
    }

    /// Counts a hold that the leading input ended before this one's change told anything.
    pub fn add_overtaken(&mut self) {
        self.overtaken += 1.0;
    }

    /// The weight of all labels, and of the holds that the leading input ended.
    #[must_use]
    pub fn with_overtaken(&self) -> f32 {
        self.total() + self.overtaken
    }

    /// The weight of labels that were *changed*.
    #[must_use]
    pub fn of_changed(&self) -> f32 {
        self.changed
    }

    /// The weight of labels of the rarer class.
    #[must_use]
    pub fn of_rarer_class(&self) -> f32 {
        // Unlike `f32::min`, no call: asked for every input under the lock that swaps a model.
        if self.changed < self.unchanged {
            self.changed
        } else {
            self.unchanged
        }
    }

    /// The weight of all labels.
    #[must_use]
    pub fn total(&self) -> f32 {
        self.changed + self.unchanged
    }

    /// Bins that hold labels, to be looked at once they are settled.
    pub(super) fn bins(&self) -> impl Iterator<Item = &Bin> + Clone {
        self.bins.iter().filter(|bin| bin.weight > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::GYRO;
    use proptest::prelude::*;

    fn label(x: f32, changed: bool, weight: f32) -> Label {
        Label { x, changed, weight }
    }

    #[test]
    fn the_statistics_of_an_input_take_at_most_512_bytes() {
        assert!(size_of::<Labels>() <= 512);
    }

    #[test]
    fn labels_that_are_no_numbers_are_ignored() {
        let mut labels = Labels::new(&GYRO.changes);
        for x in [f32::NAN, f32::INFINITY, -1.0] {
            labels.add(&label(x, true, 1.0));
        }
        labels.add(&label(0.1, true, 0.0));
        assert_eq!(labels.total(), 0.0);
    }

    #[test]
    fn labels_after_a_forgetting_count_in_full_and_those_before_it_by_their_share() {
        let mut labels = Labels::new(&GYRO.changes);
        labels.add(&label(0.5, true, 8.0));
        labels.fade(0.5);
        labels.fade(0.5);
        assert_eq!(labels.total(), 2.0);
        labels.add(&label(0.5, false, 1.0));
        let weights: Vec<f32> = labels.bins().map(|bin| bin.weight).collect();
        assert_eq!((weights, labels.total()), (vec![3.0], 3.0));
        labels.fade(0.0);
        labels.settle();
        assert_eq!(labels.bins().count(), 0);
    }

    proptest! {
        #[test]
        fn every_label_is_counted_once_and_bins_keep_their_mean(
            xs in prop::collection::vec((0.0f32..10.0, any::<bool>()), 1..300)
        ) {
            let mut labels = Labels::new(&GYRO.changes);
            for &(x, changed) in &xs {
                labels.add(&label(x, changed, 1.0));
            }
            prop_assert_eq!(labels.total(), xs.len() as f32);
            let sum: f32 = labels.bins().map(|bin| bin.sum).sum();
            let expected: f32 = xs.iter().map(|(x, _)| x).sum();
            prop_assert!((sum - expected).abs() <= 1e-3 * expected.max(1.0));
        }
    }
}
