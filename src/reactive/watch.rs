//! The watch of one input: its newest sample, held against a reference.

use super::Sample;
use crate::math::Vec3;
use crate::settings::Reference;

/// Measures the change of one input since its reference sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch<S = Vec3> {
    mode: Reference,
    reference: Option<S>,
    newest: Option<S>,
    /// The newest sample was put by.
    put_by: bool,
}

impl<S: Sample> Watch<S> {
    /// A watch that has seen nothing.
    #[must_use]
    pub fn new(mode: Reference) -> Self {
        Self {
            mode,
            reference: None,
            newest: None,
            put_by: false,
        }
    }

    /// Takes a filtered sample; its change, `None` for the first of all.
    pub fn take(&mut self, sample: &S) -> Option<f32> {
        let reference = self.reference.as_ref();
        let x = reference.map(|reference| sample.change_since(reference));
        self.newest = Some(*sample);
        self.put_by = false;
        if self.mode == Reference::PreviousSample || self.reference.is_none() {
            self.reference = Some(*sample);
        }
        x
    }

    /// Puts a sample by, to be compared should a run want to know; false where it has to be taken
    /// now: the first of all, and where the next is measured against it.
    #[must_use]
    pub fn puts_by(&mut self, sample: &S) -> bool {
        self.put_by = self.mode == Reference::LastRun && self.reference.is_some();
        if self.put_by {
            self.newest = Some(*sample);
        }
        self.put_by
    }

    /// The change of the newest sample, where that was put by.
    pub fn compare(&mut self) -> Option<f32> {
        let newest = self.newest.filter(|_| core::mem::take(&mut self.put_by))?;
        Some(newest.change_since(self.reference.as_ref()?))
    }

    /// A run happened: with `last-run`, the newest sample becomes the reference.
    pub fn on_run(&mut self) {
        if self.mode == Reference::LastRun {
            self.reference = self.newest.or(self.reference);
        }
        self.put_by = false;
    }

    /// What is measured against is this sample now.
    pub fn rearm(&mut self, sample: S) {
        self.newest = Some(sample);
        self.reference = Some(sample);
        self.put_by = false;
    }

    /// The newest sample.
    #[must_use]
    pub fn newest(&self) -> Option<S> {
        self.newest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along_x(x: f32) -> Vec3 {
        Vec3::new(x, 0.0, 0.0)
    }

    fn largest_change_of_a_ramp(mode: Reference) -> f32 {
        let mut watch = Watch::new(mode);
        let samples = (0..10).map(|step| along_x(step as f32 * 0.03));
        samples
            .filter_map(|sample| watch.take(&sample))
            .fold(0.0, f32::max)
    }

    #[test]
    fn a_slow_ramp_adds_up_against_the_last_run_only() {
        assert!((largest_change_of_a_ramp(Reference::LastRun) - 0.27).abs() < 1e-6);
        assert!((largest_change_of_a_ramp(Reference::PreviousSample) - 0.03).abs() < 1e-6);
    }

    #[test]
    fn the_first_sample_has_no_change() {
        assert_eq!(Watch::new(Reference::LastRun).take(&along_x(1.0)), None);
    }

    #[test]
    fn after_a_run_the_newest_sample_is_the_reference() {
        let mut watch = Watch::new(Reference::LastRun);
        watch.take(&along_x(0.0));
        watch.take(&along_x(0.5));
        watch.on_run();
        assert_eq!(watch.take(&along_x(0.75)), Some(0.25));
    }

    #[test]
    fn a_sample_that_was_put_by_is_compared_once_with_what_it_came_behind() {
        let mut watch = Watch::new(Reference::LastRun);
        assert!(!watch.puts_by(&along_x(0.0)), "the first is the reference");
        watch.take(&along_x(0.0));
        assert!(watch.puts_by(&along_x(0.25)) && watch.puts_by(&along_x(0.5)));
        assert_eq!((watch.compare(), watch.compare()), (Some(0.5), None));
        assert!(watch.puts_by(&along_x(1.0)));
        watch.on_run();
        assert_eq!(watch.compare(), None, "measured before the run");
        assert_eq!(watch.take(&along_x(1.25)), Some(0.25));
        assert!(!Watch::new(Reference::PreviousSample).puts_by(&along_x(0.0)));
    }

    #[test]
    fn an_armed_sample_is_the_reference_whatever_came_before() {
        let mut watch = Watch::new(Reference::LastRun);
        watch.take(&along_x(3.0));
        watch.rearm(along_x(0.5));
        assert_eq!(watch.take(&along_x(0.75)), Some(0.25));
    }
}
