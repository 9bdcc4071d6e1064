//! What the fields of a position target mean, and which values are refused.

use super::*;
use crate::math::Vec3;
use crate::units::{Position, Velocity};
use core::f32::consts::PI;

/// What every position target must ignore: accelerations and the yaw rate.
const ALWAYS: u16 = 64 | 128 | 256 | 2048;
const NO_VELOCITY: u16 = 8 | 16 | 32;
const NO_YAW: u16 = 1024;

fn masked(mask: u16) -> SET_POSITION_TARGET_LOCAL_NED_DATA {
    SET_POSITION_TARGET_LOCAL_NED_DATA {
        type_mask: PositionTargetTypemask::from_bits_retain(mask),
        ..position_target()
    }
}

fn destination_of(target: &SET_POSITION_TARGET_LOCAL_NED_DATA) -> Option<Destination> {
    message_of(target).map(|message| match message {
        Message::Goal(destination) => destination,
        other => panic!("{other:?}"),
    })
}

#[test]
fn a_position_target_is_a_place_its_velocity_and_a_heading() {
    let expected = Destination {
        position: Position(Vec3::new(1.0, -2.0, -3.0)),
        velocity: Velocity(Vec3::new(0.5, 0.25, -0.125)),
        heading: Some(0.5),
    };
    assert_eq!(destination_of(&position_target()), Some(expected));
}

#[test]
fn an_ignored_velocity_is_a_place_that_stands_still() {
    let destination = destination_of(&masked(ALWAYS | NO_VELOCITY)).expect("accepted");
    assert_eq!(destination.velocity, Velocity::default());
    assert_eq!(destination.heading, Some(0.5));
}

#[test]
fn an_ignored_yaw_leaves_the_heading_open() {
    let destination = destination_of(&masked(ALWAYS | NO_YAW)).expect("accepted");
    assert_eq!(destination.heading, None);
    assert_eq!(destination.goal(0.75).heading, 0.75);
}

#[test]
fn of_all_masks_four_are_taken() {
    let taken: Vec<u16> = (0..=u16::MAX)
        .filter(|mask| destination_of(&masked(*mask)).is_some())
        .collect();
    let [low, high] = [ALWAYS | NO_VELOCITY, ALWAYS | NO_YAW];
    assert_eq!(taken, [ALWAYS, low, high, low | high]);
}

#[test]
fn only_the_local_north_east_down_frame_is_taken() {
    for frame_id in 0..=255 {
        let mut bytes = frame(0, &position_target());
        bytes[10 + 52] = frame_id;
        seal(&mut bytes, SET_POSITION_TARGET_LOCAL_NED_DATA::EXTRA_CRC);
        let (found, counters) = read(&bytes);
        assert_eq!(found.len(), usize::from(frame_id == 1), "{frame_id}");
        assert_eq!(counters.refused_value, u32::from(frame_id != 1));
    }
}

#[test]
fn a_yaw_is_wrapped_and_past_a_whole_turn_refused() {
    let heading = |yaw| {
        destination_of(&SET_POSITION_TARGET_LOCAL_NED_DATA {
            yaw,
            ..position_target()
        })
        .map(|destination| destination.heading.expect("given"))
    };
    let wrapped = heading(1.5 * PI).expect("accepted");
    assert!((wrapped + 0.5 * PI).abs() < 1e-6, "{wrapped}");
    assert_eq!(heading(-1.0), Some(-1.0));
    assert_eq!([heading(6.3), heading(-6.3)], [None; 2]);
}

#[test]
fn a_spoilt_field_of_a_position_target_refuses_it_unless_it_is_ignored() {
    type Field = fn(&mut SET_POSITION_TARGET_LOCAL_NED_DATA) -> &mut f32;
    let fields: [(Field, u16); 7] = [
        (|it| &mut it.x, 0),
        (|it| &mut it.y, 0),
        (|it| &mut it.z, 0),
        (|it| &mut it.vx, NO_VELOCITY),
        (|it| &mut it.vy, NO_VELOCITY),
        (|it| &mut it.vz, NO_VELOCITY),
        (|it| &mut it.yaw, NO_YAW),
    ];
    let spoilt = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for value in spoilt.into_iter().chain([f32::MAX, f32::MIN, 1e5 + 1.0]) {
        for (field, ignored) in fields {
            let mut target = position_target();
            *field(&mut target) = value;
            assert_eq!(destination_of(&target), None, "{target:?}");
            let mut target = masked(ALWAYS | ignored);
            *field(&mut target) = value;
            assert_eq!(destination_of(&target).is_some(), ignored != 0);
        }
        let mut target = position_target();
        (target.afx, target.yaw_rate) = (value, value);
        assert!(destination_of(&target).is_some(), "ignored in any case");
    }
}

#[test]
fn position_targets_for_others_are_not_flown_to() {
    for address in 0..=255 {
        let mut target = position_target();
        target.target_system = address;
        assert_eq!(destination_of(&target).is_some(), address == SYSTEM);
        target = position_target();
        target.target_component = address;
        assert_eq!(destination_of(&target).is_some(), address <= COMPONENT);
    }
}
