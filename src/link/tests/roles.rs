//! Who may command, and for how long.

use super::*;
use crate::config::PILOT_TIMEOUT;
use crate::time::micros;

const SECOND: u8 = 254;

/// The frame as another station would send it.
fn of_second(mut frame: Vec<u8>, extra: u8) -> Vec<u8> {
    frame[5] = SECOND;
    seal(&mut frame, extra);
    frame
}

fn arm_of_second() -> Vec<u8> {
    of_second(frame(0, &arm_command(0.0)), COMMAND_LONG_DATA::EXTRA_CRC)
}

fn fed(parser: &mut Parser, at: Instant, bytes: &[u8]) -> Vec<Incoming> {
    parser.feed(at, bytes).collect()
}

fn denied() -> Incoming {
    Incoming::Refused {
        from: Peer {
            system: SECOND,
            ..GROUND
        },
        command: ARM_DISARM,
        answer: Answer::Denied,
    }
}

#[test]
fn the_second_station_is_denied_until_the_first_has_been_silent() {
    let mut parser = Parser::new();
    assert_eq!(fed(&mut parser, NOW, &frame(0, &arm_command(1.0))).len(), 1);
    assert_eq!(fed(&mut parser, NOW, &arm_of_second()), [denied()]);
    // A sign of life is enough to stay the pilot.
    let later = NOW + PILOT_TIMEOUT;
    let beat = frame(1, &HEARTBEAT_DATA::DEFAULT);
    assert_eq!(fed(&mut parser, later, &beat).len(), 1);
    let silent = later + PILOT_TIMEOUT;
    assert_eq!(fed(&mut parser, silent, &arm_of_second()), [denied()]);
    assert_eq!(parser.counters().not_allowed, 2);
    let free = silent + micros(1);
    let found = fed(&mut parser, free, &arm_of_second());
    assert!(matches!(
        found[..],
        [Incoming::Message {
            message: Message::Arm(ArmCommand::DISARM),
            ..
        }]
    ));
    // Now it is the other way round.
    let found = fed(&mut parser, free, &frame(2, &arm_command(1.0)));
    let denied = Incoming::Refused {
        from: GROUND,
        command: ARM_DISARM,
        answer: Answer::Denied,
    };
    assert_eq!(found, [denied]);
}

#[test]
fn what_the_second_station_sends_does_not_keep_the_first_alive() {
    let mut parser = Parser::new();
    let _ = fed(&mut parser, NOW, &frame(0, &attitude_target()));
    let beat = of_second(
        frame(0, &HEARTBEAT_DATA::DEFAULT),
        HEARTBEAT_DATA::EXTRA_CRC,
    );
    let later = NOW + PILOT_TIMEOUT + micros(1);
    let _ = fed(&mut parser, later, &beat);
    assert_ne!(fed(&mut parser, later, &arm_of_second()), [denied()]);
}

#[test]
fn setpoints_goals_and_keys_of_the_second_station_are_dropped_and_counted() {
    let mut parser = Parser::new();
    let _ = fed(&mut parser, NOW, &frame(0, &attitude_target()));
    let frames = [
        of_second(
            frame(0, &attitude_target()),
            SET_ATTITUDE_TARGET_DATA::EXTRA_CRC,
        ),
        of_second(
            frame(1, &position_target()),
            SET_POSITION_TARGET_LOCAL_NED_DATA::EXTRA_CRC,
        ),
        of_second(frame(2, &signing_setup()), SETUP_SIGNING_DATA::EXTRA_CRC),
    ];
    assert_eq!(fed(&mut parser, NOW, &frames.concat()), []);
    assert_eq!(parser.counters().not_allowed, 3);
}

#[test]
fn reading_and_commands_that_are_not_ours_make_nobody_pilot() {
    let mut parser = Parser::new();
    let mut ask = arm_command(1.0);
    ask.command = MavCmd::MAV_CMD_REQUEST_MESSAGE;
    let frames = [frame(0, &HEARTBEAT_DATA::DEFAULT), frame(1, &ask)];
    let _ = fed(&mut parser, NOW, &frames.concat());
    assert_ne!(fed(&mut parser, NOW, &arm_of_second()), [denied()]);
}

#[test]
fn one_peer_says_where_the_drone_is_and_it_need_not_be_the_pilot() {
    let mut parser = Parser::new();
    let _ = fed(&mut parser, NOW, &frame(0, &attitude_target()));
    let pose = of_second(frame(0, &odometry()), ODOMETRY_DATA::EXTRA_CRC);
    assert_eq!(fed(&mut parser, NOW, &pose).len(), 1);
    assert_eq!(fed(&mut parser, NOW, &frame(1, &odometry())), []);
    assert_eq!(parser.counters().not_allowed, 1);
}
