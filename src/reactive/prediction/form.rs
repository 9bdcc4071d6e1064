//! A prediction as coefficients: of motions, and of their sums over time.

use core::f32::consts::TAU;

use super::sounding::{Column, Feature};
use crate::estimate::{Motion, Rotation};
use crate::math::Vec3;
use crate::reactive::owed::{Impulse, OfAxes};

/// What a command moves with: rates, angular accelerations and angles about three axes, and time.
type OfFeatures<T> = [T; Feature::COUNT];

/// How a command moves with what the body does, and with time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    /// Per rad/s, per rad/s2, per rad, per second.
    of_features: OfFeatures<OfAxes>,
    /// Time constant (s) of the filter behind the angular acceleration.
    lag: f32,
}

/// The impulse owed as an affine form of what the arrival stage knows.
///
/// Coefficients lie as a sample needs them: a feature is loaded once, the axes stay in registers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form {
    slopes: Slopes,
    time: OfAxes,
    constant: OfAxes,
}

impl Slopes {
    /// Flat slopes, for an angular acceleration that is filtered at a corner (Hz).
    pub(super) fn new(derivative_cutoff: f32) -> Self {
        Self {
            of_features: Default::default(),
            lag: 1.0 / (TAU * derivative_cutoff),
        }
    }

    /// The slopes of one feature.
    pub(super) fn of(&mut self, feature: Feature) -> Option<&mut OfAxes> {
        self.of_features.get_mut(feature as usize)
    }

    /// Takes the slopes of one feature.
    pub(super) fn set(&mut self, column: &Column) {
        if let Some(slopes) = self.of(column.feature) {
            *slopes = column.of_axes;
        }
    }

    /// Adds to what time alone moves, per second.
    pub(super) fn correct_drift(&mut self, by: &OfAxes) {
        if let Some(drift) = self.of(Feature::Time) {
            add_product(drift, by, 1.0);
        }
    }

    /// By how much a motion moves the command since a rotation.
    pub(super) fn change(&self, since: &Rotation, motion: &Motion) -> OfAxes {
        let features = features(
            motion.rotation.rates.0 - since.rates.0,
            motion.rotation.acceleration - since.acceleration,
            motion.sums.angle,
            motion.sums.dt,
        );
        self.on(&OfAxes::default(), &features)
    }

    /// A start and, for each feature, its slopes times how large it is.
    #[inline(never)] // It takes every register of floats.
    fn on(&self, start: &OfAxes, features: &OfFeatures<f32>) -> OfAxes {
        let mut sums = *start;
        for (slopes, feature) in self.of_features.iter().zip(features) {
            add_product(&mut sums, slopes, *feature);
        }
        sums
    }
}

impl Form {
    /// The impulse owed since a rotation, at which the command was `off` and so much `owed`.
    ///
    /// Summed over time, rates are the angle turned, and the angle is what was swept. Acceleration
    /// is the change of the rates, less what its filter still holds back: its own change times the
    /// filter's time constant.
    pub(super) fn of(slopes: &Slopes, since: &Rotation, off: &OfAxes, owed: &Impulse) -> Self {
        let (rates, acceleration) = (since.rates.0, since.acceleration);
        let at_first = features(-rates, -acceleration, Vec3::ZERO, 0.0);
        let held_back = acceleration * slopes.lag - rates;
        let summed = features(Vec3::ZERO, held_back, Vec3::ZERO, 0.0);
        Self {
            slopes: *slopes,
            time: slopes.on(off, &at_first),
            constant: slopes.on(&owed.0, &summed),
        }
    }

    /// The impulse owed after a motion.
    pub(super) fn impulse(&self, motion: &Motion) -> Impulse {
        let Motion { sums, rotation } = motion;
        let summed = features(
            sums.angle,
            rotation.rates.0 - rotation.acceleration * self.slopes.lag,
            sums.swept,
            0.5 * sums.dt * sums.dt,
        );
        let mut start = self.constant;
        add_product(&mut start, &self.time, sums.dt);
        Impulse(self.slopes.on(&start, &summed))
    }

    /// By how much the command is off from the held one after a motion: what the impulse grows by.
    pub(super) fn off(&self, motion: &Motion) -> OfAxes {
        let Motion { sums, rotation } = motion;
        let features = features(rotation.rates.0, rotation.acceleration, sums.angle, sums.dt);
        self.slopes.on(&self.time, &features)
    }

    /// The command jumps by so much, this long (s) after the rotation.
    pub(super) fn jump(&mut self, by: &OfAxes, at: f32) {
        add_product(&mut self.time, by, 1.0);
        add_product(&mut self.constant, by, -at);
    }
}

fn features(rates: Vec3, acceleration: Vec3, angle: Vec3, time: f32) -> OfFeatures<f32> {
    let ([a, b, c], [d, e, f], [g, h, i]) =
        (rates.to_array(), acceleration.to_array(), angle.to_array());
    [a, b, c, d, e, f, g, h, i, time]
}

#[inline]
fn add_product(sums: &mut OfAxes, slopes: &OfAxes, by: f32) {
    for (sum, slope) in sums.iter_mut().zip(slopes) {
        *sum += slope * by;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::Axes;
    use crate::estimate::Arrival;
    use crate::sensors::ImuSample;
    use crate::time::at_micros;
    use crate::units::{BodyRates, SpecificForce};
    use proptest::prelude::*;

    const CUTOFF: f32 = 20.0;

    fn slopes(values: &[f32]) -> Slopes {
        let mut slopes = Slopes::new(CUTOFF);
        for (&feature, values) in Feature::ALL.iter().zip(values.chunks_exact(Axes::COUNT)) {
            slopes.set(&Column {
                feature,
                of_axes: values.try_into().expect("a value for each axis"),
            });
        }
        slopes
    }

    fn arrive(arrival: &mut Arrival, at: u64, rates: [f32; 3]) {
        let sample = ImuSample {
            at: at_micros(at),
            rates: BodyRates(Vec3::from_array(rates)),
            force: SpecificForce(Vec3::new(0.0, 0.0, -9.8)),
        };
        assert!(arrival.take(&sample, CUTOFF));
    }

    proptest! {
        #[test]
        fn the_form_is_the_predicted_command_summed_over_time(
            values in prop::collection::vec(-1.0f32..1.0, Axes::COUNT * Feature::COUNT),
            off in prop::array::uniform4(-0.1f32..0.1),
            owed in prop::array::uniform4(-1e-3f32..1e-3),
            before in prop::array::uniform3(-5.0f32..5.0),
            rates in prop::collection::vec(prop::array::uniform3(-5.0f32..5.0), 1..80),
        ) {
            let slopes = slopes(&values);
            let mut arrival = Arrival::default();
            arrive(&mut arrival, 0, [0.0; 3]);
            arrive(&mut arrival, 1000, before);
            let since = arrival.take_motion().rotation;
            let form = Form::of(&slopes, &since, &off, &Impulse(owed));
            let (mut summed, mut last) = (owed.map(f64::from), 0.0);
            // Swept is a sum of trapezoids, the others of rectangles.
            let mut slack = 1e-6;
            for (step, rates) in rates.into_iter().enumerate() {
                arrive(&mut arrival, 1000 + 900 * (step as u64 + 1), rates);
                let motion = arrival.motion();
                let dt = motion.sums.dt - last;
                last = motion.sums.dt;
                let change = slopes.change(&since, &motion);
                for (off, (first, change)) in form.off(&motion).into_iter().zip(off.iter().zip(change)) {
                    prop_assert!((off - (first + change)).abs() < 2e-3);
                }
                for (sum, (off, change)) in summed.iter_mut().zip(off.iter().zip(change)) {
                    *sum += f64::from((off + change) * dt);
                }
                slack += 3.0 * 0.5 * 5.0 * dt * dt + dt * dt;
                for (sum, owed) in summed.iter().zip(form.impulse(&motion).0) {
                    let miss = (sum - f64::from(owed)).abs();
                    prop_assert!(miss < f64::from(slack), "{miss} {slack} at {last}");
                }
            }
        }

        #[test]
        fn a_jump_counts_from_its_instant_on(by in prop::array::uniform4(-0.5f32..0.5), late in 1u64..40) {
            let mut form = Form::of(&Slopes::new(CUTOFF), &Rotation::default(), &[0.0; 4], &Impulse::default());
            let mut motion = Motion::default();
            motion.sums.dt = late as f32 * 1e-3;
            form.jump(&by, 0.5e-3 * late as f32);
            for (owed, by) in form.impulse(&motion).0.into_iter().zip(by) {
                prop_assert!((owed - by * 0.5e-3 * late as f32).abs() < 1e-7);
            }
        }
    }
}
