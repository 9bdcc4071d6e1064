//! The autopilot under random calls: sound commands, motors stand unless armed.
//!
//! An input is read as a list of steps: most let it fly on, others make calls that no board would make.

use arbitrary::{Result, Unstructured};
use clap::ValueEnum;
use reflex::app::{ChipAction, ChipOrder, ChipSetting, Fault, OrderError, StoreEvent};
use reflex::battery::BatteryReading;
use reflex::config::SETTINGS;
use reflex::control::{MotorTest, Setpoint, Yaw};
use reflex::link::{ArmCommand, Calibrate, Destination, ExternalPose, Message, StoreCommand};
use reflex::math::{Quaternion, Vec3};
use reflex::reactive::{Column, Feature, Fit, Logistic, Refit};
use reflex::reset::{Reset, ResetCause};
use reflex::sensors::{Cause, ChipSample, ImuReading, Input};
use reflex::settings::{Policy, Settings};
use reflex::store::{Found, NotSaved};
use reflex::time::micros;
use reflex::units::{BodyRates, Position, SpecificForce, Thrust, Velocity};

use super::flyer::Flyer;
use super::spoil::some;
use super::{Loaded, Source, Target};
use crate::logics::{LogicName, Start};

pub(super) const AUTOPILOT: Target = Target {
    name: "autopilot",
    reads: "calls of the autopilot in any order",
    inputs: 4_000,
    load: || {
        Ok(Loaded::new(Source::Made(steps), |input| {
            fly(&mut Unstructured::new(input)).is_ok()
        }))
    },
};

fn steps(from: &mut Unstructured<'_>) -> Result<Vec<u8>> {
    Ok(some(from, 8..=600)?.to_vec())
}

/// No stamp of a board is later: half a million years.
const LATEST: u64 = 1 << 62;

/// Numbers that are hard to bear.
const ENDS: [f32; 14] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1e-45,
    1e30,
    -1e30,
    16_777_216.0,
];

fn fly(from: &mut Unstructured<'_>) -> Result<()> {
    let logic = *from.choose(LogicName::value_variants())?;
    let policy = *from.choose(&[Policy::Reactive, Policy::Reactive, Policy::Periodic])?;
    let settings = Settings { policy, ..SETTINGS };
    let mut flyer = Flyer::new(&Start::configured(settings, logic.gains()));
    if from.ratio(4, 5)? {
        flyer.take_off();
    }
    while !from.is_empty() {
        step(&mut flyer, from)?;
    }
    flyer.pass(300, 1.0);
    Ok(())
}

fn step(flyer: &mut Flyer, from: &mut Unstructured<'_>) -> Result<()> {
    match from.int_in_range(0..=19)? {
        0..=5 => {
            let noise = *from.choose(&[1.0, 1.0, 10.0, 1000.0, 0.0])?;
            flyer.pass(from.int_in_range(1..=120)?, noise);
        }
        6 => {
            let reading = reading(from)?;
            flyer.sense(&reading);
        }
        7 => {
            let jump = *from.choose(&[
                0,
                1,
                999,
                21_000,
                3_000_000,
                1 << 31,
                1 << 32,
                1 << 40,
                LATEST,
            ])?;
            flyer.now = if from.ratio(1, 3)? {
                flyer.now.saturating_sub(jump)
            } else {
                (flyer.now + jump).min(LATEST)
            };
        }
        8..=12 => {
            let message = message(from)?;
            flyer.tell(&message);
        }
        13 => flyer.end_hyperperiod(),
        14 => {
            let output = flyer.autopilot.on_timer(flyer.at());
            flyer.write(output);
        }
        15 => sample(flyer, from)?,
        16 => order(flyer, from)?,
        17 => taught(flyer, from)?,
        18 => {
            let fault = *from.choose(&Fault::ALL)?;
            flyer.autopilot.on_fault(flyer.at(), fault);
        }
        _ => found(flyer, from)?,
    }
    Ok(())
}

/// A sample of a chip that nobody asked for.
fn sample(flyer: &mut Flyer, from: &mut Unstructured<'_>) -> Result<()> {
    let sample = ChipSample {
        input: *from.choose(&Input::OF_CHIPS)?,
        axes: vector(from)?,
        cause: cause(from)?,
    };
    let next = flyer.autopilot.on_chip(flyer.at(), &sample);
    flyer.follow(next);
    Ok(())
}

/// What a board may find of its battery, its start and its store.
fn found(flyer: &mut Flyer, from: &mut Unstructured<'_>) -> Result<()> {
    let reading = BatteryReading {
        volts: number(from)?,
        amps: number(from)?,
    };
    flyer.autopilot.on_battery(flyer.at(), &reading);
    let reset = Reset {
        cause: *from.choose(&ResetCause::ALL)?,
        brown_out_mv: from.arbitrary()?,
        last_words: None,
    };
    flyer.autopilot.on_reset(flyer.at(), &reset);
    let events = [
        StoreEvent::Found(*from.choose(&Found::ALL)?),
        StoreEvent::KeyDue,
        StoreEvent::Begun,
        StoreEvent::Saved,
        StoreEvent::NotSaved(NotSaved::Flash),
    ];
    flyer.autopilot.on_store(flyer.at(), *from.choose(&events)?);
    Ok(())
}

/// A chip's order that nobody gave, or that came out in another way.
fn order(flyer: &mut Flyer, from: &mut Unstructured<'_>) -> Result<()> {
    let order = ChipOrder {
        input: *from.choose(&Input::OF_CHIPS)?,
        action: match from.int_in_range(0..=4)? {
            0 => ChipAction::DataReady,
            1 => ChipAction::Threshold(number(from)?),
            2 => ChipAction::Rearm,
            3 => ChipAction::Heartbeat,
            _ => ChipAction::Read,
        },
    };
    let result = match from.int_in_range(0..=3)? {
        0 => Ok(ChipSetting::EverySample),
        1 => Ok(ChipSetting::PastThreshold {
            level: number(from)?,
            from: number(from)?,
            next: number(from)?,
        }),
        2 => Err(OrderError::Bus),
        _ => Err(OrderError::ReadBack {
            register: from.arbitrary()?,
            wrote: 0,
            read: 1,
        }),
    };
    flyer.autopilot.on_order_done(flyer.at(), order, result);
    Ok(())
}

/// Models and slopes that nobody learned.
fn taught(flyer: &mut Flyer, from: &mut Unstructured<'_>) -> Result<()> {
    let at = flyer.at();
    if from.arbitrary()? {
        let fit = match from.int_in_range(0..=2)? {
            0 => Fit::Unfit,
            1 => Fit::Irrelevant,
            _ => Fit::Model(Logistic {
                b1: number(from)?,
                b2: number(from)?,
            }),
        };
        let input = *from.choose(&Input::ALL)?;
        flyer.autopilot.on_refit(at, Refit { input, fit });
    } else {
        let mut column = Column {
            feature: *from.choose(&Feature::ALL)?,
            of_axes: [0.0; 4],
        };
        for value in &mut column.of_axes {
            *value = number(from)?;
        }
        flyer.autopilot.on_column(at, column);
        flyer.autopilot.on_sounded(at);
    }
    Ok(())
}

fn message(from: &mut Unstructured<'_>) -> Result<Message> {
    Ok(match from.int_in_range(0..=11)? {
        0 => Message::Heartbeat,
        1..=3 => Message::Setpoint(Setpoint {
            attitude: attitude(from)?,
            rates: BodyRates(vector(from)?),
            yaw: if from.arbitrary()? {
                Yaw::Rate
            } else {
                Yaw::Heading
            },
            thrust: Thrust::new(from.int_in_range(0..=100)? as f32 / 100.0).unwrap_or(Thrust::ZERO),
        }),
        4 => Message::Arm(ArmCommand {
            arm: from.arbitrary()?,
            force: from.arbitrary()?,
        }),
        5 => Message::Arm(ArmCommand::ARM),
        6 | 7 => Message::Pose(ExternalPose {
            position: Position(vector(from)?),
            velocity: Velocity(vector(from)?),
            attitude: attitude(from)?,
            reset_counter: from.int_in_range(0..=2)?,
        }),
        8 => Message::Goal(Destination {
            position: Position(vector(from)?),
            velocity: Velocity(vector(from)?),
            heading: if from.arbitrary()? {
                Some(number(from)?)
            } else {
                None
            },
        }),
        9 => Message::Calibrate(*from.choose(&Calibrate::ALL)?),
        10 => Message::Store(*from.choose(&StoreCommand::ALL)?),
        _ => Message::TestMotor(MotorTest {
            motor: from.arbitrary()?,
            share: number(from)?,
            length: micros(from.arbitrary()?),
        }),
    })
}

fn reading(from: &mut Unstructured<'_>) -> Result<ImuReading> {
    Ok(ImuReading {
        rates: BodyRates(vector(from)?),
        force: SpecificForce(vector(from)?),
        temperature: number(from)?,
    })
}

fn attitude(from: &mut Unstructured<'_>) -> Result<Option<Quaternion>> {
    let (w, v) = (number(from)?, vector(from)?);
    // As the link does it: what has no length is no attitude.
    Ok(Quaternion::from_array([w, v.x, v.y, v.z]))
}

fn vector(from: &mut Unstructured<'_>) -> Result<Vec3> {
    Ok(Vec3::new(number(from)?, number(from)?, number(from)?))
}

/// Mostly a number of flight, now and then one that is hard to bear.
fn number(from: &mut Unstructured<'_>) -> Result<f32> {
    Ok(match from.int_in_range(0..=15)? {
        0 => *from.choose(&ENDS)?,
        1 => f32::from_bits(from.arbitrary()?),
        _ => f32::from(from.arbitrary::<i16>()?) / 2000.0,
    })
}

fn cause(from: &mut Unstructured<'_>) -> Result<Cause> {
    Ok(Cause::from_number(from.int_in_range(0..=3)?).unwrap_or(Cause::Heartbeat))
}
