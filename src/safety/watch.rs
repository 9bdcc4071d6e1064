//! What ends a flight though no message says so: landings, upsets, and time.
//!
//! Looked at in every run, so at least once in a failsafe period, whatever else happens.

use super::ground::Ground;
use super::hold::Hold;
use super::seen::{Lasting, Seen};
use super::{FlightEvent, FlightState};
use crate::config::{
    BLIND_TIME, DESCENT_SPEED, DESCENT_THRUST, DESCENT_TIME, LONGEST_ON_GROUND, UPSET_TILT,
    UPSET_TIME, WAITING_TIME,
};
use crate::math::{RunningMean, between, sin_cos};
use crate::time::{Duration, Instant, seconds, span};
use crate::units::Thrust;

/// Time constant (s) of the mean thrust that is flown: through manoeuvres it is that of hovering.
const MEAN_THRUST_OVER: f32 = 5.0;

/// Looks for the end of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch {
    /// Since when the state holds.
    since: Instant,
    newest: Instant,
    ground: Ground,
    hold: Hold,
    upset: Lasting,
    /// Of the thrust flown, as a share.
    mean_thrust: RunningMean,
    /// Cosine of the tilt of an upset.
    upset_cosine: f32,
    /// How long the motor that is tested turns.
    test_length: Duration,
}

impl Default for Watch {
    fn default() -> Self {
        let start = Instant::from_ticks(0);
        Self {
            since: start,
            newest: start,
            ground: Ground::default(),
            hold: Hold::default(),
            upset: Lasting::default(),
            mean_thrust: RunningMean::default(),
            upset_cosine: sin_cos(UPSET_TILT.to_radians()).1,
            test_length: Duration::from_ticks(0),
        }
    }
}

impl Watch {
    /// A state begins.
    pub fn begin(&mut self, state: FlightState, now: Instant) {
        self.since = now;
        // A landing or an upset under way goes on counting in the next state of the air.
        if !state.is_in_the_air() {
            self.ground = Ground::default();
            self.upset = Lasting::default();
            self.mean_thrust.begin_anew();
        }
        if state == FlightState::Waiting {
            self.hold = Hold::default();
        }
    }

    /// A motor is tested for so long from now on.
    pub fn begin_test(&mut self, now: Instant, length: Duration) {
        self.since = now;
        self.test_length = length;
    }

    /// What a run sees; an event where it ends the state.
    pub fn take(&mut self, state: FlightState, seen: &Seen) -> Option<FlightEvent> {
        let dt = seconds(span(self.newest, seen.at));
        self.newest = seen.at;
        if !state.is_armed() {
            return self.is_over(state, seen).then_some(FlightEvent::TimeUp);
        }
        let stands = Ground::stands(seen, self.mean_thrust.value());
        // What stands on the ground says nothing of hovering.
        if state == FlightState::Flying && !stands {
            let thrust = seen.thrust.share();
            self.mean_thrust.take(thrust, dt, MEAN_THRUST_OVER);
        }
        let shown = self.ground.take(seen, dt, stands);
        if shown.is_some_and(|event| state.after(event) != Ok(state)) {
            return shown;
        }
        if state != FlightState::Blind && self.is_upset(seen) {
            return Some(FlightEvent::Upset);
        }
        self.is_over(state, seen).then_some(FlightEvent::TimeUp)
    }

    fn is_upset(&mut self, seen: &Seen) -> bool {
        let lies = seen.rests() && seen.down.z < self.upset_cosine;
        let astray =
            (seen.asked_down).is_some_and(|asked| asked.dot(seen.down) < self.upset_cosine);
        self.upset.lasts(lies || astray, seen.at, UPSET_TIME)
    }

    fn is_over(&self, state: FlightState, seen: &Seen) -> bool {
        let longest = match state {
            FlightState::Testing => self.test_length,
            FlightState::Armed => LONGEST_ON_GROUND,
            FlightState::Waiting => WAITING_TIME,
            FlightState::Descending if !seen.sees_place => DESCENT_TIME,
            FlightState::Blind => BLIND_TIME,
            _ => return false,
        };
        span(self.since, seen.at) >= longest
    }

    /// True where the drone has left the ground for certain.
    pub fn flies(&self) -> bool {
        self.ground.flies()
    }

    /// The thrust of a drone without pilot and place, which sinks so fast (m/s), if that is known.
    pub fn thrust_alone(
        &mut self,
        state: FlightState,
        now: Instant,
        sinking: Option<f32>,
    ) -> Thrust {
        let (speed, unseen) = match state {
            FlightState::Descending => (DESCENT_SPEED, DESCENT_THRUST),
            _ => (0.0, 1.0),
        };
        let share = sinking.map_or(unseen, |sinking| self.hold.thrust(now, speed, sinking));
        Thrust::new(between(self.mean_thrust.value() * share, 0.0, 1.0)).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{IDLE_THRUST, LANDED_TIME};
    use crate::math::Vec3;
    use crate::sensors::GRAVITY;
    use crate::time::{at_micros, micros};

    const STEP: Duration = micros(100_000);

    fn hovering() -> Seen {
        Seen {
            at: at_micros(0),
            thrust: Thrust::new(0.4).expect("in range"),
            rates: Vec3::ZERO,
            force: Vec3::new(0.0, 0.0, -GRAVITY),
            down: Vec3::new(0.0, 0.0, 1.0),
            asked_down: Some(Vec3::new(0.0, 0.0, 1.0)),
            sees_place: false,
        }
    }

    /// What is told, and after how many s, of a drone that goes on as seen.
    fn told(state: FlightState, seen: Seen) -> Option<(FlightEvent, f32)> {
        let mut watch = Watch::default();
        watch.begin(FlightState::Flying, at_micros(0));
        watch.take(FlightState::Flying, &hovering());
        watch.take(
            FlightState::Flying,
            &Seen {
                at: at_micros(0) + STEP,
                ..hovering()
            },
        );
        let begun = at_micros(0) + STEP;
        watch.begin(state, begun);
        (0..1_000).find_map(|step| {
            let at = begun + STEP * step;
            let event = watch.take(state, &Seen { at, ..seen })?;
            Some((event, seconds(span(begun, at))))
        })
    }

    fn with_thrust(share: f32) -> Seen {
        Seen {
            thrust: Thrust::new(share).expect("in range"),
            ..hovering()
        }
    }

    #[test]
    fn a_flight_that_is_flown_goes_on() {
        assert_eq!(told(FlightState::Flying, hovering()), None);
        let rolled = Vec3::new(0.0, 1.0, 0.0);
        let knife_edge = Seen {
            down: rolled,
            asked_down: Some(rolled),
            rates: Vec3::new(2.0, 0.0, 0.0),
            ..hovering()
        };
        assert_eq!(told(FlightState::Flying, knife_edge), None);
        let by_rates = Seen {
            asked_down: None,
            ..knife_edge
        };
        assert_eq!(told(FlightState::Flying, by_rates), None);
    }

    #[test]
    fn more_than_idle_thrust_takes_off() {
        let told = told(FlightState::Armed, with_thrust(IDLE_THRUST + 0.01));
        assert_eq!(told, Some((FlightEvent::TookOff, 0.0)));
    }

    #[test]
    fn what_rests_at_little_thrust_has_landed_and_what_falls_has_not() {
        let landed = Some((FlightEvent::Landed, seconds(LANDED_TIME)));
        assert_eq!(told(FlightState::Flying, with_thrust(0.1)), landed);
        assert_eq!(told(FlightState::Flying, with_thrust(0.19)), landed);
        let falling = Seen {
            force: Vec3::new(0.0, 0.0, -0.2 * GRAVITY),
            ..with_thrust(0.1)
        };
        assert_eq!(told(FlightState::Flying, falling), None);
    }

    #[test]
    fn a_drone_that_lies_over_or_does_not_follow_is_upset() {
        let over = Vec3::new(0.0, 1.0, 0.0);
        let upset = Some((FlightEvent::Upset, seconds(UPSET_TIME)));
        let lies = Seen {
            down: over,
            asked_down: None,
            ..hovering()
        };
        assert_eq!(told(FlightState::Flying, lies), upset);
        assert_eq!(
            told(
                FlightState::Armed,
                Seen {
                    thrust: Thrust::ZERO,
                    ..lies
                }
            ),
            upset
        );
        let astray = Seen {
            down: over,
            rates: Vec3::new(9.0, 0.0, 0.0),
            ..hovering()
        };
        assert_eq!(told(FlightState::Flying, astray), upset);
    }

    #[test]
    fn each_state_without_a_pilot_has_its_time() {
        let time_up = |length| Some((FlightEvent::TimeUp, seconds(length)));
        let state = |state| told(state, hovering());
        assert_eq!(state(FlightState::Waiting), time_up(WAITING_TIME));
        assert_eq!(state(FlightState::Descending), time_up(DESCENT_TIME));
        assert_eq!(state(FlightState::Blind), time_up(BLIND_TIME));
        let idle = told(FlightState::Armed, with_thrust(0.0));
        assert_eq!(idle, time_up(LONGEST_ON_GROUND));
        let sees_place = Seen {
            sees_place: true,
            ..hovering()
        };
        assert_eq!(told(FlightState::Descending, sees_place), None);
    }

    #[test]
    fn a_descent_takes_less_thrust_than_was_flown_in_the_mean() {
        let mut watch = Watch::default();
        watch.begin(FlightState::Flying, at_micros(0));
        for step in 1..100 {
            let share = if step % 2 == 0 { 0.3 } else { 0.5 };
            let at = at_micros(0) + STEP * step;
            watch.take(
                FlightState::Flying,
                &Seen {
                    at,
                    ..with_thrust(share)
                },
            );
        }
        let now = at_micros(0) + STEP * 100;
        let mean = watch.thrust_alone(FlightState::Waiting, now, None).share();
        assert!((mean - 0.4).abs() < 0.01, "{mean}");
        let descent = watch.thrust_alone(FlightState::Descending, now, None);
        assert!((descent.share() - mean * DESCENT_THRUST).abs() < 1e-6);
        let sinking = watch.thrust_alone(FlightState::Descending, now, Some(0.0));
        assert!(sinking.share() < mean, "{sinking:?}");
    }
}
