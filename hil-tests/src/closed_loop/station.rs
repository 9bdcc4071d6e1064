//! The ground station of a simulated flight: what goes over the link to the drone.
//!
//! | message | when |
//! |---|---|
//! | HEARTBEAT | every second from the start |
//! | COMMAND_LONG, arm | 0.2, 0.15, 0.1 and 0.05 s before take-off |
//! | ODOMETRY | at its rate in `config/positions/`, from 0.5 s before take-off; without an attitude |
//! | SET_POSITION_TARGET_LOCAL_NED | behind each ODOMETRY, from take-off on |
//! | SET_ATTITUDE_TARGET | in its stead, for control logics that do not fly to places; before take-off without thrust |

use mavlink::dialects::common::{
    AttitudeTargetTypemask, MavFrame, MavMessage, PositionTargetTypemask, SET_ATTITUDE_TARGET_DATA,
    SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use reflex_config::plant::Tracking;

use super::mission::Target;
use super::outer_loop::{Demand, OuterLoop};
use super::tracker::{Seen, Tracker};
use crate::faults::{BrokenLink, Script};
use crate::ground_station::{
    ARM_LEADS_NS, DRONE, HEARTBEAT_PERIOD_NS, LinkFrame, MILLISECOND_NS, arm, frame, heartbeat,
    odometry,
};
use recorded_flights::Sighting;

/// When the drone takes off: until then it stands still, boots, calibrates and is armed, ns.
pub(super) const TAKE_OFF_NS: u64 = 1_500_000_000;

/// How often a station is asked in flight.
const LOOKS_PER_SECOND: usize = 100;

const FIRST_PLACE_NS: u64 = TAKE_OFF_NS - 500 * MILLISECOND_NS;

/// A ground station that watches one flight.
pub(super) struct Station {
    tracker: Tracker,
    /// For control logics that fly attitudes.
    outer: Option<OuterLoop>,
    heartbeats: u64,
    arms: usize,
    sequence: u8,
    link: BrokenLink,
}

impl Station {
    /// One whose drone flies to goals by itself, or takes attitudes.
    pub(super) fn new(flies_to_goals: bool, tracking: &Tracking, seed: u64) -> Self {
        Self {
            tracker: Tracker::new(tracking, FIRST_PLACE_NS, seed),
            outer: (!flies_to_goals).then(OuterLoop::default),
            heartbeats: 0,
            arms: 0,
            sequence: 0,
            link: BrokenLink::of(&Script::default()),
        }
    }

    /// The same one, whose link suffers from the faults of a script.
    pub(super) fn under(mut self, faults: &Script) -> Self {
        self.link = BrokenLink::of(faults);
        self
    }

    /// What it sends at an instant, of a drone at a place and with a velocity.
    ///
    /// To be asked often enough for its rates; each instant once.
    pub(super) fn speak(
        &mut self,
        at_ns: u64,
        (position, velocity): (&Vector3<f64>, &Vector3<f64>),
        target: &Target,
    ) -> Vec<LinkFrame> {
        let mut messages = Vec::new();
        if at_ns >= self.heartbeats * HEARTBEAT_PERIOD_NS {
            self.heartbeats += 1;
            messages.push(heartbeat());
        }
        if let Some(lead) = ARM_LEADS_NS.get(self.arms)
            && at_ns + lead >= TAKE_OFF_NS
        {
            messages.push(arm(self.arms as u8));
            self.arms += 1;
        }
        if let Some(seen) = self.tracker.look(at_ns, (*position, *velocity)) {
            messages.push(odometry(
                at_ns,
                MavFrame::MAV_FRAME_LOCAL_NED,
                &Sighting {
                    position: seen.0.into(),
                    velocity: seen.1.into(),
                    ..Sighting::default()
                },
            ));
            messages.extend(self.demand(at_ns, &seen, target));
        }
        let mut frames: Vec<_> = (messages.into_iter())
            .flat_map(|message| {
                let times = self.link.times(at_ns, &message);
                std::iter::repeat_n(message, times)
            })
            .collect::<Vec<_>>()
            .into_iter()
            .map(|message| self.frame(at_ns, &message))
            .collect();
        let noise = self.link.noise(at_ns, LOOKS_PER_SECOND);
        frames.extend(noise.map(|bytes| LinkFrame { at_ns, bytes }));
        frames
    }

    fn demand(&mut self, at_ns: u64, seen: &Seen, target: &Target) -> Option<MavMessage> {
        let flies = at_ns >= TAKE_OFF_NS;
        match &mut self.outer {
            None => flies.then(|| goal(at_ns, target)),
            Some(outer) => {
                let demand = if flies {
                    outer.steer(target, (&seen.0, &seen.1), self.tracker.period_s())
                } else {
                    Demand::NONE
                };
                Some(attitude(at_ns, &demand))
            }
        }
    }

    fn frame(&mut self, at_ns: u64, message: &MavMessage) -> LinkFrame {
        let bytes = frame(message, self.sequence);
        self.sequence = self.sequence.wrapping_add(1);
        LinkFrame { at_ns, bytes }
    }
}

fn goal(at_ns: u64, target: &Target) -> MavMessage {
    MavMessage::SET_POSITION_TARGET_LOCAL_NED(SET_POSITION_TARGET_LOCAL_NED_DATA {
        time_boot_ms: (at_ns / MILLISECOND_NS) as u32,
        x: target.position.x as f32,
        y: target.position.y as f32,
        z: target.position.z as f32,
        vx: target.velocity.x as f32,
        vy: target.velocity.y as f32,
        vz: target.velocity.z as f32,
        yaw: target.heading as f32,
        type_mask: PositionTargetTypemask::POSITION_TARGET_TYPEMASK_AX_IGNORE
            | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_AY_IGNORE
            | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_AZ_IGNORE
            | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE,
        target_system: DRONE.0,
        target_component: DRONE.1,
        coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
        ..SET_POSITION_TARGET_LOCAL_NED_DATA::DEFAULT
    })
}

fn attitude(at_ns: u64, demand: &Demand) -> MavMessage {
    MavMessage::SET_ATTITUDE_TARGET(SET_ATTITUDE_TARGET_DATA {
        time_boot_ms: (at_ns / MILLISECOND_NS) as u32,
        q: components(&demand.attitude).map(|component| component as f32),
        thrust: demand.thrust as f32,
        target_system: DRONE.0,
        target_component: DRONE.1,
        type_mask: AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
            | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
            | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE,
        ..SET_ATTITUDE_TARGET_DATA::DEFAULT
    })
}

fn components(attitude: &UnitQuaternion<f64>) -> [f64; 4] {
    let Quaternion { coords } = attitude.into_inner();
    [coords.w, coords.x, coords.y, coords.z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::mission::{Course, Mission};
    use reflex::link::{ArmCommand, Incoming, Message, Parser};
    use reflex::time::at_micros;
    use reflex::units::Thrust;

    const TRACKING: Tracking = Tracking {
        rate_hz: 20.0,
        delay_s: 0.0,
        noise_m: 0.0,
        noise_m_s: 0.0,
        drift_m: 0.0,
        drift_s: 60.0,
    };

    /// The messages to a drone at rest in its first seconds, with the instants in ms.
    fn sent(flies_to_goals: bool, seconds: u64) -> Vec<(u64, Message)> {
        let mut station = Station::new(flies_to_goals, &TRACKING, 1);
        let target = Course::new(Mission::Hover, 1.0, 1).target();
        let here = Vector3::new(1.0, 2.0, -3.0);
        let mut parser = Parser::new();
        let mut sent = Vec::new();
        for tick in 0..seconds * 100 {
            let at_ns = tick * 10 * MILLISECOND_NS;
            for frame in station.speak(at_ns, (&here, &Vector3::zeros()), &target) {
                for incoming in parser.feed(at_micros(at_ns / 1000), &frame.bytes) {
                    let Incoming::Message { message, .. } = incoming else {
                        panic!("{incoming:?}");
                    };
                    sent.push((tick * 10, message));
                }
            }
        }
        sent
    }

    #[test]
    fn the_drone_is_armed_four_times_before_take_off() {
        let sent = sent(true, 3);
        let armed = sent
            .iter()
            .filter(|sent| sent.1 == Message::Arm(ArmCommand::ARM));
        assert_eq!(
            armed.map(|sent| sent.0).collect::<Vec<_>>(),
            [1300, 1350, 1400, 1450]
        );
        let beats = sent.iter().filter(|sent| sent.1 == Message::Heartbeat);
        assert_eq!(beats.count(), 3);
    }

    #[test]
    fn places_come_first_and_goals_behind_each_from_take_off_on() {
        let sent = sent(true, 2);
        let poses: Vec<u64> = (sent.iter())
            .filter(|sent| matches!(sent.1, Message::Pose(_)))
            .map(|sent| sent.0)
            .collect();
        assert_eq!((poses[0], poses[1], poses.len()), (1000, 1050, 20));
        let goals: Vec<u64> = (sent.iter())
            .filter(|sent| matches!(sent.1, Message::Goal(_)))
            .map(|sent| sent.0)
            .collect();
        assert_eq!((goals[0], goals.len()), (1500, 10));
    }

    #[test]
    fn a_logic_without_position_loops_is_told_attitudes() {
        let sent = sent(false, 2);
        assert!(!sent.iter().any(|sent| matches!(sent.1, Message::Goal(_))));
        let setpoints = sent.iter().filter_map(|sent| match sent.1 {
            Message::Setpoint(setpoint) => Some((sent.0, setpoint)),
            _ => None,
        });
        let (before, flown): (Vec<_>, Vec<_>) = setpoints.partition(|(at_ms, _)| *at_ms < 1500);
        assert!(!before.is_empty());
        assert!(
            before
                .iter()
                .all(|(_, setpoint)| setpoint.thrust == Thrust::ZERO)
        );
        let attitude = flown.first().and_then(|(_, setpoint)| setpoint.attitude);
        let attitude = attitude.expect("one");
        assert!(attitude.down_in_body().x.abs() > 0.05, "leans to the south");
    }
}
