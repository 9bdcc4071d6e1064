//! Fields of a record to bytes and back.

use super::{DecodeError, LONGEST_RECORD};
use crate::app::{ChipOrder, OrderError};
use crate::config::MOTORS;
use crate::control::{Setpoint, Yaw};
use crate::link::{Destination, ExternalPose, Message};
use crate::math::{Quaternion, Vec3};
use crate::sensors::Cause;
use crate::units::{BodyRates, Position, Thrust, Velocity};

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

    pub(super) fn counts(&mut self, counts: [i16; 3]) {
        for count in counts {
            self.put(count.to_le_bytes());
        }
    }

    fn vector(&mut self, vector: Vec3) {
        for component in vector.to_array() {
            self.float(component);
        }
    }

    fn attitude(&mut self, attitude: Option<Quaternion>) {
        self.byte(u8::from(attitude.is_some()));
        for component in attitude.unwrap_or_default().to_array() {
            self.float(component);
        }
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
            Message::Arm(arm) => {
                self.byte(2);
                self.byte(u8::from(*arm));
            }
            Message::Pose(pose) => {
                self.byte(3);
                self.vector(pose.position.0);
                self.vector(pose.velocity.0);
                self.attitude(pose.attitude);
            }
            Message::Goal(goal) => {
                self.byte(4);
                self.vector(goal.position.0);
                self.vector(goal.velocity.0);
                self.byte(u8::from(goal.heading.is_some()));
                self.float(goal.heading.unwrap_or_default());
            }
        }
    }

    pub(super) fn order(&mut self, order: &ChipOrder) {
        match order {
            ChipOrder::AccelDataReady => self.byte(0),
            ChipOrder::AccelThreshold(code) => {
                self.byte(1);
                self.byte(*code);
            }
            ChipOrder::AccelRearm => self.byte(2),
            ChipOrder::MagDataReady => self.byte(3),
            ChipOrder::MagThreshold(code) => {
                self.byte(4);
                self.put(code.to_le_bytes());
            }
            ChipOrder::MagRearm => self.byte(5),
            ChipOrder::AccelHeartbeat => self.byte(6),
            ChipOrder::MagHeartbeat => self.byte(7),
        }
    }

    pub(super) fn result(&mut self, result: &Result<(), OrderError>) {
        match result {
            Ok(()) => self.byte(0),
            Err(OrderError::Bus) => self.byte(1),
            Err(OrderError::Identity) => self.byte(2),
            Err(OrderError::ReadBack {
                register,
                wrote,
                read,
            }) => {
                self.byte(3);
                self.put([*register, *wrote, *read]);
            }
        }
    }

    pub(super) fn finish(self) -> &'b [u8] {
        self.buffer.get(..self.length).unwrap_or_default()
    }
}

pub(super) struct Decoder<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Decoder<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    pub(super) fn consumed(&self) -> usize {
        self.at
    }

    pub(super) fn take<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let field = self
            .bytes
            .get(self.at..self.at + N)
            .and_then(|bytes| bytes.try_into().ok())
            .ok_or(DecodeError::Incomplete)?;
        self.at += N;
        Ok(field)
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

    pub(super) fn counts(&mut self) -> Result<[i16; 3], DecodeError> {
        let [a, b, c, d, e, f] = self.take()?;
        Ok([[a, b], [c, d], [e, f]].map(i16::from_le_bytes))
    }

    pub(super) fn shares(&mut self) -> Result<[f32; MOTORS], DecodeError> {
        let mut shares = [0.0; MOTORS];
        for share in &mut shares {
            *share = self.float()?;
        }
        Ok(shares)
    }

    fn vector(&mut self) -> Result<Vec3, DecodeError> {
        Ok(Vec3::new(self.float()?, self.float()?, self.float()?))
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
            2 => Message::Arm(self.byte()? == 1),
            3 => Message::Pose(ExternalPose {
                position: Position(self.vector()?),
                velocity: Velocity(self.vector()?),
                attitude: self.attitude()?,
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
            other => return Err(DecodeError::Unknown(other)),
        })
    }

    pub(super) fn order(&mut self) -> Result<ChipOrder, DecodeError> {
        Ok(match self.byte()? {
            0 => ChipOrder::AccelDataReady,
            1 => ChipOrder::AccelThreshold(self.byte()?),
            2 => ChipOrder::AccelRearm,
            3 => ChipOrder::MagDataReady,
            4 => ChipOrder::MagThreshold(u16::from_le_bytes(self.take()?)),
            5 => ChipOrder::MagRearm,
            6 => ChipOrder::AccelHeartbeat,
            7 => ChipOrder::MagHeartbeat,
            other => return Err(DecodeError::Unknown(other)),
        })
    }

    pub(super) fn result(&mut self) -> Result<Result<(), OrderError>, DecodeError> {
        Ok(match self.byte()? {
            0 => Ok(()),
            1 => Err(OrderError::Bus),
            2 => Err(OrderError::Identity),
            3 => {
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
