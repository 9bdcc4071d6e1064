//! Bounded statistics of one input: labels counted in bins of the change.
//!
//! A label is a change `x` and whether the command would have changed. Bins are spaced by the
//! logarithm of `x`; each keeps, for either outcome by itself, the weight of its labels and their
//! weighted sum of `x`, so that a bin speaks for the means of what fell into it and not for its
//! middle: one mean for both would hide that within a bin too the larger changes are those that
//! were *changed*. 408 bytes an input, whatever the length of the flight.

use crate::config::Changes;
use crate::math::sqrt;

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
    /// The run was, or would have been, *changed*.
    pub changed: bool,
    /// How much it counts.
    pub weight: f32,
}

/// The labels whose change fell into one interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bin {
    /// Labels without a changed command.
    pub(super) unchanged: Heap,
    /// Labels that were *changed*.
    pub(super) changed: Heap,
}

/// What a bin holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counted {
    /// Mean change of its labels, in the input's unit.
    pub change: f32,
    /// Weight of those that were *changed*.
    pub changed: f32,
    /// Weight of the others.
    pub unchanged: f32,
}

/// Labels of one outcome in one bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Heap {
    /// Their weight.
    pub(super) weight: f32,
    /// Weighted sum of their changes.
    pub(super) sum: f32,
}

/// Labels of one outcome, as if they all had one change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// The change.
    pub(super) x: f32,
    /// Their outcome.
    pub(super) changed: bool,
    /// Their weight.
    pub(super) weight: f32,
}

impl Bin {
    /// Weight of all labels.
    pub(super) fn weight(&self) -> f32 {
        self.changed.weight + self.unchanged.weight
    }

    /// Weighted sum of all changes.
    pub(super) fn sum(&self) -> f32 {
        self.changed.sum + self.unchanged.sum
    }

    fn fade(&mut self, share: f32) {
        for heap in [&mut self.unchanged, &mut self.changed] {
            heap.weight *= share;
            heap.sum *= share;
        }
    }
}

impl Heap {
    /// Two points that stand for the heap: its mean, and how widely it lies in its bin.
    ///
    /// Of a heap whose mean is the middle of the bin nothing is known but that it fills it; the
    /// variance of a beta distribution with that property, `(x-a)(b-x)/3`, goes to that of a
    /// heap at the bin's edge when the mean does. Not spread, a steep model would see a step
    /// between two means that are only the means of what overlaps.
    fn points(&self, changed: bool, ends: (f32, f32)) -> [Point; 2] {
        let mean = self.sum / self.weight;
        let room = (mean - ends.0).min(ends.1 - mean).max(0.0);
        let variance = (mean - ends.0) * (ends.1 - mean) / 3.0;
        let spread = if room > 0.0 {
            sqrt(variance).min(room)
        } else {
            0.0
        };
        [mean - spread, mean + spread].map(|x| Point {
            x,
            changed,
            weight: self.weight / 2.0,
        })
    }
}

/// A number that grows with the logarithm of a positive `x`: its bits.
///
/// The bits of a float are its exponent followed by its mantissa, a logarithm to base two with
/// straight lines between powers: exact enough to space bins by, and one instruction.
fn logarithm(x: f32) -> f32 {
    (x.to_bits() >> 8) as f32
}

/// The inverse of [`logarithm`].
fn power(logarithm: f32) -> f32 {
    f32::from_bits((logarithm as u32) << 8)
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
        let place = self.place(x);
        self.settle();
        let Some(bin) = self.bins.get_mut(place) else {
            return;
        };
        let (heap, total) = if changed {
            (&mut bin.changed, &mut self.changed)
        } else {
            (&mut bin.unchanged, &mut self.unchanged)
        };
        heap.weight += weight;
        heap.sum += weight * x;
        *total += weight;
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
            bin.fade(due);
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
        self.bins.iter().filter(|bin| bin.weight() > 0.0)
    }

    /// All labels, as few points.
    pub(super) fn points(&self) -> impl Iterator<Item = Point> + Clone {
        let bins = self.bins.iter().enumerate();
        bins.flat_map(|(place, bin)| {
            let ends = self.ends(place);
            [(bin.unchanged, false), (bin.changed, true)]
                .into_iter()
                .filter(|(heap, _)| heap.weight > 0.0)
                .flat_map(move |(heap, changed)| heap.points(changed, ends))
        })
    }

    /// What each bin that holds labels holds.
    pub fn counted(&self) -> impl Iterator<Item = Counted> + '_ {
        self.bins().map(|bin| Counted {
            change: bin.sum() / bin.weight(),
            changed: bin.changed.weight * self.due,
            unchanged: bin.unchanged.weight * self.due,
        })
    }

    /// The width of the bin that a change falls into, in the input's unit.
    #[must_use]
    pub fn bin_width(&self, x: f32) -> f32 {
        let (lower, upper) = self.ends(self.place(x));
        upper - lower
    }

    /// The number of the bin that a change falls into.
    fn place(&self, x: f32) -> usize {
        let place = (logarithm(x.max(0.0)) - self.smallest) * self.per_bin;
        (place.max(0.0) as usize).min(BIN_COUNT - 1)
    }

    /// The changes that a bin holds; the last holds all beyond, and as nothing is known of how
    /// far they lie, it is not wider than the others.
    fn ends(&self, place: usize) -> (f32, f32) {
        let end = |place: usize| power(self.smallest + place as f32 / self.per_bin);
        let lower = if place == 0 { 0.0 } else { end(place) };
        (lower, end(place + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::of_input;
    use crate::sensors::Input;
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
        let mut labels = Labels::new(&of_input(Input::Gyro).changes);
        for x in [f32::NAN, f32::INFINITY, -1.0] {
            labels.add(&label(x, true, 1.0));
        }
        labels.add(&label(0.1, true, 0.0));
        assert_eq!(labels.total(), 0.0);
    }

    #[test]
    fn labels_after_a_forgetting_count_in_full_and_those_before_it_by_their_share() {
        let mut labels = Labels::new(&of_input(Input::Gyro).changes);
        labels.add(&label(0.5, true, 8.0));
        labels.fade(0.5);
        labels.fade(0.5);
        assert_eq!(labels.total(), 2.0);
        labels.add(&label(0.5, false, 1.0));
        let weights: Vec<f32> = labels.bins().map(Bin::weight).collect();
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
            let mut labels = Labels::new(&of_input(Input::Gyro).changes);
            for &(x, changed) in &xs {
                labels.add(&label(x, changed, 1.0));
            }
            prop_assert_eq!(labels.total(), xs.len() as f32);
            let sum: f32 = labels.bins().map(Bin::sum).sum();
            let expected: f32 = xs.iter().map(|(x, _)| x).sum();
            prop_assert!((sum - expected).abs() <= 1e-3 * expected.max(1.0));
        }
    }
}
