//! The rate loop: PID about each axis, the yaw error low-pass filtered.
//!
//! The original filters at a fixed rate what here is only sampled when control runs:
//! - targets, at 20 Hz: left out. Unshaped targets are linear in the attitude, itself an integral;
//!   of them the filter would take 8 ms times stiffness, 4 % of the measured rate, and of a new
//!   setpoint it would keep most until some sensor asks for the next run;
//! - errors, at 2.5 Hz in yaw: a state, exact for rates that moved linearly over the stretch;
//! - derivatives, at 20 Hz: on every sample, by the arrival stage. A derivative of the error
//!   holds that of the target too, which is known without a quotient: minus stiffness times rate.

use super::Asked;
use crate::airframe::Mixed;
use crate::control::one_pole::{along, time_constant};
use crate::control::{RateInput, RateLaw, RateState, RateStretch, Wanted};
use crate::estimate::{Increment, Rotation};
use crate::math::Vec3;
use crate::settings::gains::arducopter::Rate;
use crate::units::{BodyRates, TorqueDemand};

/// The original's outputs end at one, which moves a motor by half of its range.
const MOST: Vec3 = Vec3::new(0.5, 0.5, 0.5);

/// The rate loop of some gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateLoop {
    law: RateLaw,
    /// Time constant of the filter of the yaw rate's error, in s.
    yaw_error_time: f32,
}

/// What the rate loop remembers between runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateMemory {
    integrals: RateState,
    /// Filtered error of the yaw rate, in rad/s.
    yaw_error: f32,
}

impl RateLoop {
    /// The loop of some gains.
    #[must_use]
    pub const fn new(gains: &Rate) -> Self {
        Self {
            law: RateLaw::new([gains.p, gains.i, gains.d], gains.integral_limit),
            yaw_error_time: time_constant(gains.yaw_error_cutoff_hz),
        }
    }

    /// The memory after the motion since the last run.
    ///
    /// In that time the desired rates went from what the run before asked for (`last`) to what this
    /// one does: with the angle turned and the estimate's `correction` (rad, as evenly) by the
    /// stiffness, and what is left evenly too, as by a turn to another heading in a lean. A new setpoint
    /// counts from the run that brings it on, which covers no time.
    #[must_use]
    pub fn after(
        &self,
        memory: &RateMemory,
        motion: &Increment,
        correction: Vec3,
        last: &Asked,
        asked: &Asked,
        command: &Mixed,
    ) -> RateMemory {
        let dt = motion.dt;
        if dt <= 0.0 {
            return *memory;
        }
        let beside = asked.wanted.rates.0 - last.wanted.after_turn(motion.angle + correction).0;
        let linear = last
            .wanted
            .integrated(motion.swept + correction * (0.5 * dt), dt);
        let mut wanted = linear + beside * (dt * 0.5);

        let [from, to] = ends(motion.angle.z, motion.swept.z, dt);
        let errors = [
            (last.wanted.rates.0.z - from) * last.heading,
            (asked.wanted.rates.0.z - to) * asked.heading,
        ];
        let yaw_error = along(memory.yaw_error, errors, dt, self.yaw_error_time);
        // The integral takes the filtered error, which lags by what the filter still holds.
        let late = self.yaw_error_time * (yaw_error - memory.yaw_error);
        let heading = 0.5 * (last.heading + asked.heading);
        let error = (wanted.z - motion.angle.z) * heading - late;
        wanted.z = motion.angle.z + error;

        let stretch = RateStretch {
            wanted,
            turned: motion.angle,
            saturated: command.saturated,
        };
        RateMemory {
            integrals: self.law.after(&memory.integrals, &stretch),
            yaw_error,
        }
    }

    /// Torque demands, each at most half of full authority; none while blind.
    #[must_use]
    pub fn demand(
        &self,
        memory: &RateMemory,
        asked: &Asked,
        rotation: &Rotation,
        blind: bool,
    ) -> TorqueDemand {
        if blind {
            return TorqueDemand::default();
        }
        let measured = rotation.rates.0;
        let Wanted { rates, stiffness } = asked.wanted;
        let input = RateInput {
            wanted: BodyRates(Vec3 {
                z: measured.z + memory.yaw_error,
                ..rates.0
            }),
            measured: rotation.rates,
            acceleration: rotation.acceleration + measured.scale(stiffness),
        };
        TorqueDemand(self.law.demand(&memory.integrals, &input).0.limited(MOST))
    }
}

/// Rate (rad/s) at both ends of a stretch in which it moved linearly.
///
/// From the angle turned (rad), and that angle integrated (rad s) over `dt` (s).
fn ends(angle: f32, swept: f32, dt: f32) -> [f32; 2] {
    let mean = angle / dt;
    let half = 6.0 * (0.5 * mean - swept / (dt * dt));
    [mean - half, mean + half]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::{LevelFirst, Mixer};
    use crate::config::arducopter::GAINS;
    use crate::units::Thrust;
    use proptest::prelude::*;

    const LOOP: RateLoop = RateLoop::new(&GAINS.rate);

    fn with_room() -> Mixed {
        Mixer::default().mix(TorqueDemand::default(), Thrust::ZERO, &LevelFirst)
    }

    fn asking(x: f32, z: f32) -> Asked {
        Asked {
            wanted: Wanted {
                rates: BodyRates(Vec3::new(x, 0.0, z)),
                stiffness: Vec3::ZERO,
            },
            heading: 1.0,
        }
    }

    /// Sums of a stretch in which the rates went evenly from one value to another.
    fn turning(from: Vec3, to: Vec3, dt: f32) -> Increment {
        Increment {
            angle: (from + to) * (0.5 * dt),
            swept: (from * 2.0 + to) * (dt * dt / 6.0),
            dt,
            ..Increment::default()
        }
    }

    fn step(memory: &RateMemory, motion: &Increment, asked: &Asked) -> RateMemory {
        LOOP.after(memory, motion, Vec3::ZERO, asked, asked, &with_room())
    }

    #[test]
    fn without_time_nothing_advances() {
        let asked = asking(1.0, 1.0);
        let memory = step(
            &RateMemory::default(),
            &turning(Vec3::ZERO, Vec3::ZERO, 0.05),
            &asked,
        );
        assert_ne!(memory, RateMemory::default());
        assert_eq!(step(&memory, &Increment::default(), &asked), memory);
    }

    #[test]
    fn a_rate_error_is_answered_at_once_but_in_yaw_with_a_delay() {
        let asked = asking(1.0, 1.0);
        let rest = Rotation::default();
        let torque = LOOP.demand(&RateMemory::default(), &asked, &rest, false).0;
        assert!((torque.x - GAINS.rate.p[0]).abs() < 1e-6);
        assert_eq!(torque.z, 0.0);
        let memory = step(
            &RateMemory::default(),
            &turning(Vec3::ZERO, Vec3::ZERO, LOOP.yaw_error_time),
            &asked,
        );
        let torque = LOOP.demand(&memory, &asked, &rest, false).0;
        assert!(
            (torque.z - 0.632 * GAINS.rate.p[2]).abs() < 0.001,
            "{torque:?}"
        );
    }

    #[test]
    fn blind_asks_for_no_torque() {
        let asked = asking(1.0, 1.0);
        let torque = LOOP.demand(&RateMemory::default(), &asked, &Rotation::default(), true);
        assert_eq!(torque, TorqueDemand::default());
    }

    #[test]
    fn a_saturated_integral_does_not_grow() {
        let motion = turning(Vec3::ZERO, Vec3::ZERO, 0.1);
        let asked = asking(1.0, 0.0);
        let saturated = Mixed {
            saturated: true,
            ..with_room()
        };
        let begun = step(&RateMemory::default(), &motion, &asked);
        let held = LOOP.after(&begun, &motion, Vec3::ZERO, &asked, &asked, &saturated);
        assert_eq!(held.integrals, begun.integrals);
        assert_ne!(step(&begun, &motion, &asked).integrals, begun.integrals);
    }

    proptest! {
        #[test]
        fn one_long_step_is_many_short_ones(
            x in -3.0f32..3.0, z in -2.0f32..2.0, wanted in -2.0f32..2.0, more in -20.0f32..20.0
        ) {
            let start = Vec3::new(x, 0.0, z);
            let slope = Vec3::new(more, 0.0, 0.5 * more);
            let asked = asking(wanted, wanted);
            let (mut often, short) = (RateMemory::default(), 0.001);
            for part in 0..50u8 {
                let from = start + slope * (f32::from(part) * short);
                often = step(&often, &turning(from, from + slope * short, short), &asked);
            }
            let long = turning(start, start + slope * 0.05, 0.05);
            let rarely = step(&RateMemory::default(), &long, &asked);
            let rotation = Rotation::default();
            let torque = |memory| LOOP.demand(&memory, &asked, &rotation, false).0;
            prop_assert!((torque(often) - torque(rarely)).max_norm() < 1e-4);
        }

        #[test]
        fn torque_is_finite_and_within_half_of_authority(
            steps in prop::collection::vec(
                (-40.0f32..40.0, -40.0f32..40.0, -5000.0f32..5000.0, 0.0f32..0.2), 1..50)
        ) {
            let mut memory = RateMemory::default();
            for (wanted, rate, acceleration, dt) in steps {
                let rates = Vec3::new(rate, -rate, rate);
                let asked = asking(wanted, wanted);
                memory = step(&memory, &turning(rates, rates, dt), &asked);
                let rotation = Rotation {
                    rates: BodyRates(rates),
                    acceleration: rates * acceleration,
                };
                let torque = LOOP.demand(&memory, &asked, &rotation, false);
                prop_assert!(torque.is_finite() && torque.0.max_norm() <= 0.5);
            }
        }
    }
}
