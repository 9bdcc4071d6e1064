//! The error of the estimated heading, from a magnetometer or an external pose.

use crate::math::{Vec3, atan2, wrapped};
use crate::time::{Duration, Instant, micros, span};

/// How long a measured error of the heading is believed.
const LIFE: Duration = micros(200_000);

/// The weakest horizontal field (gauss) that shows a heading; Earth's is 0.1 and more below
/// 70 degrees of latitude.
const WEAKEST_FIELD: f32 = 0.05;

/// The newest error, and what it is measured against.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Heading {
    /// Direction of the horizontal field when it was first seen, rad in Earth axes.
    reference: Option<f32>,
    error: Option<(Instant, f32)>,
    /// When an external pose last gave a heading: it goes before the magnetometer.
    pose_at: Option<Instant>,
}

impl Heading {
    /// Takes a field in Earth axes: its direction, held against the one first seen, shows drift.
    pub(super) fn take_field(&mut self, at: Instant, earth: Vec3) {
        let pose_leads = self.pose_at.is_some_and(|pose| span(pose, at) <= LIFE);
        let weak = earth.x.abs().max(earth.y.abs()) < WEAKEST_FIELD;
        if weak || pose_leads {
            return;
        }
        let direction = atan2(earth.y, earth.x);
        let reference = *self.reference.get_or_insert(direction);
        self.error = Some((at, wrapped(reference - direction)));
    }

    /// Takes the error (rad) against the heading of an external pose.
    pub(super) fn take_pose_error(&mut self, at: Instant, error: f32) {
        *self = Self {
            // Once the pose falls silent, the field holds the heading that it left.
            reference: None,
            error: Some((at, error)),
            pose_at: Some(at),
        };
    }

    /// The error (rad), while it is fresh.
    pub(super) fn error(&self, now: Instant) -> Option<f32> {
        self.error
            .filter(|(at, _)| span(*at, now) <= LIFE)
            .map(|(_, error)| error)
    }
}
