//! Every call that enters the autopilot, as a value and as bytes.
//!
//! One recorder serves replay, equality of the two tiers, fault hunting and flight records:
//! the same calls with the same stamps give the same bits on any machine. In memory the calls
//! go to a ring that overwrites its oldest bytes; a reader that polls often enough misses none
//! and can tell when it did.
//!
//! A record is a kind, the stamp in microseconds (8 bytes) and the fields, little-endian.

use super::{Autopilot, ChipOrder, ChipSetting, Fault, OrderError, Reason, StoreEvent};
use crate::airframe::MotorShares;
use crate::battery::BatteryReading;
use crate::graph::ControlLogic;
use crate::link::Message;
use crate::reactive::{Column, Feature, Fit, Label, Refit};
use crate::reset::{LastWords, Reset, ResetCause};
use crate::sensors::{ChipSample, ImuReading, Input, Inputs};
use crate::time::{Instant, at_micros};

mod codec;
mod ring;

use codec::{Decoder, Encoder};
pub use ring::{CallRing, RING_LENGTH};

/// The longest record in bytes.
pub const LONGEST_RECORD: usize = 80;

/// One call, or what a run came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Call {
    /// `on_imu`
    Imu(ImuReading),
    /// `on_chip`
    Chip(ChipSample),
    /// `on_message`
    Message(Message),
    /// `on_fault`
    Fault(Fault),
    /// `on_hyperperiod`
    Hyperperiod,
    /// `on_timer`
    Timer,
    /// `on_order_done`
    OrderDone(ChipOrder, Result<ChipSetting, OrderError>),
    /// `on_refit`
    Refit(Refit),
    /// `on_column`
    Column(Column),
    /// `on_sounded`
    Sounded,
    /// `on_reset`
    Reset(Reset),
    /// `on_battery`
    Battery(BatteryReading),
    /// `on_store`
    Store(StoreEvent),
    /// Not a call: what a run came to.
    Ran(Ran),
    /// Not a call: whether the last run was changed.
    Judged(bool),
}

/// The outcome of a run, recorded behind the call that caused it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ran {
    /// Why it happened.
    pub reason: Reason,
    /// Inputs whose changes asked for it.
    pub asked: Inputs,
    /// The largest probability of a changed command by a model that asked; `None` without one.
    pub expected: Option<f32>,
    /// The motor command it applied, as shares of full scale.
    pub shares: MotorShares,
}

/// A call with the instant it carried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamped {
    /// The call's time argument.
    pub at: Instant,
    /// The call.
    pub call: Call,
}

/// Takes note of every call.
pub trait Recorder {
    /// Takes note of a call with its stamp.
    fn record(&mut self, at: Instant, call: &Call);

    /// Takes note of a label that an input learns from; only a host looks at single labels.
    fn label(&mut self, _input: Input, _label: &Label) {}
}

/// Records nothing: for sweeps.
impl Recorder for () {
    fn record(&mut self, _at: Instant, _call: &Call) {}
}

impl<R: Recorder + ?Sized> Recorder for &mut R {
    #[inline(always)]
    fn record(&mut self, at: Instant, call: &Call) {
        (**self).record(at, call);
    }

    fn label(&mut self, input: Input, label: &Label) {
        (**self).label(input, label);
    }
}

/// Why bytes are not a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecodeError {
    /// More bytes are needed.
    Incomplete,
    /// The kind or a field's number means nothing.
    Unknown(u8),
}

impl Stamped {
    /// Writes the record and returns it as a slice of `buffer`.
    ///
    /// Inlined, with all that leads to it: where a call is made its kind is known.
    #[inline(always)]
    pub fn encode<'b>(&self, buffer: &'b mut [u8; LONGEST_RECORD]) -> &'b [u8] {
        let mut out = Encoder::new(buffer);
        out.byte(kind(&self.call));
        out.put(self.at.ticks().to_le_bytes());
        match &self.call {
            Call::Imu(reading) => out.reading(reading),
            Call::Chip(sample) => {
                out.byte(sample.input as u8);
                out.vector(sample.axes);
                out.byte(sample.cause as u8);
            }
            Call::Message(message) => out.message(message),
            Call::Fault(fault) => out.byte(fault.number()),
            Call::Hyperperiod | Call::Timer | Call::Sounded => {}
            Call::OrderDone(order, result) => {
                out.order(order);
                out.result(result);
            }
            Call::Refit(refit) => out.refit(refit),
            Call::Column(column) => {
                out.byte(column.feature as u8);
                out.floats(column.of_axes);
            }
            Call::Ran(ran) => {
                out.put([ran.reason as u8, ran.asked.bits()]);
                // No probability is not a number.
                out.float(ran.expected.unwrap_or(f32::NAN));
                out.shares(&ran.shares);
            }
            Call::Reset(reset) => out.reset(reset),
            Call::Battery(reading) => out.floats([reading.volts, reading.amps]),
            Call::Store(event) => out.store(event),
            Call::Judged(changed) => out.byte(u8::from(*changed)),
        }
        out.finish()
    }

    /// Reads one record from the front of `bytes`; also says how long it was.
    ///
    /// # Errors
    /// [`DecodeError::Incomplete`] where bytes are missing, [`DecodeError::Unknown`] where
    /// they mean nothing.
    pub fn decode(bytes: &[u8]) -> Result<(Self, usize), DecodeError> {
        let mut from = Decoder::new(bytes);
        let kind = from.byte()?;
        let at = at_micros(u64::from_le_bytes(from.take()?));
        let call = match kind {
            1 => Call::Imu(from.reading()?),
            2 => Call::Chip(ChipSample {
                input: from.choice(Input::from_number)?,
                axes: from.vector()?,
                cause: from.cause()?,
            }),
            3 => Call::Message(from.message()?),
            4 => Call::Fault(from.choice(Fault::from_number)?),
            5 => Call::Hyperperiod,
            6 => Call::Timer,
            7 => Call::OrderDone(from.order()?, from.result()?),
            8 => Call::Refit(from.refit()?),
            9 => Call::Ran(Ran {
                reason: from.choice(Reason::from_number)?,
                asked: Inputs::from_bits(from.byte()?),
                expected: Some(from.float()?).filter(|expected| !expected.is_nan()),
                shares: from.shares()?,
            }),
            10 => Call::Column(Column {
                feature: from.choice(Feature::from_number)?,
                of_axes: from.floats()?,
            }),
            11 => Call::Judged(from.byte()? != 0),
            12 => Call::Sounded,
            13 => Call::Reset(from.reset()?),
            14 => {
                let [volts, amps] = from.floats()?;
                Call::Battery(BatteryReading { volts, amps })
            }
            15 => Call::Store(from.store()?),
            other => return Err(DecodeError::Unknown(other)),
        };
        Ok((Self { at, call }, bytes.len() - from.rest()))
    }
}

impl Call {
    /// Makes the call on an autopilot; a run's outcome is no call and does nothing.
    pub fn replay<R: Recorder, L: ControlLogic>(
        &self,
        at: Instant,
        autopilot: &mut Autopilot<R, L>,
    ) {
        match self {
            Self::Imu(reading) => drop(autopilot.on_imu(at, reading)),
            Self::Chip(sample) => drop(autopilot.on_chip(at, sample)),
            Self::Message(message) => drop(autopilot.on_message(at, message)),
            Self::Fault(fault) => autopilot.on_fault(at, *fault),
            Self::Hyperperiod => drop(autopilot.on_hyperperiod(at)),
            Self::Timer => drop(autopilot.on_timer(at)),
            Self::OrderDone(order, result) => autopilot.on_order_done(at, *order, *result),
            Self::Refit(refit) => autopilot.on_refit(at, *refit),
            Self::Column(column) => autopilot.on_column(at, *column),
            Self::Sounded => autopilot.on_sounded(at),
            Self::Reset(reset) => autopilot.on_reset(at, reset),
            Self::Battery(reading) => drop(autopilot.on_battery(at, reading)),
            Self::Store(event) => autopilot.on_store(at, *event),
            Self::Ran(_) | Self::Judged(_) => {}
        }
    }
}

fn kind(call: &Call) -> u8 {
    match call {
        Call::Imu(_) => 1,
        Call::Chip(_) => 2,
        Call::Message(_) => 3,
        Call::Fault(_) => 4,
        Call::Hyperperiod => 5,
        Call::Timer => 6,
        Call::OrderDone(..) => 7,
        Call::Refit(_) => 8,
        Call::Ran(_) => 9,
        Call::Column(_) => 10,
        Call::Judged(_) => 11,
        Call::Sounded => 12,
        Call::Reset(_) => 13,
        Call::Battery(_) => 14,
        Call::Store(_) => 15,
    }
}

impl Encoder<'_> {
    fn reset(&mut self, reset: &Reset) {
        self.byte(reset.cause.number());
        self.put(reset.brown_out_mv.unwrap_or(0).to_le_bytes());
        // Where there are no words, there is no magic.
        self.put(
            reset
                .last_words
                .map_or([0; LastWords::LENGTH], |words| words.to_bytes()),
        );
    }

    fn refit(&mut self, refit: &Refit) {
        self.byte(refit.input as u8);
        match refit.fit {
            Fit::Unfit => self.byte(0),
            Fit::Irrelevant => self.byte(1),
            Fit::Model(model) => {
                self.byte(2);
                self.float(model.b1);
                self.float(model.b2);
            }
        }
    }
}

impl Decoder<'_> {
    fn reset(&mut self) -> Result<Reset, DecodeError> {
        Ok(Reset {
            cause: self.choice(ResetCause::from_number)?,
            brown_out_mv: Some(u16::from_le_bytes(self.take()?)).filter(|mv| *mv > 0),
            last_words: LastWords::from_bytes(&self.take()?),
        })
    }

    fn refit(&mut self) -> Result<Refit, DecodeError> {
        let input = self.choice(Input::from_number)?;
        let fit = match self.byte()? {
            0 => Fit::Unfit,
            1 => Fit::Irrelevant,
            2 => Fit::Model(crate::reactive::Logistic {
                b1: self.float()?,
                b2: self.float()?,
            }),
            other => return Err(DecodeError::Unknown(other)),
        };
        Ok(Refit { input, fit })
    }
}
