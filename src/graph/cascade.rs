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
//! `motion` clocks every state: attitude and integrals advance exactly when it ticks.

use crate::airframe::{Mixed, Mixer, MotorShares};
use crate::config::{ARMED_MINIMUM, MOTORS};
use crate::control::{AttitudeLaw, RateInput, RateLaw, RateState, Setpoint, Wanted};
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
    heading_error: Option<f32>,
    rotation: Value<Rotation>,
    setpoint: Value<Setpoint>,
    attitude: Value<Quaternion>,
    wanted: Value<Wanted>,
    /// What the newest setpoint will ask for, at the attitude of the last run.
    foreseen: Wanted,
    torque: Value<TorqueDemand>,
    command: Value<Mixed>,
    /// No motion is seen: torque demands would only repeat the last one.
    blind: bool,
    dirty: Dirty,
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
            heading_error: None,
            rotation: Value::default(),
            setpoint: Value::default(),
            attitude: Value::default(),
            wanted: Value::default(),
            foreseen: Wanted::default(),
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

    /// A new setpoint.
    pub fn set_setpoint(&mut self, setpoint: Setpoint) {
        self.dirty |= self.setpoint.set(setpoint, Node::Setpoint.mark());
        self.foreseen = self.attitude_law.wanted(self.attitude(), &setpoint);
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
        let motion = if dirty.any(Motion.mark()) {
            self.filter.step(&self.motion, self.heading_error);
            self.motion
        } else {
            Increment::default()
        };
        if dirty.any(Motion.mark().or(Attitude.mark())) {
            dirty |= self.attitude.set(self.filter.attitude(), Attitude.mark());
        }
        if dirty.any(Attitude.mark().or(Setpoint.mark())) {
            self.foreseen = self
                .attitude_law
                .wanted(*self.attitude.get(), self.setpoint.get());
            dirty |= self.wanted.set(self.foreseen, WantedRates.mark());
        }
        if dirty.any(Motion.mark().or(Rotation.mark()).or(WantedRates.mark())) {
            let input = self.rate_input(self.wanted.get().rates, self.rotation.get(), &motion);
            let torque = if self.blind {
                TorqueDemand::default()
            } else {
                self.rate_law.step(&mut self.rate_state, &input)
            };
            dirty |= self.torque.set(torque, Torque.mark());
        }
        if dirty.any(Torque.mark().or(Setpoint.mark())) {
            let mixed = self
                .mixer
                .mix(*self.torque.get(), self.setpoint.get().thrust);
            dirty |= self.command.set(mixed, Node::Command.mark());
        }
        dirty
    }

    fn rate_input(&self, wanted: BodyRates, rotation: &Rotation, sums: &Increment) -> RateInput {
        RateInput {
            wanted,
            measured: rotation.rates,
            acceleration: rotation.acceleration,
            turned: sums.angle,
            dt: sums.dt,
            saturated: self.command.get().saturated,
        }
    }

    /// The command that a run would come to now, to first order; no state advances.
    ///
    /// Attitude and desired rates are those of the last run, moved by the angle turned since;
    /// what gravity and heading correct in so short a time is left out. Rate loop and mixer,
    /// with what saturates in them, are the very same.
    #[must_use]
    pub fn foresee(&self, motion: &Motion) -> MotorShares {
        let wanted = self.foreseen.after_turn(motion.sums.angle);
        let input = self.rate_input(wanted, &motion.rotation, &motion.sums);
        let torque = if self.blind {
            TorqueDemand::default()
        } else {
            self.rate_law.foresee(&self.rate_state, &input)
        };
        let thrust = self.setpoint.get().thrust;
        self.mixer.mix(torque, thrust).shares
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
        graph.set_setpoint(Setpoint::level(Thrust::new(0.5).expect("in range")));
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

        graph.set_setpoint(Setpoint::level(Thrust::new(0.6).expect("in range")));
        assert_eq!(visited(graph.propagate()), "Setpoint Command");

        let motion = Increment {
            angle: Vec3::new(0.01, 0.0, 0.0),
            velocity: Vec3::new(0.0, 0.0, -GRAVITY * 0.001),
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
        graph.set_setpoint(*graph.setpoint());
        graph.set_motion(&Motion::default(), None);
        assert_eq!(visited(graph.propagate()), "");
    }
}
