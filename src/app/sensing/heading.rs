//! The error of the estimated heading, from a magnetometer or an external pose.
//!
//! Of the magnetometer's field only what can be Earth's is followed: as strong and as steep as
//! when it was first seen, and from where it was seen before. Iron and currents that bend it leave
//! the heading to the gyroscope, which drifts far less than they bend. A field that stays bent for
//! [`BENT`] holds the heading from then on, wherever it points.

use crate::math::{Quaternion, Vec3, atan2, sqrt, wrapped};
use crate::time::{Duration, Instant, micros, seconds, span};

/// How long a measured error of the heading is believed.
const LIFE: Duration = micros(200_000);

/// The weakest horizontal field (gauss) that shows a heading; Earth's is 0.1 and more below
/// 70 degrees of latitude.
const WEAKEST_FIELD: f32 = 0.05;

/// How far the strength may be from what it was first, as a share: a tilted estimate changes none.
const STRENGTH: f32 = 0.3;
/// How far the dip may be, in rad: 17 degrees, by which the estimate's tilt may be wrong.
const DIP: f32 = 0.3;
/// How far the error of the heading may move at once, in rad, and how much further in a second.
const JUMP: f32 = 0.35;
const DRIFT: f32 = 0.02;
/// A field that was bent for this long is told of.
const TOLD: Duration = micros(500_000);
/// Bent for this long, it is the field of this place.
const BENT: Duration = micros(20_000_000);

/// A field in Earth axes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Field {
    strength: f32,
    /// How steeply it points down, rad.
    dip: f32,
    /// Direction of its horizontal part, rad.
    direction: f32,
}

impl Field {
    fn of(earth: Vec3) -> Self {
        let level = sqrt(earth.x * earth.x + earth.y * earth.y);
        Self {
            strength: earth.norm(),
            dip: atan2(earth.z, level),
            direction: atan2(earth.y, earth.x),
        }
    }

    /// True where it is as strong and as steep as another.
    fn is_like(&self, other: &Self) -> bool {
        (self.strength - other.strength).abs() <= STRENGTH * other.strength
            && (self.dip - other.dip).abs() <= DIP
    }
}

/// The newest error, and what it is measured against.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Heading {
    /// The field when it was first seen.
    reference: Option<Field>,
    error: Option<(Instant, f32)>,
    /// When an external pose last gave a heading: it goes before the magnetometer.
    pose_at: Option<Instant>,
    /// Since when the field is bent, and whether that was told.
    bent: Option<(Instant, bool)>,
    /// The newest field that was followed, gauss in Earth axes.
    earth: Option<Vec3>,
}

impl Heading {
    /// Takes a field in Earth axes: its direction, held against the one first seen, shows drift.
    ///
    /// True once per time that it is bent, and not followed.
    pub(super) fn take_field(&mut self, at: Instant, earth: Vec3) -> bool {
        let pose_leads = self.pose_at.is_some_and(|pose| span(pose, at) <= LIFE);
        let weak = earth.x.abs().max(earth.y.abs()) < WEAKEST_FIELD;
        if weak && self.reference.is_none() || pose_leads {
            return false;
        }
        let field = Field::of(earth);
        let reference = *self.reference.get_or_insert(field);
        let error = wrapped(reference.direction - field.direction);
        if !weak && field.is_like(&reference) && self.follows(at, error) {
            self.error = Some((at, error));
            self.bent = None;
            self.earth = Some(earth);
            return false;
        }
        self.take_bent(at, field)
    }

    /// True where the heading can have changed by so much since the last error.
    fn follows(&self, at: Instant, error: f32) -> bool {
        self.error.is_none_or(|(before, last)| {
            wrapped(error - last).abs() <= JUMP + DRIFT * seconds(span(before, at))
        })
    }

    #[inline(never)] // Hardly ever.
    fn take_bent(&mut self, at: Instant, field: Field) -> bool {
        let (since, told) = *self.bent.get_or_insert((at, false));
        let lasts = span(since, at);
        if lasts >= BENT {
            let off = self.error.map_or(0.0, |(_, error)| error);
            self.reference = Some(Field {
                direction: wrapped(field.direction + off),
                ..field
            });
            self.bent = None;
            return false;
        }
        let tells = lasts >= TOLD && !told;
        self.bent = Some((since, told || tells));
        tells
    }

    /// The turn (rad, body axes) that brings an estimate to see the field where it was.
    ///
    /// It shows two of three angles; of a field that dips steeply mostly those of the tilt.
    pub(super) fn turn_to_field(&self, attitude: Quaternion, field: Vec3) -> Option<Vec3> {
        let earth = self.earth?;
        if (field.norm() - earth.norm()).abs() > STRENGTH * earth.norm() {
            return None;
        }
        let expected = attitude.to_body(earth);
        let axis = field.cross(expected);
        let (sine, cosine) = (axis.norm(), field.dot(expected));
        (sine > 1e-6).then(|| axis * (atan2(sine, cosine) / sine))
    }

    /// The estimate itself may have jumped: the next error is right, however far it is.
    pub(super) fn allow_jump(&mut self) {
        self.error = None;
    }

    /// True where a bent field is not followed.
    pub(super) fn is_free(&self) -> bool {
        self.bent.is_some_and(|(_, told)| told)
    }

    /// Takes the error (rad) against the heading of an external pose.
    pub(super) fn take_pose_error(&mut self, at: Instant, error: f32) {
        *self = Self {
            // Once the pose falls silent, the field holds the heading that it left.
            reference: None,
            error: Some((at, error)),
            pose_at: Some(at),
            bent: None,
            earth: None,
        };
    }

    /// The error (rad), while it is fresh.
    pub(super) fn error(&self, now: Instant) -> Option<f32> {
        self.error
            .filter(|(at, _)| span(*at, now) <= LIFE)
            .map(|(_, error)| error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;

    /// Earth's field, turned by an angle and so many times as strong.
    fn field(angle: f32, times: f32) -> Vec3 {
        let (sin, cos) = angle.sin_cos();
        Vec3::new(0.2 * cos, 0.2 * sin, 0.4) * times
    }

    /// Fields every 20 ms for a second each; whether the last is followed, how often told.
    fn seen(fields: &[Vec3]) -> (Option<f32>, usize) {
        let mut heading = Heading::default();
        let mut told = 0;
        let mut now = 0;
        for earth in fields {
            for _ in 0..50 {
                now += 20_000;
                told += usize::from(heading.take_field(at_micros(now), *earth));
            }
        }
        (heading.error(at_micros(now)), told)
    }

    #[test]
    fn a_field_that_turns_or_grows_at_once_leaves_the_heading_free_and_is_told_once() {
        let still = field(0.0, 1.0);
        for bent in [
            field(1.0, 1.0),
            field(1.0, 5.0),
            field(0.0, 5.0),
            field(0.0, 0.2),
        ] {
            assert_eq!(seen(&[still, bent, bent]), (None, 1), "{bent:?}");
            let (error, _) = seen(&[still, bent, still]);
            assert_eq!(error, Some(0.0));
        }
    }

    #[test]
    fn slow_drift_is_followed() {
        let drifting: Vec<Vec3> = (0..60)
            .map(|second| field(second as f32 * 0.02, 1.0))
            .collect();
        let (error, told) = seen(&drifting);
        assert!((error.expect("fresh") + 1.18).abs() < 1e-3 && told == 0);
    }

    #[test]
    fn what_stays_bent_holds_the_heading_from_then_on() {
        let mut fields = vec![field(0.0, 1.0)];
        fields.extend([field(1.0, 2.0); 25]);
        let (error, told) = seen(&fields);
        assert!(error.expect("followed").abs() < 1e-3 && told == 1);
    }
}
