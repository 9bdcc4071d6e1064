//! One sensor of three axes, judged by itself: frozen, at the rail, or jumping.
//!
//! | condition | is | found after | false alarm |
//! |---|---|---|---|
//! | frozen | an axis repeats itself to the last bit | [`FROZEN`] windows | see below |
//! | at the rail | an axis is at the end of its range | [`AT_RAIL`] windows | a spin that lasts |
//! | jumping | many samples that no motion explains | [`MANY`] of them, soon on another | - |
//! | jumping | samples that turn back again and again | some [`ROUGHNESS`] samples | vibration |
//!
//! A gyroscope at rest with the datasheet's noise (0.9 counts in 98 Hz) repeats half of its
//! samples, and never more than 21 in a row in a million; one with half of that noise repeats
//! three quarters. Five windows of 16 in a row are then once in 10^11 samples: in years of standing still.
//!
//! A sample that no motion explains is dropped, the one before stands for it. Beyond
//! [`Range::step`] a millisecond nothing turns or shakes a drone that still flies: twice what
//! bounces and a crash in recorded flights show, behind the chip's filter. What was dropped may
//! still have been motion, so the longer the sensor insists the more it is believed. Garbage of smaller
//! steps turns back with every sample, as nothing behind a low-pass of 98 Hz does: the mean of
//! second differences is a third of [`Range::rough`] in the worst vibration recorded.

use super::repeats::Repeats;
use crate::math::{Vec3, max, min};

/// Windows in a row that are equal to the last bit: found within 95 samples.
const FROZEN: u8 = 5;
/// The same at the rail, reached in steps that motion makes: more than a turn takes at 2000 deg/s.
const AT_RAIL: u8 = 12;
/// What a dropped sample counts; a believed one takes one back.
const DROPPED: u16 = 10;
/// A sensor jumps from this count on: 50 samples at once, or a tenth of them for long.
const MANY: u16 = 500;
/// It jumps no more below this: a tenth of a second behind the last jump.
const FEW: u16 = 400;
/// One second difference is taken of so many samples.
const LOOK: u8 = 4;
/// Second differences that are averaged: those of 64 samples.
const ROUGHNESS: f32 = 16.0;
/// One second difference counts this many times the limit at most: a spike is no garbage.
const ROUGHEST: f32 = 4.0;
/// Behind a gap that is longer, in s, any step may be motion.
const GAP: f32 = 0.02;

/// What an axis may show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    /// Close to the end of the range.
    pub(super) rail: f32,
    /// The largest step in a millisecond that motion explains.
    pub(super) step: f32,
    /// How much further it may have come, in a second, while samples were dropped.
    pub(super) drift: f32,
    /// The mean second difference of neighbours that no vibration explains.
    pub(super) rough: f32,
}

/// How a sensor does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Condition {
    /// Its samples are believed.
    #[default]
    Alive,
    /// An axis repeats itself to the last bit.
    Frozen,
    /// An axis stays at the end of its range.
    AtRail,
    /// Samples jump as no motion does.
    Jumping,
}

/// What a sample brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Judged {
    /// The sample, or the one that stands for it.
    pub(super) value: Vec3,
    /// The condition where this sample changed it.
    pub(super) changed: Option<Condition>,
    /// It was dropped as the first of some.
    pub(super) spike: bool,
}

/// The newest samples of one sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Signal {
    raw: Vec3,
    /// What it moved by, ahead of a look.
    moved: Vec3,
    believed: Vec3,
    repeats: Repeats,
    /// Time since the believed sample, in s.
    held: f32,
    dropped: u16,
    /// Mean second difference.
    rough: f32,
    condition: Condition,
    /// Nothing was wrong for a while: most samples need no weighing.
    calm: bool,
}

impl Judged {
    /// True where there is something to tell.
    pub(super) fn is_news(&self) -> bool {
        self.changed.is_some() || self.spike
    }
}

impl Signal {
    /// The newest sample that is believed.
    pub(super) fn newest(&self) -> Vec3 {
        self.believed
    }

    /// How the sensor does.
    pub(super) fn condition(&self) -> Condition {
        self.condition
    }

    /// Takes a sample, `dt` (s) behind the one before.
    pub(super) fn take(&mut self, value: Vec3, dt: f32, range: &Range) -> Judged {
        let moved = value - self.raw;
        let repeats = self.repeats.take(moved);
        self.raw = value;
        match self.repeats.left() % LOOK {
            1 => self.moved = moved,
            0 => self.roughen(moved, range),
            _ => {}
        }
        // What is no number is within nothing.
        let small = moved.max_norm() <= range.step && moved.x + moved.y + moved.z < f32::INFINITY;
        if self.calm && small && !repeats {
            self.believed = value;
            return Judged {
                value,
                changed: None,
                spike: false,
            };
        }
        let judged = self.weigh(value, dt, range);
        self.calm = self.held == 0.0
            && self.dropped == 0
            && self.condition == Condition::Alive
            && self.rough <= range.rough;
        judged
    }

    /// Takes the second difference of neighbours.
    fn roughen(&mut self, moved: Vec3, range: &Range) {
        let turned = min((moved - self.moved).max_norm(), ROUGHEST * range.rough);
        self.rough += (turned - self.rough) * (1.0 / ROUGHNESS);
        self.calm &= self.rough <= range.rough;
    }

    /// What becomes of a sample that is not like most.
    #[inline(never)]
    fn weigh(&mut self, value: Vec3, dt: f32, range: &Range) -> Judged {
        let first = self.held == 0.0;
        self.held += dt;
        let explained = range.step * max(dt * 1_000.0, 1.0) + range.drift * self.held;
        let step = value - self.believed;
        let free = dt > GAP || matches!(self.condition, Condition::Frozen | Condition::AtRail);
        // What is no number is no motion; the largest of components would not show it.
        let spike = !(step.x + step.y + step.z).is_finite() || step.max_norm() > explained && !free;
        if spike {
            self.dropped = self.dropped.saturating_add(DROPPED);
        } else {
            self.believed = value;
            self.held = 0.0;
            self.dropped = self.dropped.saturating_sub(1);
        }
        Judged {
            value: self.believed,
            changed: self.judge(range),
            spike: spike && first,
        }
    }

    /// The condition where it changes.
    fn judge(&mut self, range: &Range) -> Option<Condition> {
        let [x, y, z] = self.repeats.windows();
        let jumping = self.condition == Condition::Jumping;
        let most = x.max(y).max(z);
        let (many, rough) = if jumping {
            (FEW, 0.7 * range.rough)
        } else {
            (MANY, range.rough)
        };
        let jumps = self.dropped >= many || self.rough > rough;
        if most < FROZEN && !jumps && self.condition == Condition::Alive {
            return None;
        }
        let condition = if jumps {
            Condition::Jumping
        } else if most < FROZEN {
            Condition::Alive
        } else {
            self.repeating(range)
        };
        let changed = condition != self.condition;
        self.condition = condition;
        changed.then_some(condition)
    }

    /// What it is that repeats itself.
    fn repeating(&self, range: &Range) -> Condition {
        let axes = self.repeats.windows().into_iter().zip(self.raw.to_array());
        axes.filter(|(windows, _)| *windows >= FROZEN)
            .map(|(windows, value)| {
                if value.abs() < range.rail {
                    Condition::Frozen
                } else if windows >= AT_RAIL || self.believed != self.raw {
                    Condition::AtRail
                } else {
                    Condition::Alive
                }
            })
            .find(|condition| *condition != Condition::Alive)
            .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Condition::{Alive, AtRail, Frozen, Jumping};

    const RANGE: Range = Range {
        rail: 34.0,
        step: 4.0,
        drift: 500.0,
        rough: 0.5,
    };

    /// Noise that differs from sample to sample.
    fn noise(sample: u32) -> f32 {
        ((sample.wrapping_mul(2_654_435_761) >> 7) % 9) as f32 * 0.001
    }

    /// After so many samples by their number: the condition, and the value that is believed.
    fn after(samples: u32, mut value: impl FnMut(u32) -> Vec3) -> (Condition, Vec3) {
        let mut signal = Signal::default();
        let mut believed = Vec3::ZERO;
        for sample in 0..samples {
            believed = signal.take(value(sample), 0.001, &RANGE).value;
        }
        (signal.condition(), believed)
    }

    fn alive(sample: u32) -> Vec3 {
        Vec3::new(noise(sample), noise(sample + 7), noise(sample + 13))
    }

    #[test]
    fn one_frozen_axis_is_found_beside_two_that_live() {
        for axis in 0..3 {
            let frozen = |sample: u32| {
                let mut axes = alive(sample).to_array();
                axes[axis] = 0.02;
                Vec3::from_array(axes)
            };
            assert_eq!(after(80, frozen).0, Alive);
            assert_eq!(after(96, frozen).0, Frozen, "axis {axis}");
        }
    }

    #[test]
    fn it_is_alive_again_with_the_first_sample_that_differs() {
        let thaws = |sample| {
            if sample < 200 {
                Vec3::ZERO
            } else {
                Vec3::new(9.0, 9.0, 9.0)
            }
        };
        assert_eq!(after(200, thaws).0, Frozen);
        assert_eq!(after(201, thaws), (Alive, Vec3::new(9.0, 9.0, 9.0)));
    }

    #[test]
    fn a_flip_to_the_rail_is_flown_and_a_jump_there_is_not_believed() {
        let flip = |sample: u32| {
            Vec3::new((sample as f32 * 0.4).min(35.0), 0.0, 0.0)
                + alive(sample).scale(Vec3::new(0.0, 1.0, 1.0))
        };
        assert_eq!(after(240, flip).0, Alive);
        assert_eq!(after(320, flip).0, AtRail);
        let jump = |sample: u32| match sample {
            0..100 => alive(sample),
            _ => Vec3::new(35.0, noise(sample), noise(sample + 13)),
        };
        let (condition, believed) = after(150, jump);
        assert!(
            condition != Alive && believed.max_norm() < 0.01,
            "{condition:?} {believed:?}"
        );
    }

    #[test]
    fn bursts_are_dropped_and_garbage_is_found_within_a_tenth_of_a_second() {
        let bursts = |sample: u32| {
            if sample % 500 < 20 {
                Vec3::new(35.0, -35.0, 35.0)
            } else {
                alive(sample)
            }
        };
        for samples in [1_005, 1_019, 1_100, 9_000] {
            let (condition, believed) = after(samples, bursts);
            assert!(condition == Alive && believed.max_norm() < 0.01);
        }
        let garbage = |sample: u32| match sample {
            0..100 => alive(sample),
            _ => (alive(sample) * 250.0 - Vec3::new(1.0, 1.0, 1.0)) * 35.0,
        };
        assert_eq!(after(200, garbage).0, Jumping);
        let small = |sample: u32| alive(sample) * if sample < 100 { 1.0 } else { 200.0 };
        assert_eq!(after(200, small).0, Jumping);
    }

    #[test]
    fn what_is_no_number_is_dropped() {
        let broken = |sample| {
            if sample == 50 {
                Vec3::new(f32::NAN, 0.0, 0.0)
            } else {
                alive(sample)
            }
        };
        assert!(after(51, broken).1.is_finite());
    }
}
