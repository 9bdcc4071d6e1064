//! Fields of a record to bytes and back.

use reflex_settings::bytes;

use super::{DecodeError, LONGEST_RECORD};
use crate::airframe::MotorShares;
use crate::app::{ChipAction, ChipOrder, ChipSetting, OrderError, StoreEvent};
use crate::control::{MotorTest, Setpoint, Yaw};
use crate::link::{ArmCommand, Calibrate, Destination, ExternalPose, Message, StoreCommand};
use crate::math::{Quaternion, Vec3};
use crate::sensors::{Cause, ImuReading, Input};
use crate::settings::MOST_MOTORS;
use crate::store::{Found, NotSaved};
use crate::time::micros;
use crate::units::{BodyRates, Position, SpecificForce, Thrust, Velocity};

pub(super) struct Encoder<'b> {
    buffer: &'b mut [u8; LONGEST_RECORD],
    length: usize,
}

impl<'b> Encoder<'b> {
    pub(super) fn new(buffer: &'b mut [u8; LONGEST_RECORD]) -> Self {
        Self { buffer, length: 0 }
    }

    pub(super) fn put<const N: usize>(&mut self, field: [u8; N]) {
        if let Some(place) = self.buffer.get_mut(self.length..self.length + N) {
            place.copy_from_slice(&field);
            self.length += N;
        }
    }

    pub(super) fn byte(&mut self, byte: u8) {
        self.put([byte]);
    }

    pub(super) fn float(&mut self, value: f32) {
        self.put(value.to_le_bytes());
    }

    /// Several at once: whether there is room is looked at once.
    pub(super) fn floats<const N: usize>(&mut self, values: [f32; N]) {
        let place = self.buffer.get_mut(self.length..self.length + 4 * N);
        let (words, _) = place.unwrap_or_default().as_chunks_mut();
        for (word, value) in words.iter_mut().zip(values) {
            *word = value.to_le_bytes();
            self.length += 4;
        }
    }

    /// How many, then each.
    pub(super) fn shares(&mut self, shares: &MotorShares) {
        self.byte(shares.len() as u8);
        let place = self.buffer.get_mut(self.length..).unwrap_or_default();
        for (word, share) in place.as_chunks_mut().0.iter_mut().zip(shares.iter()) {
            *word = share.to_le_bytes();
            self.length += 4;
        }
    }

    pub(super) fn vector(&mut self, vector: Vec3) {
        self.floats(vector.to_array());
    }

    pub(super) fn reading(&mut self, reading: &ImuReading) {
        let [p, q, r] = reading.rates.0.to_array();
        let [x, y, z] = reading.force.0.to_array();
        self.floats([p, q, r, x, y, z, reading.temperature]);
    }

    fn attitude(&mut self, attitude: Option<Quaternion>) {
        self.byte(u8::from(attitude.is_some()));
        self.floats(attitude.unwrap_or_default().to_array());
    }

    pub(super) fn message(&mut self, message: &Message) {
        match message {
            Message::Heartbeat => self.byte(0),
            Message::Setpoint(setpoint) => {
                self.byte(1);
                self.attitude(setpoint.attitude);
                self.vector(setpoint.rates.0);
                self.byte(u8::from(setpoint.yaw == Yaw::Rate));
                self.float(setpoint.thrust.share());
            }
            Message::Arm(ArmCommand { arm, force }) => {
                self.byte(2);
                self.put([u8::from(*arm), u8::from(*force)]);
            }
            Message::Pose(pose) => {
                self.byte(3);
                self.vector(pose.position.0);
                self.vector(pose.velocity.0);
                self.attitude(pose.attitude);
                self.byte(pose.reset_counter);
            }
            Message::TestMotor(test) => {
                self.byte(5);
                self.byte(test.motor);
                self.float(test.share);
                self.put(test.length.ticks().to_le_bytes());
            }
            Message::Calibrate(what) => self.put([6, what.number()]),
            Message::Store(what) => self.put([7, what.number()]),
            Message::Goal(goal) => {
                self.byte(4);
                self.vector(goal.position.0);
                self.vector(goal.velocity.0);
                self.byte(u8::from(goal.heading.is_some()));
                self.float(goal.heading.unwrap_or_default());
            }
        }
    }

    pub(super) fn store(&mut self, event: &StoreEvent) {
        let (kind, found) = match *event {
            StoreEvent::Found(found) => (0, found.number()),
            StoreEvent::KeyDue => (1, 0),
            StoreEvent::Begun => (2, 0),
            StoreEvent::Saved => (3, 0),
            StoreEvent::NotSaved(NotSaved::Flash) => (4, 0),
            StoreEvent::NotSaved(NotSaved::NoRoom) => (5, 0),
        };
        self.put([kind, found]);
    }

    pub(super) fn order(&mut self, order: &ChipOrder) {
        self.byte(order.input as u8);
        match order.action {
            ChipAction::DataReady => self.byte(0),
            ChipAction::Threshold(change) => {
                self.byte(1);
                self.float(change);
            }
            ChipAction::Rearm => self.byte(2),
            ChipAction::Heartbeat => self.byte(3),
            ChipAction::Read => self.byte(4),
        }
    }

    pub(super) fn result(&mut self, result: &Result<ChipSetting, OrderError>) {
        match *result {
            Ok(ChipSetting::EverySample) => self.byte(0),
            Ok(ChipSetting::PastThreshold { level, from, next }) => {
                self.byte(1);
                self.floats([level, from, next]);
            }
            Err(OrderError::Bus) => self.byte(2),
            Err(OrderError::Identity) => self.byte(3),
            Err(OrderError::ReadBack {
                register,
                wrote,
                read,
            }) => {
                self.byte(4);
                self.put([register, wrote, read]);
            }
        }
    }

    pub(super) fn finish(self) -> &'b [u8] {
        self.buffer.get(..self.length).unwrap_or_default()
    }
}

pub(super) struct Decoder<'b> {
    rest: &'b [u8],
}

impl<'b> Decoder<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Bytes that are not read yet.
    pub(super) fn rest(&self) -> usize {
        self.rest.len()
    }

    pub(super) fn take<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        bytes::take(&mut self.rest).ok_or(DecodeError::Incomplete)
    }

    pub(super) fn byte(&mut self) -> Result<u8, DecodeError> {
        let [byte] = self.take()?;
        Ok(byte)
    }

    pub(super) fn float(&mut self) -> Result<f32, DecodeError> {
        Ok(f32::from_le_bytes(self.take()?))
    }

    pub(super) fn choice<T>(&mut self, of: impl Fn(u8) -> Option<T>) -> Result<T, DecodeError> {
        let number = self.byte()?;
        of(number).ok_or(DecodeError::Unknown(number))
    }

    pub(super) fn cause(&mut self) -> Result<Cause, DecodeError> {
        self.choice(Cause::from_number)
    }

    pub(super) fn floats<const N: usize>(&mut self) -> Result<[f32; N], DecodeError> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.float()?;
        }
        Ok(values)
    }

    pub(super) fn shares(&mut self) -> Result<MotorShares, DecodeError> {
        let motors = |count| (usize::from(count) <= MOST_MOTORS).then_some(count);
        let mut shares = MotorShares::all(0.0, self.choice(motors)?.into());
        for share in shares.iter_mut() {
            *share = self.float()?;
        }
        Ok(shares)
    }

    pub(super) fn vector(&mut self) -> Result<Vec3, DecodeError> {
        Ok(Vec3::from_array(self.floats()?))
    }

    pub(super) fn reading(&mut self) -> Result<ImuReading, DecodeError> {
        Ok(ImuReading {
            rates: BodyRates(self.vector()?),
            force: SpecificForce(self.vector()?),
            temperature: self.float()?,
        })
    }

    /// The very bits that were recorded: no scaling, so that a replay is exact.
    fn attitude(&mut self) -> Result<Option<Quaternion>, DecodeError> {
        let given = self.byte()? == 1;
        let attitude = Quaternion {
            w: self.float()?,
            v: self.vector()?,
        };
        Ok(given.then_some(attitude))
    }

    pub(super) fn message(&mut self) -> Result<Message, DecodeError> {
        Ok(match self.byte()? {
            0 => Message::Heartbeat,
            1 => Message::Setpoint(Setpoint {
                attitude: self.attitude()?,
                rates: BodyRates(self.vector()?),
                yaw: if self.byte()? == 1 {
                    Yaw::Rate
                } else {
                    Yaw::Heading
                },
                thrust: Thrust::new(self.float()?).ok_or(DecodeError::Unknown(1))?,
            }),
            2 => Message::Arm(ArmCommand {
                arm: self.byte()? == 1,
                force: self.byte()? == 1,
            }),
            3 => Message::Pose(ExternalPose {
                position: Position(self.vector()?),
                velocity: Velocity(self.vector()?),
                attitude: self.attitude()?,
                reset_counter: self.byte()?,
            }),
            4 => Message::Goal(Destination {
                position: Position(self.vector()?),
                velocity: Velocity(self.vector()?),
                heading: {
                    let given = self.byte()? == 1;
                    let heading = self.float()?;
                    given.then_some(heading)
                },
            }),
            5 => Message::TestMotor(MotorTest {
                motor: self.byte()?,
                share: self.float()?,
                length: micros(u64::from_le_bytes(self.take()?)),
            }),
            6 => Message::Calibrate(self.choice(Calibrate::from_number)?),
            7 => Message::Store(self.choice(StoreCommand::from_number)?),
            other => return Err(DecodeError::Unknown(other)),
        })
    }

    pub(super) fn store(&mut self) -> Result<StoreEvent, DecodeError> {
        let kind = self.byte()?;
        let found = self.choice(Found::from_number)?;
        Ok(match kind {
            0 => StoreEvent::Found(found),
            1 => StoreEvent::KeyDue,
            2 => StoreEvent::Begun,
            3 => StoreEvent::Saved,
            4 => StoreEvent::NotSaved(NotSaved::Flash),
            5 => StoreEvent::NotSaved(NotSaved::NoRoom),
            other => return Err(DecodeError::Unknown(other)),
        })
    }

    pub(super) fn order(&mut self) -> Result<ChipOrder, DecodeError> {
        Ok(ChipOrder {
            input: self.choice(Input::from_number)?,
            action: match self.byte()? {
                0 => ChipAction::DataReady,
                1 => ChipAction::Threshold(self.float()?),
                2 => ChipAction::Rearm,
                3 => ChipAction::Heartbeat,
                4 => ChipAction::Read,
                other => return Err(DecodeError::Unknown(other)),
            },
        })
    }

    pub(super) fn result(&mut self) -> Result<Result<ChipSetting, OrderError>, DecodeError> {
        Ok(match self.byte()? {
            0 => Ok(ChipSetting::EverySample),
            1 => Ok(ChipSetting::PastThreshold {
                level: self.float()?,
                from: self.float()?,
                next: self.float()?,
            }),
            2 => Err(OrderError::Bus),
            3 => Err(OrderError::Identity),
            4 => {
                let [register, wrote, read] = self.take()?;
                Err(OrderError::ReadBack {
                    register,
                    wrote,
                    read,
                })
            }
            other => return Err(DecodeError::Unknown(other)),
        })
    }
}
