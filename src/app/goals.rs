//! Goals and places: what is flown to, and what holds once something stops.
//!
//! The newest demand counts, a setpoint or a goal. Silence ends what it cannot be trusted with:
//!
//! | falls silent | flown | then |
//! |---|---|---|
//! | the peer | a setpoint | level, heading free, at its thrust |
//! | the peer | a goal, armed | the goal's place is held, for as long as places come |
//! | the peer | a goal, on the ground | no thrust: a late take-off would surprise everybody |
//! | places | a goal | level, heading free, at the thrust last commanded |
//!
//! A place is held, because level flight drifts with the wind, and climbs or sinks: of what is
//! known, staying is the safest. Loops that see no place are blind to both, and would go on
//! leaning towards a goal that may be passed long ago.

use super::setpoints::SetpointWatch;
use super::{Autopilot, Fault, Heading, Recorder};
use crate::config::SETPOINT_TIMEOUT;
use crate::control::{Goal, Setpoint};
use crate::estimate::Place;
use crate::graph::ControlLogic;
use crate::link::{Destination, ExternalPose};
use crate::math::wrapped;
use crate::safety::Arming;
use crate::telemetry::Event;
use crate::time::{Duration, Instant, micros, seconds, span};
use crate::units::Velocity;

/// Places further apart are not of one movement: the later one begins anew.
const LONGEST_BETWEEN_PLACES: Duration = micros(500_000);

impl<R: Recorder, L: ControlLogic> Autopilot<R, L> {
    /// A goal joins: the next run flies to it. Past its quantum it forces one.
    ///
    /// Without a fresh place it is refused, since position loops would begin where the drone was
    /// when the last one came. The setpoint in force then keeps its own timeout.
    pub(super) fn on_goal(&mut self, at: Instant, destination: &Destination) {
        if !self.graph.flies_to_goals() || !self.knows_place(at) {
            self.count(Fault::Goal);
            return;
        }
        self.advance(at);
        let before = self.graph.flown_to();
        // The heading at the beginning: one taken anew each time would turn with every error.
        let heading = before.map_or_else(|| self.graph.estimate().heading(), |goal| goal.heading);
        let goal = destination.goal(heading);
        self.fly_to(goal);
        if self.setpoints.take_goal(at, before.as_ref(), &goal) {
            self.schedule.ask_for_setpoint();
        }
    }

    fn fly_to(&mut self, goal: Goal) {
        self.graph.fly_to(Some(goal));
        self.graph.run();
    }

    /// A pose joins: its place clocks the position loops, its attitude shows yaw drift.
    pub(super) fn on_pose(&mut self, at: Instant, pose: &ExternalPose) {
        if self.graph.flies_to_goals() {
            self.see(at, pose);
        }
        if let Some(attitude) = pose.attitude {
            let error = wrapped(attitude.heading() - self.graph.estimate().heading());
            self.heading = Heading {
                // Once the pose falls silent, the field holds the heading that it left.
                field: None,
                error: Some((at, error)),
                pose_at: Some(at),
            };
        }
    }

    /// The graph takes a place, behind the motion; motors keep their command.
    fn see(&mut self, at: Instant, pose: &ExternalPose) {
        let since = self.placed_at.replace(at).map(|before| span(before, at));
        self.advance(at);
        self.graph.see(Place {
            position: pose.position,
            velocity: pose.velocity,
            dt: since
                .filter(|since| *since <= LONGEST_BETWEEN_PLACES)
                .map_or(0.0, seconds),
        });
        self.graph.run();
    }

    fn knows_place(&self, now: Instant) -> bool {
        self.placed_at
            .is_some_and(|at| span(at, now) <= SETPOINT_TIMEOUT)
    }

    /// What is flown must not outlive what it is flown by; see above.
    pub(super) fn check_demand(&mut self, now: Instant) {
        let silent = self.setpoints.fell_silent(now);
        match self.graph.flown_to() {
            Some(_) if !self.knows_place(now) => self.fall_back(now, Event::PlaceLost),
            Some(goal) if silent && self.arming == Arming::Armed => self.hold(now, goal),
            _ if silent => self.fall_back(now, Event::SetpointLost),
            _ => {}
        }
    }

    /// A goal that nobody moves any more stands still.
    fn hold(&mut self, now: Instant, goal: Goal) {
        self.setpoints = SetpointWatch::default();
        self.advance(now);
        self.fly_to(Goal {
            velocity: Velocity::default(),
            ..goal
        });
        self.events.push(Event::GoalHeld);
    }

    /// Level, heading free; after a goal on the ground without thrust.
    fn fall_back(&mut self, now: Instant, why: Event) {
        let setpoint = match self.graph.flown_to() {
            None => Setpoint::level(self.graph.flown().thrust),
            Some(_) if self.arming == Arming::Armed => Setpoint::level(self.graph.collective()),
            Some(_) => Setpoint::default(),
        };
        self.setpoints = SetpointWatch::default();
        self.fly(now, setpoint);
        self.events.push(why);
    }
}
