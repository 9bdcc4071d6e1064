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
}

impl<S: Sample> Watch<S> {
    /// A watch that has seen nothing.
    #[must_use]
    pub fn new(mode: Reference) -> Self {
        Self {
            mode,
            reference: None,
            newest: None,
        }
    }

    /// Takes a filtered sample; its change, `None` for the first of all.
    pub fn take(&mut self, sample: &S) -> Option<f32> {
        let reference = self.reference.as_ref();
        let x = reference.map(|reference| sample.change_since(reference));
        self.newest = Some(*sample);
        if self.mode == Reference::PreviousSample || self.reference.is_none() {
            self.reference = Some(*sample);
        }
        x
    }

    /// A run happened: with `last-run`, the newest sample becomes the reference.
    pub fn on_run(&mut self) {
        if self.mode == Reference::LastRun {
            self.reference = self.newest.or(self.reference);
        }
    }

    /// What is measured against is this sample now.
    pub fn rearm(&mut self, sample: S) {
        self.newest = Some(sample);
        self.reference = Some(sample);
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
    fn an_armed_sample_is_the_reference_whatever_came_before() {
        let mut watch = Watch::new(Reference::LastRun);
        watch.take(&along_x(3.0));
        watch.rearm(along_x(0.5));
        assert_eq!(watch.take(&along_x(0.75)), Some(0.25));
    }
}
