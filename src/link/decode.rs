//! From a frame to a checked message.
//!
//! | MAVLink message | becomes | refused where |
//! |---|---|---|
//! | HEARTBEAT | [`Message::Heartbeat`] | never: that it arrived is what counts |
//! | SET_ATTITUDE_TARGET | [`Message::Setpoint`] | see [`setpoint`] |
//! | SET_POSITION_TARGET_LOCAL_NED | [`Message::Goal`] | see [`destination`] |
//! | COMMAND_LONG, COMMAND_INT | [`Message::Arm`] and what else [`Message::command`] has | see [`command`] |
//! | ODOMETRY | [`Message::Pose`] | see [`pose`] |
//! | SETUP_SIGNING | a [`SigningKey`] | its stamp has more than 48 bits |
//!
//! What names a target is refused for every system (0), and passed over where it is for others.
//!
//! The bounds on values are far outside of flight. They are there because finite numbers can
//! be large enough to overflow in the control logic.

use super::framing::RawFrame;
use super::signing::SigningKey;
use super::{
    ARM_DISARM, Answer, ArmCommand, CALIBRATE, COMPONENT, Calibrate, Destination, ExternalPose,
    MOTOR_TEST, Message, STORE, SYSTEM, StoreCommand,
};
use crate::config::LARGEST_DISTANCE;
use crate::control::{MotorTest, Setpoint, Yaw};
use crate::math::{Quaternion, Vec3, wrapped};
use crate::settings::MOST_MOTORS;
use crate::time::micros;
use crate::units::{BodyRates, Position, Thrust, Velocity};
use mavlink::dialects::common::{
    AttitudeTargetTypemask as Mask, COMMAND_INT_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, MavFrame,
    ODOMETRY_DATA, PositionTargetTypemask as PositionMask, SET_ATTITUDE_TARGET_DATA,
    SET_POSITION_TARGET_LOCAL_NED_DATA, SETUP_SIGNING_DATA,
};
use mavlink::{MavlinkVersion, MessageData};

/// Largest body rate accepted, in rad/s: three times the gyroscope's range.
const LARGEST_RATE: f32 = 100.0;

/// Largest speed accepted, in m/s.
const LARGEST_SPEED: f32 = 1000.0;

/// Largest heading accepted, in rad: some senders count from zero to 2 pi.
const LARGEST_HEADING: f32 = core::f32::consts::TAU;

/// Places of ODOMETRY's fields `reset_counter` and `quality`, extensions that older senders leave out.
const ODOMETRY_RESETS: usize = 230;
const ODOMETRY_QUALITY: usize = 232;

/// Second parameter of a command to arm or disarm whatever the checks say.
const FORCE: f32 = 21_196.0;

/// Longest motor test, s, that is no mistake.
const LONGEST_TEST: f32 = 60.0;

/// The fields of a command up to its target.
const COMMAND_LENGTH: usize = 32;

/// What became of a frame whose checksum holds.
pub(super) enum Decoded {
    Message(Message),
    /// A command for us that cannot be done; its number is owed this answer.
    RefusedCommand(u16, Answer),
    /// A key to sign with.
    Key(SigningKey),
    /// No payload.
    Empty,
    /// Addressed to another system or component.
    NotForUs,
    /// A value that is not a number, out of range or not supported; a setpoint for every system.
    Refused,
}

/// Decodes one of the messages used.
pub(super) fn decode(frame: &RawFrame<'_>) -> Decoded {
    let payload = frame.payload;
    if payload.is_empty() {
        return Decoded::Empty;
    }
    let decoded = match frame.id {
        HEARTBEAT_DATA::ID => Some(Decoded::Message(Message::Heartbeat)),
        SET_ATTITUDE_TARGET_DATA::ID => attitude_target(payload),
        SET_POSITION_TARGET_LOCAL_NED_DATA::ID => position_target(payload),
        COMMAND_INT_DATA::ID | COMMAND_LONG_DATA::ID => Some(command(payload)),
        ODOMETRY_DATA::ID => odometry(payload),
        SETUP_SIGNING_DATA::ID => signing_key(payload),
        _ => None,
    };
    decoded.unwrap_or(Decoded::Refused)
}

/// To whom a message is addressed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Target {
    Us,
    /// Every system: too many to be flown by one message. A component 0 of ours is us, many
    /// clients do not ask for more.
    Everyone,
    Others,
}

impl Target {
    fn of(system: u8, component: u8) -> Self {
        match (system, component) {
            (SYSTEM, 0 | COMPONENT) => Self::Us,
            (0, 0 | COMPONENT) => Self::Everyone,
            _ => Self::Others,
        }
    }

    /// What the message becomes, if it is for us and sound.
    fn then(self, decoded: impl FnOnce() -> Option<Decoded>) -> Decoded {
        match self {
            Self::Us => decoded().unwrap_or(Decoded::Refused),
            Self::Everyone => Decoded::Refused,
            Self::Others => Decoded::NotForUs,
        }
    }
}

fn attitude_target(payload: &[u8]) -> Option<Decoded> {
    let target = SET_ATTITUDE_TARGET_DATA::deser(MavlinkVersion::V2, payload).ok()?;
    let to = Target::of(target.target_system, target.target_component);
    Some(to.then(|| Some(Decoded::Message(Message::Setpoint(setpoint(&target)?)))))
}

/// The demand in a SET_ATTITUDE_TARGET; `None` where it is refused.
///
/// Fields that `type_mask` ignores may hold anything. An ignored attitude means that rates
/// alone are flown; ignored rates are zero. A yaw rate that is not ignored frees the heading,
/// otherwise the attitude's heading is held, as PX4 and ArduPilot do.
///
/// Refused: a thrust that is ignored, as by ArduPilot, because there is no other source of
/// thrust; a thrust given as a vector (extension `thrust_body`); a mask that ignores the
/// attitude and all rates; thrust outside 0 to 1; a quaternion that is not of unit length;
/// rates beyond 100 rad/s.
fn setpoint(target: &SET_ATTITUDE_TARGET_DATA) -> Option<Setpoint> {
    let ignores = |what: Mask| target.type_mask.contains(what);
    let rate = |ignored: Mask, value: f32| if ignores(ignored) { 0.0 } else { value };
    let no_attitude = ignores(Mask::ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE);
    let no_roll = Mask::ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE;
    let no_pitch = Mask::ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE;
    let no_yaw = Mask::ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE;
    if ignores(Mask::ATTITUDE_TARGET_TYPEMASK_THROTTLE_IGNORE)
        || ignores(Mask::ATTITUDE_TARGET_TYPEMASK_THRUST_BODY_SET)
        || (no_attitude && ignores(no_roll | no_pitch | no_yaw))
    {
        return None;
    }
    let attitude = if no_attitude {
        None
    } else {
        Some(Quaternion::from_array(target.q)?)
    };
    let rates = Vec3::new(
        rate(no_roll, target.body_roll_rate),
        rate(no_pitch, target.body_pitch_rate),
        rate(no_yaw, target.body_yaw_rate),
    );
    // Without an attitude there is no heading to hold.
    let heading_held = ignores(no_yaw) && !no_attitude;
    Some(Setpoint {
        attitude,
        rates: BodyRates(within(rates, LARGEST_RATE)?),
        yaw: if heading_held {
            Yaw::Heading
        } else {
            Yaw::Rate
        },
        thrust: Thrust::new(target.thrust)?,
    })
}

fn position_target(payload: &[u8]) -> Option<Decoded> {
    let target = SET_POSITION_TARGET_LOCAL_NED_DATA::deser(MavlinkVersion::V2, payload).ok()?;
    let to = Target::of(target.target_system, target.target_component);
    Some(to.then(|| Some(Decoded::Message(Message::Goal(destination(&target)?)))))
}

/// The place in a SET_POSITION_TARGET_LOCAL_NED; `None` where it is refused.
///
/// `type_mask` must ignore accelerations and yaw rate, and may ignore the three velocities
/// together, for a place that does not move, and the yaw, for a heading that is kept. Fields
/// that are ignored may hold anything, and accelerations be called forces; a yaw is wrapped to
/// within -pi to pi.
///
/// Refused: every other mask (a position or a single velocity left out, accelerations,
/// a yaw rate); `coordinate_frame` other than MAV_FRAME_LOCAL_NED; a position, velocity or yaw
/// that is not a number or beyond [`LARGEST_DISTANCE`], 1000 m/s or 2 pi.
fn destination(target: &SET_POSITION_TARGET_LOCAL_NED_DATA) -> Option<Destination> {
    let always = PositionMask::POSITION_TARGET_TYPEMASK_AX_IGNORE
        | PositionMask::POSITION_TARGET_TYPEMASK_AY_IGNORE
        | PositionMask::POSITION_TARGET_TYPEMASK_AZ_IGNORE
        | PositionMask::POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE;
    let no_velocity = PositionMask::POSITION_TARGET_TYPEMASK_VX_IGNORE
        | PositionMask::POSITION_TARGET_TYPEMASK_VY_IGNORE
        | PositionMask::POSITION_TARGET_TYPEMASK_VZ_IGNORE;
    let no_yaw = PositionMask::POSITION_TARGET_TYPEMASK_YAW_IGNORE;
    let moves = !target.type_mask.contains(no_velocity);
    let turns = !target.type_mask.contains(no_yaw);
    let mut expected = always;
    expected.set(no_velocity, !moves);
    expected.set(no_yaw, !turns);
    // Whether what is ignored would be a force or an acceleration says nothing.
    let mask = target.type_mask - PositionMask::POSITION_TARGET_TYPEMASK_FORCE_SET;
    if mask != expected || target.coordinate_frame != MavFrame::MAV_FRAME_LOCAL_NED {
        return None;
    }
    let position = Vec3::new(target.x, target.y, target.z);
    let velocity = if moves {
        within(Vec3::new(target.vx, target.vy, target.vz), LARGEST_SPEED)?
    } else {
        Vec3::ZERO
    };
    let heading = if turns {
        let inside = target.yaw.abs() <= LARGEST_HEADING;
        Some(inside.then(|| wrapped(target.yaw))?)
    } else {
        None
    };
    Some(Destination {
        position: Position(within(position, LARGEST_DISTANCE)?),
        velocity: Velocity(velocity),
        heading,
    })
}

/// Reads a COMMAND_LONG or a COMMAND_INT field by field: what is used of them has the same place.
///
/// The crate's own reading refuses commands that its enumeration lacks, but those are owed an
/// answer as well. Arming takes 0 or 1, and [`FORCE`] or anything else behind it.
fn command(payload: &[u8]) -> Decoded {
    let mut fields = [0; COMMAND_LENGTH];
    // Trailing zeros are not sent.
    for (field, sent) in fields.iter_mut().zip(payload) {
        *field = *sent;
    }
    let [
        p0,
        p1,
        p2,
        p3,
        q0,
        q1,
        q2,
        q3,
        ..,
        low,
        high,
        system,
        component,
    ] = fields;
    let number = u16::from_le_bytes([low, high]);
    let arm = f32::from_le_bytes([p0, p1, p2, p3]);
    let to = Target::of(system, component);
    let force = f32::from_le_bytes([q0, q1, q2, q3]) == FORCE;
    match (number, arm) {
        _ if to == Target::Others => Decoded::NotForUs,
        _ if to == Target::Everyone => Decoded::RefusedCommand(number, Answer::Denied),
        (ARM_DISARM, 0.0 | 1.0) => Decoded::Message(Message::Arm(ArmCommand {
            arm: arm == 1.0,
            force,
        })),
        (ARM_DISARM, _) => Decoded::RefusedCommand(number, Answer::Denied),
        (MOTOR_TEST, motor) => motor_test(motor, &fields)
            .map_or(Decoded::RefusedCommand(number, Answer::Denied), |test| {
                Decoded::Message(Message::TestMotor(test))
            }),
        (CALIBRATE, _) => calibration(&fields)
            .map_or(Decoded::RefusedCommand(number, Answer::Denied), |what| {
                Decoded::Message(Message::Calibrate(what))
            }),
        (STORE, 1.0) => Decoded::Message(Message::Store(StoreCommand::Save)),
        (STORE, 2.0) => Decoded::Message(Message::Store(StoreCommand::Reset)),
        (STORE, _) => Decoded::RefusedCommand(number, Answer::Denied),
        _ => Decoded::RefusedCommand(number, Answer::Unsupported),
    }
}

/// What a MAV_CMD_PREFLIGHT_CALIBRATION asks for: `param1` 1, the gyroscope, or `param5` 2, level, and
/// nothing else. A COMMAND_INT has a whole number in the fifth place.
fn calibration(fields: &[u8; COMMAND_LENGTH]) -> Option<Calibrate> {
    let (parameters, _) = fields.split_first_chunk::<{ 4 * 7 }>()?;
    let (parameters, _) = parameters.as_chunks::<4>();
    let asked = |place: usize, words: &[[u8; 4]]| {
        let others = parameters.iter().enumerate();
        let mut others = others.filter(|(other, _)| *other != place);
        // Some clients leave what they do not use as no number.
        let unused =
            |word: &[u8; 4]| matches!(f32::from_le_bytes(*word), n if n == 0.0 || n.is_nan());
        parameters
            .get(place)
            .is_some_and(|word| words.contains(word))
            && others.all(|(_, word)| unused(word))
    };
    if asked(0, &[1_f32.to_le_bytes()]) {
        return Some(Calibrate::Gyroscope);
    }
    asked(4, &[2_f32.to_le_bytes(), 2_i32.to_le_bytes()]).then_some(Calibrate::Level)
}

/// The test in a MAV_CMD_DO_MOTOR_TEST; `None` where it is refused.
///
/// `param1` is the motor's number in the airframe, from 1; `param2` 0, for a throttle in percent;
/// `param3` the throttle; `param4` for how long, in s. One motor at a time: `param5` is 0 or 1.
fn motor_test(number: f32, fields: &[u8; COMMAND_LENGTH]) -> Option<MotorTest> {
    let parameter = |place: usize| {
        let bytes = fields.get(4 * place..4 * place + 4)?;
        Some(f32::from_le_bytes(bytes.try_into().ok()?))
    };
    let (kind, percent, length_s) = (parameter(1)?, parameter(2)?, parameter(3)?);
    let one_motor = (1.0..=MOST_MOTORS as f32).contains(&number) && parameter(4)? <= 1.0;
    let sound = (0.0..=100.0).contains(&percent) && (0.0..=LONGEST_TEST).contains(&length_s);
    (one_motor && kind == 0.0 && sound).then(|| MotorTest {
        motor: number as u8 - 1,
        share: percent * 0.01,
        length: micros((length_s * 1e6) as u64),
    })
}

/// The key in a SETUP_SIGNING; whether it may be set is not to be told from the frame.
fn signing_key(payload: &[u8]) -> Option<Decoded> {
    let setup = SETUP_SIGNING_DATA::deser(MavlinkVersion::V2, payload).ok()?;
    let to = Target::of(setup.target_system, setup.target_component);
    let key = || SigningKey::new(setup.secret_key, setup.initial_timestamp);
    Some(to.then(|| key().map(Decoded::Key)))
}

fn odometry(payload: &[u8]) -> Option<Decoded> {
    let extension = |place: usize| payload.get(place).copied().unwrap_or(0);
    if i8::from_le_bytes([extension(ODOMETRY_QUALITY)]) < 0 {
        return None;
    }
    let odometry = ODOMETRY_DATA::deser(MavlinkVersion::V2, payload).ok()?;
    Some(Decoded::Message(Message::Pose(pose(
        &odometry,
        extension(ODOMETRY_RESETS),
    )?)))
}

/// The pose in an ODOMETRY; `None` where it is refused.
///
/// `frame_id` is MAV_FRAME_LOCAL_NED, or MAV_FRAME_LOCAL_FRD for a local frame whose x axis
/// points anywhere; it becomes the drone's local frame. `child_frame_id` names the axes of the
/// velocity: the same frame, or MAV_FRAME_BODY_FRD, which is turned into the local frame by the
/// attitude. The attitude `q` turns body axes into local axes; its first element not a number
/// says that there is none. Covariances and angular speeds are not used.
///
/// Refused: other frames (the ENU and FLU of ROS among them); a velocity in body axes without
/// an attitude; a position or velocity that is not a number or beyond [`LARGEST_DISTANCE`] or 1000 m/s; a
/// quaternion that is not of unit length; a `quality` below zero (the estimator has failed).
fn pose(odometry: &ODOMETRY_DATA, reset_counter: u8) -> Option<ExternalPose> {
    let attitude = match odometry.q {
        [w, ..] if w.is_nan() => None,
        q => Some(Quaternion::from_array(q)?),
    };
    let position = Vec3::new(odometry.x, odometry.y, odometry.z);
    let position = within(position, LARGEST_DISTANCE)?;
    let velocity = Vec3::new(odometry.vx, odometry.vy, odometry.vz);
    let velocity = within(velocity, LARGEST_SPEED)?;
    let velocity = match (odometry.frame_id, odometry.child_frame_id) {
        (MavFrame::MAV_FRAME_LOCAL_NED, MavFrame::MAV_FRAME_LOCAL_NED)
        | (MavFrame::MAV_FRAME_LOCAL_FRD, MavFrame::MAV_FRAME_LOCAL_FRD) => velocity,
        (
            MavFrame::MAV_FRAME_LOCAL_NED | MavFrame::MAV_FRAME_LOCAL_FRD,
            MavFrame::MAV_FRAME_BODY_FRD,
        ) => attitude?.to_earth(velocity),
        _ => return None,
    };
    Some(ExternalPose {
        position: Position(position),
        velocity: Velocity(velocity),
        attitude,
        reset_counter,
    })
}

/// The vector, where every axis is a number within the bound.
fn within(vector: Vec3, bound: f32) -> Option<Vec3> {
    let inside = |value: f32| (-bound..=bound).contains(&value);
    (inside(vector.x) && inside(vector.y) && inside(vector.z)).then_some(vector)
}
