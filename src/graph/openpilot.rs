//! OpenPilot: complementary filter, attitude PI, rate PID, path follower.
//!
//! ```text
//! motion ----+--> filter --> attitude ----------+
//! heading ---+      |                           |
//! goal ------+--> path --> target --------------+--> wanted --+
//! place -----+               ^                  |             |
//! setpoint ------------------+                  |             |
//! motion (clock) --> integrals -----------------+-------------+--> torque --+
//! rotation ---------------------------------------------------+             +--> command
//! target's thrust ----------------------------------------------------------+
//! ```
//! After OpenPilot 15.02 and its successor LibrePilot 16.09, firmware of CopterControl and
//! Revolution, in structure and default gains: Attitude (`attitude.c`, `filtercf.c`),
//! Stabilization (`outerloop.c`, `innerloop.c`, settings bank 1), AltitudeHold and
//! VtolPathFollower; written anew, for runs at any spacing. Gains are in
//! `config/logics/openpilot.toml`; `control/openpilot.rs` and `estimate/openpilot.rs` say how
//! they were converted. The attitude follows the inertial sensor's accelerometer, as `motion`
//! sums it. Left out: modes for sticks only (axis lock, weak levelling, virtual bar, rattitude), cruise
//! control, landing, and scaling of gains by thrust.

use super::{ControlLogic, place_inputs, standard_inputs, tuned};
use crate::airframe::{LevelFirst, Mixed, Mixer};
use crate::config::{CHIP_MAG, GYRO};
use crate::control::openpilot::{
    AttitudeError, ErrorStretch, Integrals, PathFollower, PathState, Stabilization,
    StabilizedStretch,
};
use crate::control::{Goal, RateInput, Setpoint};
use crate::dataflow::graph;
use crate::estimate::{Increment, OpenPilotFilter, Place, Rotation};
use crate::math::Quaternion;
use crate::settings::gains::openpilot::Gains;
use crate::units::{BodyRates, TorqueDemand};

graph! {
    /// Attitude PI, rate PID, path follower, on a filter that learns the bias.
    pub struct OpenPilot;

    /// Gains, as `config/logics/openpilot.toml` has them unless others are set.
    param gains: Gains;
    /// What the motors do for a torque.
    param mixer: Mixer;
    param path_follower: PathFollower = PathFollower::new(&gains);
    param stabilization: Stabilization = Stabilization::new(&gains);

    /// Sums of the arrival stage since the last run.
    input motion: Increment, every GYRO.period, gates if GYRO.gates, triggers;
    /// Filtered rates and angular acceleration.
    input rotation: Rotation, every GYRO.period, gates if GYRO.gates, triggers;
    /// By how much (rad) the heading falls short of a measured one, where there is one.
    input heading: Option<f32>, every CHIP_MAG.period, triggers;
    /// What to fly without a goal.
    input setpoint: Setpoint, at 50 Hz, joins;
    /// Where to fly.
    input goal: Option<Goal>, at 50 Hz, joins;
    /// Where the drone is.
    input place: Place, at 50 Hz, joins;
    /// No motion is seen: then thrust is all that is commanded.
    input blind: bool, at 10 Hz, joins;

    /// The estimate of attitude and gyroscope bias.
    state filter: OpenPilotFilter = filter.stepped(&motion, heading, &gains.estimate), clocked by motion;
    /// Attitude, body to Earth.
    node attitude: Quaternion = filter.attitude();
    /// Integral terms of position and altitude loops.
    state path: PathState = path_follower.after(
        &path, &place, goal.as_ref(), last target.thrust
    ), clocked by place;
    /// The setpoint in force: the goal's, where there is one, else the outside's.
    node target: Setpoint = goal
        .and_then(|flown_to| path_follower.setpoint(&path, &place, &flown_to))
        .unwrap_or(setpoint);
    /// Integral terms of attitude and rate loops.
    state integrals: Integrals = stabilization.after(&integrals, &last target, &stretch(
        &motion, &last filter, &filter, &last target, &rotation
    )), clocked by motion;
    /// What the attitude loop asks for.
    node wanted: BodyRates = stabilization.wanted(
        &AttitudeError::of(attitude, &target), &integrals, &target
    );
    /// What the rate loop asks for; nothing while blind, as the last demand would turn the drone over.
    node torque: TorqueDemand = if blind {
        TorqueDemand::default()
    } else {
        stabilization.demand(&integrals, &RateInput {
            measured: filter.unbiased(rotation.rates),
            ..RateInput::of(wanted, &rotation)
        })
    };
    /// The motor vector.
    output command: Mixed = mixer.mix(torque, target.thrust, &LevelFirst);
}

/// A motion as the integrals see it, which was flown with the setpoint before.
fn stretch(
    motion: &Increment,
    before: &OpenPilotFilter,
    after: &OpenPilotFilter,
    target: &Setpoint,
    rotation: &Rotation,
) -> StabilizedStretch {
    let [start, end] = [before, after].map(|filter| AttitudeError::of(filter.attitude(), target));
    let turned = after.turned(before, motion);
    StabilizedStretch {
        error: ErrorStretch::of_turn(
            [start.angle, end.angle],
            [turned.estimate, turned.swept],
            start.axes,
            motion.dt,
        ),
        axes: start.axes,
        turned: turned.body,
        measured: after.unbiased(rotation.rates),
    }
}

tuned!(OpenPilot, openpilot);

impl ControlLogic for OpenPilot {
    standard_inputs!("openpilot");
    place_inputs!(logic => logic.target().thrust);

    fn reset_integrals(&mut self) {
        self.set_integrals(Integrals::default());
        self.set_path(PathState::default());
    }

    fn stand(&mut self) {
        self.set_integrals(Integrals::default());
        self.set_path(self.path().standing());
    }
}

#[cfg(test)]
mod tests;
