//! What the fields of a sound frame mean, and which values are refused.

use super::*;
use crate::control::{MotorTest, Setpoint, Yaw};
use crate::math::{Quaternion, Vec3};
use crate::time::micros;
use crate::units::{BodyRates, Position, Thrust, Velocity};
use mavlink::MavlinkVersion;
use mavlink::dialects::common::{MavMessage, MavModeFlag, MavState, MavType};
use mavlink::error::ParserError;

const SPOILT: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

fn masked(mask: u8) -> SET_ATTITUDE_TARGET_DATA {
    SET_ATTITUDE_TARGET_DATA {
        type_mask: AttitudeTargetTypemask::from_bits_retain(mask),
        ..attitude_target()
    }
}

fn setpoint_of(target: &SET_ATTITUDE_TARGET_DATA) -> Option<Setpoint> {
    message_of(target).map(|message| match message {
        Message::Setpoint(setpoint) => setpoint,
        other => panic!("{other:?}"),
    })
}

fn pose_of(odometry: &ODOMETRY_DATA) -> Option<ExternalPose> {
    message_of(odometry).map(|message| match message {
        Message::Pose(pose) => pose,
        other => panic!("{other:?}"),
    })
}

#[test]
fn a_heartbeat_says_that_the_peer_lives() {
    let heartbeat = HEARTBEAT_DATA {
        mavtype: MavType::MAV_TYPE_GCS,
        base_mode: MavModeFlag::empty(),
        system_status: MavState::MAV_STATE_ACTIVE,
        ..HEARTBEAT_DATA::DEFAULT
    };
    assert_eq!(message_of(&heartbeat), Some(Message::Heartbeat));
}

#[test]
fn a_heartbeat_of_a_kind_that_the_dialect_lacks_counts_all_the_same() {
    let mut bytes = frame(0, &HEARTBEAT_DATA::DEFAULT);
    bytes[10 + 4] = 250;
    seal(&mut bytes, HEARTBEAT_DATA::EXTRA_CRC);
    assert_eq!(read(&bytes).0.len(), 1);
}

#[test]
fn an_attitude_target_without_mask_is_attitude_rates_and_thrust() {
    let expected = Setpoint {
        attitude: Quaternion::from_array([0.8, 0.0, 0.6, 0.0]),
        rates: BodyRates(Vec3::new(0.1, -0.2, 0.3)),
        yaw: Yaw::Rate,
        thrust: Thrust::new(0.5).expect("in range"),
    };
    assert_eq!(setpoint_of(&attitude_target()), Some(expected));
}

#[test]
fn an_ignored_yaw_rate_holds_the_heading_of_the_attitude() {
    let setpoint = setpoint_of(&masked(4)).expect("accepted");
    assert_eq!(setpoint.yaw, Yaw::Heading);
    assert_eq!(setpoint.rates.0, Vec3::new(0.1, -0.2, 0.0));
}

#[test]
fn an_ignored_attitude_leaves_rates_and_no_heading_to_hold() {
    for mask in [128, 128 | 4] {
        let setpoint = setpoint_of(&masked(mask)).expect("accepted");
        assert_eq!((setpoint.attitude, setpoint.yaw), (None, Yaw::Rate));
    }
}

#[test]
fn every_mask_is_taken_or_refused_by_the_same_few_rules() {
    for mask in 0..=255_u8 {
        let no_thrust = mask & (64 | 32) != 0;
        let nothing_left = mask & (128 | 7) == 128 | 7;
        let setpoint = setpoint_of(&masked(mask));
        assert_eq!(setpoint.is_none(), no_thrust || nothing_left, "{mask}");
        let Some(setpoint) = setpoint else { continue };
        let rates = setpoint.rates.0;
        assert_eq!(setpoint.attitude.is_none(), mask & 128 != 0, "{mask}");
        assert_eq!(rates.x == 0.0, mask & 1 != 0, "{mask}");
        assert_eq!(rates.y == 0.0, mask & 2 != 0, "{mask}");
        assert_eq!(rates.z == 0.0, mask & 4 != 0, "{mask}");
    }
}

#[test]
fn ignored_fields_may_hold_anything() {
    let mut target = masked(128 | 1);
    target.q = [f32::NAN; 4];
    target.body_roll_rate = f32::INFINITY;
    assert!(setpoint_of(&target).is_some());
}

#[test]
fn a_spoilt_field_of_an_attitude_target_refuses_it() {
    let fields: [fn(&mut SET_ATTITUDE_TARGET_DATA) -> &mut f32; 8] = [
        |it| &mut it.q[0],
        |it| &mut it.q[1],
        |it| &mut it.q[2],
        |it| &mut it.q[3],
        |it| &mut it.body_roll_rate,
        |it| &mut it.body_pitch_rate,
        |it| &mut it.body_yaw_rate,
        |it| &mut it.thrust,
    ];
    for field in fields {
        for value in SPOILT
            .into_iter()
            .chain([f32::MAX, f32::MIN, 101.0, -101.0])
        {
            let mut target = attitude_target();
            *field(&mut target) = value;
            assert_eq!(setpoint_of(&target), None, "{target:?}");
        }
    }
}

#[test]
fn thrust_and_attitude_have_narrow_ranges() {
    let with_thrust = |thrust| SET_ATTITUDE_TARGET_DATA {
        thrust,
        ..attitude_target()
    };
    let with_attitude = |q| SET_ATTITUDE_TARGET_DATA {
        q,
        ..attitude_target()
    };
    for thrust in [0.0, 1.0] {
        assert!(setpoint_of(&with_thrust(thrust)).is_some());
    }
    for thrust in [-0.001, 1.001] {
        assert!(setpoint_of(&with_thrust(thrust)).is_none());
    }
    assert!(setpoint_of(&with_attitude([0.99, 0.0, 0.0, 0.0])).is_some());
    for q in [[0.0; 4], [0.5, 0.0, 0.0, 0.0], [1.0; 4]] {
        assert!(setpoint_of(&with_attitude(q)).is_none());
    }
}

#[test]
fn arm_and_disarm_are_commands_of_zero_and_one() {
    assert_eq!(
        message_of(&arm_command(1.0)),
        Some(Message::Arm(ArmCommand::ARM))
    );
    assert_eq!(
        message_of(&arm_command(0.0)),
        Some(Message::Arm(ArmCommand::DISARM))
    );
    let forced = COMMAND_LONG_DATA {
        param2: 21196.0,
        ..arm_command(1.0)
    };
    let expected = ArmCommand {
        force: true,
        ..ArmCommand::ARM
    };
    assert_eq!(message_of(&forced), Some(Message::Arm(expected)));
    for other in [0.0, 1.0, 21_195.0, f32::NAN] {
        let command = COMMAND_LONG_DATA {
            param2: other,
            ..arm_command(0.0)
        };
        let expected = Message::Arm(ArmCommand::DISARM);
        assert_eq!(message_of(&command), Some(expected), "{other}");
    }
}

#[test]
fn a_command_with_integers_is_read_alike() {
    let command = COMMAND_INT_DATA {
        param2: 21196.0,
        ..int_command()
    };
    let expected = ArmCommand {
        arm: true,
        force: true,
    };
    assert_eq!(message_of(&command), Some(Message::Arm(expected)));
    let takeoff = COMMAND_INT_DATA {
        command: MavCmd::MAV_CMD_NAV_TAKEOFF,
        ..command
    };
    let (found, _) = read(&frame(0, &takeoff));
    let refused = Incoming::Refused {
        from: GROUND,
        command: 22,
        answer: Answer::Unsupported,
    };
    assert_eq!(found, [refused]);
}

#[test]
fn other_commands_are_answered_and_not_passed_on() {
    let mut cases: Vec<(u16, Answer, Vec<u8>)> = [0.5, 2.0, -1.0, f32::NAN, f32::INFINITY]
        .map(|arm| (ARM_DISARM, Answer::Denied, frame(0, &arm_command(arm))))
        .to_vec();
    let takeoff = COMMAND_LONG_DATA {
        command: MavCmd::MAV_CMD_NAV_TAKEOFF,
        ..arm_command(1.0)
    };
    cases.push((22, Answer::Unsupported, frame(0, &takeoff)));
    // A number that the dialect does not name.
    let mut vendor = frame(0, &takeoff);
    vendor[10 + 28..10 + 30].copy_from_slice(&60_000_u16.to_le_bytes());
    seal(&mut vendor, COMMAND_LONG_DATA::EXTRA_CRC);
    cases.push((60_000, Answer::Unsupported, vendor));
    for (command, answer, bytes) in cases {
        let (found, counters) = read(&bytes);
        assert_eq!(
            found,
            [Incoming::Refused {
                from: GROUND,
                command,
                answer
            }]
        );
        assert_eq!((counters.frames, counters.refused_value), (1, 1));
    }
}

fn command(command: MavCmd, parameters: [f32; 7]) -> COMMAND_LONG_DATA {
    let [param1, param2, param3, param4, param5, param6, param7] = parameters;
    COMMAND_LONG_DATA {
        param1,
        param2,
        param3,
        param4,
        param5,
        param6,
        param7,
        command,
        target_system: SYSTEM,
        ..COMMAND_LONG_DATA::DEFAULT
    }
}

#[test]
fn one_thing_is_calibrated_at_a_time_and_settings_are_kept_or_forgotten() {
    use MavCmd::{MAV_CMD_PREFLIGHT_CALIBRATION as CALIBRATE, MAV_CMD_PREFLIGHT_STORAGE as STORE};
    let none = f32::NAN;
    let level = Message::Calibrate(Calibrate::Level);
    for (number, parameters, expected) in [
        (
            CALIBRATE,
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            Some(Message::Calibrate(Calibrate::Gyroscope)),
        ),
        (CALIBRATE, [0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0], Some(level)),
        (
            CALIBRATE,
            [none, 0.0, 0.0, 0.0, 2.0, none, 0.0],
            Some(level),
        ),
        (CALIBRATE, [1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0], None),
        (CALIBRATE, [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0], None),
        (CALIBRATE, [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0], None),
        (CALIBRATE, [0.0; 7], None),
        (
            STORE,
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            Some(Message::Store(StoreCommand::Save)),
        ),
        (
            STORE,
            [2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            Some(Message::Store(StoreCommand::Reset)),
        ),
        (STORE, [0.0; 7], None),
        (STORE, [none; 7], None),
    ] {
        let (found, _) = read(&frame(0, &command(number, parameters)));
        let found = match found[..] {
            [Incoming::Message { message, .. }] => Some(message),
            [
                Incoming::Refused {
                    answer: Answer::Denied,
                    ..
                },
            ] => None,
            _ => panic!("{found:?}"),
        };
        assert_eq!(found, expected, "{number:?} {parameters:?}");
    }
    // A COMMAND_INT has a whole number in the fifth place.
    let mut whole = command(CALIBRATE, [0.0; 7]);
    whole.param5 = f32::from_bits(2);
    assert_eq!(message_of(&whole), Some(level));
}

fn motor_test(motor: f32, kind: f32, percent: f32, length_s: f32) -> COMMAND_LONG_DATA {
    COMMAND_LONG_DATA {
        command: MavCmd::MAV_CMD_DO_MOTOR_TEST,
        param2: kind,
        param3: percent,
        param4: length_s,
        ..arm_command(motor)
    }
}

#[test]
fn a_motor_test_names_one_motor_a_throttle_in_percent_and_a_time() {
    let expected = MotorTest {
        motor: 2,
        share: 10.0 * 0.01,
        length: micros(1_500_000),
    };
    let found = message_of(&motor_test(3.0, 0.0, 10.0, 1.5));
    assert_eq!(found, Some(Message::TestMotor(expected)));
    let wrong = [
        motor_test(0.0, 0.0, 10.0, 1.0),
        motor_test(9.0, 0.0, 10.0, 1.0),
        motor_test(f32::NAN, 0.0, 10.0, 1.0),
        motor_test(1.0, 1.0, 10.0, 1.0),
        motor_test(1.0, 0.0, 101.0, 1.0),
        motor_test(1.0, 0.0, f32::NAN, 1.0),
        motor_test(1.0, 0.0, 10.0, -1.0),
        motor_test(1.0, 0.0, 10.0, f32::INFINITY),
        COMMAND_LONG_DATA {
            param5: 4.0,
            ..motor_test(1.0, 0.0, 10.0, 1.0)
        },
    ];
    for command in wrong {
        let (found, _) = read(&frame(0, &command));
        let refused = Incoming::Refused {
            from: GROUND,
            command: MOTOR_TEST,
            answer: Answer::Denied,
        };
        assert_eq!(found, [refused], "{command:?}");
    }
}

#[test]
fn messages_for_others_are_neither_obeyed_nor_answered() {
    for system in 0..=255_u8 {
        for component in 0..=255_u8 {
            let mut command = arm_command(1.0);
            (command.target_system, command.target_component) = (system, component);
            let (found, counters) = read(&frame(0, &command));
            let others = !matches!((system, component), (0 | SYSTEM, 0 | COMPONENT));
            assert_eq!(counters.not_for_us, u32::from(others));
            match (system, component) {
                (SYSTEM, 0 | COMPONENT) => {
                    assert!(matches!(found[..], [Incoming::Message { .. }]));
                }
                // One command would arm every drone that hears it.
                (0, 0 | COMPONENT) => assert_eq!(
                    found,
                    [Incoming::Refused {
                        from: GROUND,
                        command: ARM_DISARM,
                        answer: Answer::Denied,
                    }]
                ),
                _ => assert!(found.is_empty(), "{system}/{component}"),
            }
        }
        let mut target = attitude_target();
        target.target_system = system;
        assert_eq!(message_of(&target).is_some(), system == SYSTEM);
        target = attitude_target();
        target.target_component = system;
        assert_eq!(message_of(&target).is_some(), system <= COMPONENT);
    }
    let mut unknown = arm_command(1.0);
    unknown.command = MavCmd::MAV_CMD_NAV_TAKEOFF;
    unknown.target_system = 2;
    let (found, counters) = read(&frame(0, &unknown));
    assert_eq!((found.len(), counters.not_for_us), (0, 1));
}

#[test]
fn odometry_in_the_local_frame_is_taken_as_it_is() {
    for local in [MavFrame::MAV_FRAME_LOCAL_NED, MavFrame::MAV_FRAME_LOCAL_FRD] {
        let pose = pose_of(&ODOMETRY_DATA {
            frame_id: local,
            child_frame_id: local,
            ..odometry()
        });
        let expected = ExternalPose {
            position: Position(Vec3::new(1.0, -2.0, -3.0)),
            velocity: Velocity(Vec3::new(4.0, 0.5, 0.25)),
            attitude: Quaternion::from_array(odometry().q),
            reset_counter: 0,
        };
        assert_eq!(pose, Some(expected));
    }
}

#[test]
fn odometry_with_velocity_in_body_axes_is_turned_by_its_attitude() {
    // Heading east: forward is east, right is south.
    let body = ODOMETRY_DATA {
        child_frame_id: MavFrame::MAV_FRAME_BODY_FRD,
        ..odometry()
    };
    let velocity = pose_of(&body).expect("accepted").velocity.0;
    assert!((velocity - Vec3::new(-0.5, 4.0, 0.25)).max_norm() < 1e-6);
    let no_attitude = ODOMETRY_DATA {
        q: [f32::NAN; 4],
        ..body
    };
    assert_eq!(pose_of(&no_attitude), None);
}

#[test]
fn odometry_counts_its_resets_and_has_limits_of_distance() {
    let far = |x| pose_of(&ODOMETRY_DATA { x, ..odometry() });
    assert!(far(crate::config::LARGEST_DISTANCE).is_some());
    assert_eq!(far(90_000.0), None);
    let mut bytes = frame(0, &odometry());
    bytes.truncate(10 + 230);
    bytes.extend([9, 0, 0, 0, 0]);
    bytes[1] = 233;
    seal(&mut bytes, ODOMETRY_DATA::EXTRA_CRC);
    let (found, _) = read(&bytes);
    let [
        Incoming::Message {
            message: Message::Pose(pose),
            ..
        },
    ] = found[..]
    else {
        panic!("{found:?}");
    };
    assert_eq!(pose.reset_counter, 9);
}

#[test]
fn odometry_without_attitude_gives_none() {
    let pose = pose_of(&ODOMETRY_DATA {
        q: [f32::NAN, 0.0, 0.0, 0.0],
        ..odometry()
    });
    assert_eq!(pose.expect("accepted").attitude, None);
}

#[test]
fn odometry_in_other_frames_is_refused() {
    let accepted = [(1, 1), (20, 20), (1, 12), (20, 12)];
    for frame_id in 0..=30 {
        for child in 0..=30 {
            let mut bytes = frame(0, &odometry());
            bytes[10 + 228] = frame_id;
            bytes[10 + 229] = child;
            // A child frame of zero would not have been sent, which changes nothing.
            seal(&mut bytes, ODOMETRY_DATA::EXTRA_CRC);
            let (found, counters) = read(&bytes);
            let taken = accepted.contains(&(frame_id, child));
            assert_eq!(found.len(), usize::from(taken), "{frame_id}/{child}");
            assert_eq!(counters.refused_value, u32::from(!taken));
        }
    }
}

#[test]
fn a_spoilt_field_of_an_odometry_refuses_it() {
    let fields: [fn(&mut ODOMETRY_DATA) -> &mut f32; 10] = [
        |it| &mut it.x,
        |it| &mut it.y,
        |it| &mut it.z,
        |it| &mut it.vx,
        |it| &mut it.vy,
        |it| &mut it.vz,
        |it| &mut it.q[1],
        |it| &mut it.q[2],
        |it| &mut it.q[3],
        |it| &mut it.q[0],
    ];
    for (place, field) in fields.into_iter().enumerate() {
        for value in SPOILT.into_iter().chain([1e30, -1e30]) {
            if place == 9 && value.is_nan() {
                continue; // the way to say that there is no attitude
            }
            let mut spoilt = odometry();
            *field(&mut spoilt) = value;
            assert_eq!(pose_of(&spoilt), None, "{spoilt:?}");
        }
    }
}

/// ODOMETRY with the extensions that the crate leaves out.
struct WithQuality(i8);

impl MessageData for WithQuality {
    type Message = MavMessage;
    const ID: u32 = ODOMETRY_DATA::ID;
    const NAME: &'static str = ODOMETRY_DATA::NAME;
    const EXTRA_CRC: u8 = ODOMETRY_DATA::EXTRA_CRC;
    const ENCODED_LEN: usize = 233;

    fn ser(&self, version: MavlinkVersion, payload: &mut [u8]) -> usize {
        odometry().ser(version, payload);
        payload[230..233].copy_from_slice(&[9, 2, self.0.to_le_bytes()[0]]);
        233
    }

    fn deser(_: MavlinkVersion, _: &[u8]) -> Result<Self, ParserError> {
        unreachable!("only sent")
    }
}

#[test]
fn odometry_of_a_failed_estimator_is_refused() {
    for quality in [-1, -128] {
        assert_eq!(message_of(&WithQuality(quality)), None);
    }
    for quality in [0, 1, 100] {
        assert!(message_of(&WithQuality(quality)).is_some());
    }
}
