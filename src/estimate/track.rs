//! Places of one source as one movement, without its resets and jumps.
//!
//! A source that finds out that it was wrong moves all its places at once and counts a reset. The drone
//! did not move: the drone's frame stays where it was, and places and goals of the source are moved back
//! into it. Where the source moved without saying so, nobody knows which place is right.

use super::Place;
use crate::config::{PLACE_JUMP, SETPOINT_TIMEOUT};
use crate::math::Vec3;
use crate::time::{Duration, Instant, micros, seconds, span};
use crate::units::{Position, Velocity};

/// Places further apart are not of one movement for who steps on them: the later one begins anew.
const LONGEST_BETWEEN: Duration = micros(500_000);

/// What became of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Followed {
    /// It goes on from the one before, or is the first after a silence.
    On(Place),
    /// As above; the source was reset, and its frame moved.
    Reset(Place),
    /// It is further from where motion leads than [`PLACE_JUMP`]: not used.
    Jumped,
}

/// The places of a source so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Track {
    last: Option<Last>,
    /// From the drone's frame to the source's, in m.
    moved: Vec3,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Last {
    at: Instant,
    place: Place,
    resets: u8,
}

impl Track {
    /// Takes a place in the source's frame, and how often that was reset.
    pub fn take(
        &mut self,
        at: Instant,
        position: Position,
        velocity: Velocity,
        resets: u8,
    ) -> Followed {
        let before = self.last.filter(|_| self.is_fresh(at));
        let since = before.map_or(Duration::from_ticks(0), |before| span(before.at, at));
        let mut was_reset = false;
        if let Some(before) = before {
            let Place {
                position: from,
                velocity: by,
                ..
            } = before.place;
            let step = position.0 - (from.0 + by.0 * seconds(since));
            was_reset = resets != before.resets;
            if was_reset {
                self.moved = step;
            } else if (step - self.moved).norm() > PLACE_JUMP {
                return Followed::Jumped;
            }
        } else {
            self.moved = Vec3::ZERO;
        }
        let place = Place {
            position: self.tracked(position),
            velocity,
            dt: if since <= LONGEST_BETWEEN {
                seconds(since)
            } else {
                0.0
            },
        };
        self.last = Some(Last { at, place, resets });
        if was_reset {
            Followed::Reset(place)
        } else {
            Followed::On(place)
        }
    }

    /// A position of the source in the drone's frame.
    #[must_use]
    pub fn tracked(&self, position: Position) -> Position {
        Position(position.0 - self.moved)
    }

    /// True while places come.
    #[must_use]
    pub fn is_fresh(&self, now: Instant) -> bool {
        self.last
            .is_some_and(|last| span(last.at, now) <= SETPOINT_TIMEOUT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;

    const FLIES: Velocity = Velocity(Vec3::new(2.0, 0.0, 0.0));

    fn north(x: f32) -> Position {
        Position(Vec3::new(x, 0.0, -5.0))
    }

    /// What becomes of places (ms, north, resets) of a drone that flies north at 2 m/s.
    fn followed<const N: usize>(places: [(u64, f32, u8); N]) -> [Option<f32>; N] {
        let mut track = Track::default();
        places.map(|(ms, x, resets)| {
            match track.take(at_micros(1000 * ms), north(x), FLIES, resets) {
                Followed::On(place) | Followed::Reset(place) => Some(place.position.0.x),
                Followed::Jumped => None,
            }
        })
    }

    #[test]
    fn a_reset_moves_the_frame_and_not_the_drone() {
        let seen = followed([(0, 0.0, 7), (50, 0.1, 7), (100, 8.2, 8), (150, 8.3, 8)]);
        for (seen, expected) in seen.into_iter().zip([0.0, 0.1, 0.2, 0.3]) {
            assert!(
                (seen.expect("followed") - expected).abs() < 1e-5,
                "{seen:?}"
            );
        }
    }

    #[test]
    fn goals_move_with_the_frame() {
        let mut track = Track::default();
        track.take(at_micros(0), north(0.0), Velocity::default(), 0);
        let reset = track.take(at_micros(20_000), north(8.0), Velocity::default(), 1);
        assert!(matches!(reset, Followed::Reset(_)));
        assert_eq!(track.tracked(north(9.0)), north(1.0));
    }

    #[test]
    fn a_jump_without_a_reset_is_left_out_until_places_have_been_lost() {
        let jumped = 8.0 + PLACE_JUMP;
        let seen = followed([
            (0, 0.0, 0),
            (50, jumped, 0),
            (100, 0.2, 0),
            (150, jumped, 0),
            (1_000, jumped, 0),
            (1_150, jumped, 0),
        ]);
        assert_eq!(seen, [Some(0.0), None, Some(0.2), None, None, Some(jumped)]);
    }

    #[test]
    fn what_motion_leads_to_is_no_jump() {
        let seen = followed([(0, 0.0, 0), (900, 1.8 + 0.9 * PLACE_JUMP, 0)]);
        assert!(seen[1].is_some());
    }
}
