//! The cascade: attitude loop, rate loop, mixer.
//!
//! ```text
//! motion ----+--> attitude --+
//! heading ---+               +--> wanted rates --+
//! setpoint ------------------+                   +--> torque --+
//! rotation --------------------------------------+             +--> command
//! motion (clock of the integrals) ---------------+             |
//! setpoint's thrust -------------------------------------------+
//! ```
//! `motion` clocks every state. The attitude advances when it ticks, the integrals also where one
//! *stretch* of time ends: a part of the motion in which neither the setpoint nor saturation
//! changed, so that what they come to does not depend on how often control runs.

use crate::airframe::{Mixed, Mixer, MotorShares};
use crate::config::{ARMED_MINIMUM, MOTORS};
use crate::control::{AttitudeLaw, RateInput, RateLaw, RateState, RateStretch, Setpoint, Wanted};
use crate::dataflow::{Dirty, Value};
use crate::estimate::{AttitudeFilter, Increment, Motion, Rotation};
use crate::math::{Quaternion, Vec3};
use crate::units::{BodyRates, TorqueDemand};

/// The values of the graph, for naming what changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Node {
    /// Input: sums of the arrival stage.
    Motion,
    /// Input: filtered rates and angular acceleration.
    Rotation,
    /// Input: what to fly.
    Setpoint,
    /// State: attitude estimate.
    Attitude,
    /// What the attitude loop asks for.
    WantedRates,
    /// What the rate loop asks for.
    Torque,
    /// Output: the motor vector.
    Command,
}

impl Node {
    /// This value's mark in a [`Dirty`] set.
    #[must_use]
    pub const fn mark(self) -> Dirty {
        Dirty::bit(self as u32)
    }
}

/// The graph: laws, states and the values last propagated.
#[derive(Clone, Debug)]
pub struct Cascade {
    attitude_law: AttitudeLaw,
    rate_law: RateLaw,
    mixer: Mixer,

    filter: AttitudeFilter,
    rate_state: RateState,

    motion: Increment,
    /// The motion that the integrals have taken of what the next run will take.
    integrated: Increment,
    /// The motors cannot give what is asked for, by the newest command that was computed.
    saturated: bool,
    heading_error: Option<f32>,
    rotation: Value<Rotation>,
    setpoint: Value<Setpoint>,
    attitude: Value<Quaternion>,
    wanted: Value<Wanted>,
    /// What the newest setpoint asks for, at the attitude of the last run.
    newest: Wanted,
    torque: Value<TorqueDemand>,
    command: Value<Mixed>,
    /// No motion is seen: torque demands would only repeat the last one.
    blind: bool,
    dirty: Dirty,
}

/// What a run would come to, short of torque and mixer.
struct Ahead {
    wanted: BodyRates,
    rate_state: RateState,
}

impl Default for Cascade {
    fn default() -> Self {
        Self {
            attitude_law: AttitudeLaw::default(),
            rate_law: RateLaw::default(),
            mixer: Mixer::default(),
            filter: AttitudeFilter::default(),
            rate_state: RateState::default(),
            motion: Increment::default(),
            integrated: Increment::default(),
            saturated: false,
            heading_error: None,
            rotation: Value::default(),
            setpoint: Value::default(),
            attitude: Value::default(),
            wanted: Value::default(),
            newest: Wanted::default(),
            torque: Value::default(),
            command: Value::new(Mixed {
                shares: [ARMED_MINIMUM; MOTORS],
                saturated: false,
            }),
            blind: false,
            // The first propagation computes everything once.
            dirty: Node::Setpoint.mark(),
        }
    }
}

impl Cascade {
    /// Starts the attitude from a mean specific force at rest, in m/s2.
    pub fn align(&mut self, force: Vec3) {
        self.filter.align(force);
        self.dirty |= Node::Attitude.mark();
    }

    /// Forgets integrals: for the ground, where they only wind up.
    pub fn reset_integrals(&mut self) {
        self.rate_state = RateState::default();
    }

    /// New motion, and the error of the heading in rad where one was measured.
    pub fn set_motion(&mut self, motion: &Motion, heading_error: Option<f32>) {
        if motion.sums.dt > 0.0 {
            self.motion = motion.sums;
            self.heading_error = heading_error;
            self.dirty |= Node::Motion.mark();
        }
        let mark = Node::Rotation.mark();
        self.dirty |= self.rotation.set(motion.rotation, mark);
    }

    /// Whether motion is no longer seen: then thrust is all that is commanded.
    ///
    /// The last torque demand, held for ever, would turn the drone over.
    pub fn set_blind(&mut self, blind: bool) {
        if blind != self.blind {
            self.blind = blind;
            self.dirty |= Node::Rotation.mark();
        }
    }

    /// A new setpoint, given when this motion since the last run was summed.
    pub fn set_setpoint(&mut self, setpoint: Setpoint, so_far: &Increment) {
        self.end_stretch(so_far);
        self.dirty |= self.setpoint.set(setpoint, Node::Setpoint.mark());
        self.newest = self.attitude_law.wanted(self.attitude(), &setpoint);
    }

    /// The setpoint in force.
    #[must_use]
    pub fn setpoint(&self) -> &Setpoint {
        self.setpoint.get()
    }

    /// The attitude estimate last propagated.
    #[must_use]
    pub fn attitude(&self) -> Quaternion {
        *self.attitude.get()
    }

    /// Runs the slice that the changed inputs reach; says which values changed.
    pub fn propagate(&mut self) -> Dirty {
        use Node::{Attitude, Motion, Rotation, Setpoint, Torque, WantedRates};
        let mut dirty = self.dirty.take();
        if dirty.any(Motion.mark()) {
            let motion = self.motion;
            self.end_stretch(&motion);
            self.integrated = Increment::default();
            self.filter.step(&motion, self.heading_error);
        }
        if dirty.any(Motion.mark().or(Attitude.mark())) {
            dirty |= self.attitude.set(self.filter.attitude(), Attitude.mark());
        }
        if dirty.any(Attitude.mark().or(Setpoint.mark())) {
            self.newest = self
                .attitude_law
                .wanted(*self.attitude.get(), self.setpoint.get());
            dirty |= self.wanted.set(self.newest, WantedRates.mark());
        }
        if dirty.any(Motion.mark().or(Rotation.mark()).or(WantedRates.mark())) {
            let wanted = self.wanted.get().rates;
            let torque = self.torque(&self.rate_state, wanted, self.rotation.get());
            dirty |= self.torque.set(torque, Torque.mark());
        }
        if dirty.any(Torque.mark().or(Setpoint.mark())) {
            let mixed = self
                .mixer
                .mix(*self.torque.get(), self.setpoint.get().thrust);
            self.saturated = mixed.saturated;
            dirty |= self.command.set(mixed, Node::Command.mark());
        }
        dirty
    }

    fn torque(&self, state: &RateState, wanted: BodyRates, rotation: &Rotation) -> TorqueDemand {
        if self.blind {
            return TorqueDemand::default();
        }
        let input = RateInput {
            wanted,
            measured: rotation.rates,
            acceleration: rotation.acceleration,
        };
        self.rate_law.demand(state, &input)
    }

    /// The integrals take the motion up to here, which is all of one stretch.
    fn end_stretch(&mut self, so_far: &Increment) {
        let ahead = self.ahead(so_far, self.heading_error);
        self.rate_state = ahead.rate_state;
        self.integrated = *so_far;
    }

    /// What the states and the desired rates would come to after the motion up to here.
    fn ahead(&self, so_far: &Increment, heading_error: Option<f32>) -> Ahead {
        let correction = self.filter.correction(so_far, heading_error);
        let attitude = self.filter.attitude_after(so_far, correction);
        let wanted = self
            .attitude_law
            .wanted(attitude, self.setpoint.get())
            .rates;
        let part = so_far.since(&self.integrated);
        if part.dt <= 0.0 {
            return Ahead {
                wanted,
                rate_state: self.rate_state,
            };
        }
        // Evenly over the time since the last run.
        let corrected = correction * (0.5 * part.dt * (1.0 + self.integrated.dt / so_far.dt));
        let linear = self.newest.integrated(part.swept + corrected, part.dt);
        let beside = wanted.0 - self.newest.after_turn(so_far.angle + correction).0;
        let stretch = RateStretch {
            wanted: linear + beside * (part.dt * (1.0 / 3.0)),
            turned: part.angle,
            saturated: self.saturated,
        };
        Ahead {
            wanted,
            rate_state: self.rate_law.after(&self.rate_state, &stretch),
        }
    }

    /// The command that a run would come to now: the very same estimator, laws and mixer.
    ///
    /// Advances nothing, but that a stretch ends where the motors begin or cease to saturate.
    pub fn foresee(&mut self, motion: &Motion, heading_error: Option<f32>) -> MotorShares {
        self.heading_error = heading_error;
        let Ahead { wanted, rate_state } = self.ahead(&motion.sums, heading_error);
        let torque = self.torque(&rate_state, wanted, &motion.rotation);
        let mixed = self.mixer.mix(torque, self.setpoint.get().thrust);
        if mixed.saturated != self.saturated {
            self.rate_state = rate_state;
            self.integrated = motion.sums;
            self.saturated = mixed.saturated;
        }
        mixed.shares
    }

    /// The command last propagated.
    #[must_use]
    pub fn command(&self) -> &MotorShares {
        &self.command.get().shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensors::GRAVITY;
    use crate::units::Thrust;

    const ALL: [Node; 7] = [
        Node::Motion,
        Node::Rotation,
        Node::Setpoint,
        Node::Attitude,
        Node::WantedRates,
        Node::Torque,
        Node::Command,
    ];

    fn visited(dirty: Dirty) -> String {
        let names: Vec<String> = ALL
            .into_iter()
            .filter(|node| dirty.any(node.mark()))
            .map(|node| format!("{node:?}"))
            .collect();
        names.join(" ")
    }

    fn settled() -> Cascade {
        let mut graph = Cascade::default();
        graph.set_setpoint(
            Setpoint::level(Thrust::new(0.5).expect("in range")),
            &Increment::default(),
        );
        graph.propagate();
        graph
    }

    fn turning(rate: f32, sums: Increment) -> Motion {
        Motion {
            sums,
            rotation: Rotation {
                rates: BodyRates(Vec3::new(rate, 0.0, 0.0)),
                acceleration: Vec3::ZERO,
            },
        }
    }

    #[test]
    fn each_input_reaches_its_own_slice() {
        let mut graph = settled();
        assert_eq!(visited(graph.propagate()), "");

        graph.set_motion(&turning(0.1, Increment::default()), None);
        assert_eq!(visited(graph.propagate()), "Rotation Torque Command");

        graph.set_setpoint(
            Setpoint::level(Thrust::new(0.6).expect("in range")),
            &Increment::default(),
        );
        assert_eq!(visited(graph.propagate()), "Setpoint Command");

        let motion = Increment {
            angle: Vec3::new(0.01, 0.0, 0.0),
            coning: Vec3::ZERO,
            swept: Vec3::ZERO,
            velocity: Vec3::new(0.0, 0.0, -GRAVITY * 0.001),
            down: Vec3::new(0.0, 0.0, 0.001),
            dt: 0.001,
        };
        graph.set_motion(&turning(0.2, motion), None);
        assert_eq!(
            visited(graph.propagate()),
            "Motion Rotation Attitude WantedRates Torque Command"
        );
    }

    #[test]
    fn an_input_set_to_the_same_value_reaches_nothing() {
        let mut graph = settled();
        graph.set_setpoint(*graph.setpoint(), &Increment::default());
        graph.set_motion(&Motion::default(), None);
        assert_eq!(visited(graph.propagate()), "");
    }
}
