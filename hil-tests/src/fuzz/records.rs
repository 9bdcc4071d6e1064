//! What firmware and host tell each other: settings, calls, log, last words.

use std::cell::RefCell;

use arbitrary::{Result as Made, Unstructured};
use clap::ValueEnum;
use emulated_board::FaultKind;
use emulated_board::log::LogDecoder;
use emulated_board::rings::{CALLS_LENGTH, CallLog, RttLog, TargetMemory};
use reflex::app::{DecodeError, LONGEST_RECORD, Stamped};
use reflex::config::SETTINGS as CONFIGURED;
use reflex::reset::LastWords;
use reflex_settings::bytes::CHECKSUM;

use super::flyer::Flyer;
use super::samples::{self, Sample};
use super::spoil::some;
use super::{Loaded, Source, Target};
use crate::firmware::Firmware;
use crate::logics::{LogicName, Start};
use crate::progress::Silent;

pub(super) const SETTINGS: Target = Target {
    name: "settings",
    reads: "the settings block that a host writes to the firmware, and last words",
    inputs: 30_000,
    load: || Ok(Loaded::new(Source::Made(block), check_block)),
};

pub(super) const CALLS: Target = Target {
    name: "calls",
    reads: "call logs, and the autopilot that their calls are made on again",
    inputs: 1_500,
    load: || {
        let logics = LogicName::value_variants().iter();
        let flown = logics.map(|logic| Sample::named(logic.word(), &flown(*logic)));
        Ok(Loaded::new(Source::Spoilt(flown.collect()), check_calls))
    },
};

pub(super) const LOG: Target = Target {
    name: "log",
    reads: "the log and the call log in the firmware's memory",
    inputs: 30_000,
    load: || {
        let firmware = Firmware::build(LogicName::configured(), &mut Silent)?;
        let decoder = RefCell::new(LogDecoder::new(&firmware.bytes)?);
        let check = move |input: &[u8]| check_log(&mut decoder.borrow_mut(), input);
        Ok(Loaded::new(Source::Made(memory), check))
    },
};

/// Bytes of a checksum.
const SUM: usize = 4;

/// A settings block with some fields overwritten; its checksum mostly holds.
fn block(from: &mut Unstructured<'_>) -> Made<Vec<u8>> {
    let logic = *from.choose(LogicName::value_variants())?;
    let mut bytes = Start::configured(CONFIGURED, logic.gains()).to_bytes();
    let fields = bytes.len() / 4;
    for _ in 0..from.int_in_range(0..=4)? {
        let at = 4 * from.int_in_range(0..=fields - 1)?;
        let field: [u8; 4] = match from.int_in_range(0..=5)? {
            0 => [0xFF; 4],
            1 => f32::NAN.to_le_bytes(),
            2 => f32::INFINITY.to_le_bytes(),
            3 => from.arbitrary()?,
            4 => from.int_in_range(0..=9_u32)?.to_le_bytes(),
            _ => (f32::from(from.arbitrary::<i16>()?) / 1000.0).to_le_bytes(),
        };
        bytes[at..at + 4].copy_from_slice(&field);
    }
    if from.ratio(9, 10)? {
        bytes.truncate(bytes.len() - SUM);
        let sum = CHECKSUM.checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
    }
    if from.ratio(1, 20)? {
        let length = from.int_in_range(0..=bytes.len())?;
        bytes.truncate(length);
    }
    Ok(bytes)
}

/// A block that is taken can be flown with.
fn check_block(input: &[u8]) -> bool {
    if let Some(words) = input.first_chunk::<{ LastWords::LENGTH }>()
        && let Some(read) = LastWords::from_bytes(words)
    {
        assert_eq!(read.to_bytes()[..8], words[..8]);
    }
    let logics = LogicName::value_variants().iter();
    let mut taken = logics.filter_map(|logic| logic.start_of(input).ok());
    let Some(start) = taken.next() else {
        return false;
    };
    assert!(taken.next().is_none(), "a block of two control logics");
    assert_eq!(start.to_bytes(), input);
    let mut flyer = Flyer::new(&start);
    flyer.pass(3, 1.0);
    true
}

/// The calls of a short flight.
fn flown(logic: LogicName) -> Vec<u8> {
    let mut flyer = Flyer::new(&Start::configured(CONFIGURED, logic.gains()));
    flyer.take_off();
    flyer.pass(120, 3.0);
    std::mem::take(&mut flyer.autopilot.recorder().0)
}

fn check_calls(input: &[u8]) -> bool {
    let named = samples::name_of(input);
    let Some((logic, mut bytes)) =
        named.and_then(|(name, bytes)| Some((LogicName::from_str(name, false).ok()?, bytes)))
    else {
        return false;
    };
    let mut flyer = Flyer::new(&Start::configured(CONFIGURED, logic.gains()));
    loop {
        match Stamped::decode(bytes) {
            Ok((stamped, length)) => {
                assert!((1..=LONGEST_RECORD).contains(&length), "{stamped:?}");
                stamped.call.replay(stamped.at, &mut flyer.autopilot);
                bytes = &bytes[length..];
            }
            Err(DecodeError::Incomplete) => return bytes.is_empty(),
            Err(DecodeError::Unknown(_)) => return false,
        }
    }
}

/// Memory of a firmware: a ring of calls, the descriptor of its log, and a log.
fn memory(from: &mut Unstructured<'_>) -> Made<Vec<u8>> {
    let mut bytes = match from.ratio(3, 4)? {
        true => head(from)?,
        false => Vec::new(),
    };
    for _ in 0..from.int_in_range(0..=30)? {
        match from.int_in_range(0..=3)? {
            0 => bytes.extend(some(from, 0..=40)?),
            // A frame of some index and arguments, as far as its encoding goes.
            _ => {
                let index = from.int_in_range(0..=700_u16)?.to_le_bytes();
                bytes.extend(encoded(&[&index, some(from, 0..=40)?].concat()));
            }
        }
        bytes.push(0);
    }
    Ok(bytes)
}

/// A count of calls and a descriptor of a log that can be; the log is what follows.
fn head(from: &mut Unstructured<'_>) -> Made<Vec<u8>> {
    const LENGTH: u32 = 48;
    let calls = from.int_in_range(0..=2 * CALLS_LENGTH)?;
    let size = from.int_in_range(1..=1024_u32)?;
    let [write, read] = [
        from.int_in_range(0..=size - 1)?,
        from.int_in_range(0..=size - 1)?,
    ];
    let words = [calls, 0, 0, 0, 0, 0, 0, LENGTH, size, write, read, 0];
    Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
}

/// Bytes without a zero, as defmt writes them: behind each seven a byte that says where zeros were.
fn encoded(bytes: &[u8]) -> Vec<u8> {
    let mut all = Vec::new();
    for group in bytes.chunks(7) {
        let zeros = group.iter().enumerate().filter(|(_, byte)| **byte == 0);
        let zeros = zeros.fold(0_u8, |zeros, (place, _)| zeros | 1 << place);
        all.extend(group.iter().filter(|byte| **byte != 0));
        // Behind a short group the places that are not there count as zeros.
        all.push((zeros | (0x7F << group.len()) & 0x7F).max(1));
    }
    all
}

/// Memory that begins with these bytes, at any address.
struct Memory<'b>(&'b [u8]);

impl TargetMemory for Memory<'_> {
    fn read(&mut self, address: u32, into: &mut [u8]) -> Result<(), FaultKind> {
        let found = (address as usize..).map(|at| self.0.get(at).copied().unwrap_or(0));
        into.iter_mut().zip(found).for_each(|(to, byte)| *to = byte);
        Ok(())
    }

    fn write_word(&mut self, _: u32, _: u32) -> Result<(), FaultKind> {
        Ok(())
    }
}

fn check_log(decoder: &mut LogDecoder, input: &[u8]) -> bool {
    let mut memory = Memory(input);
    let calls = CallLog::new(0).read(&mut memory);
    let log = RttLog::new(0)
        .read(&mut memory)
        .expect("memory is everywhere");
    let (front, back) = input.split_at(input.len() / 2);
    let mut lines = decoder.feed(1, front);
    lines.extend(decoder.feed(2, back));
    lines.extend(decoder.feed(3, &log));
    // The next input begins with no frame open.
    decoder.feed(4, &[0]);
    calls.is_ok() && !lines.is_empty()
}
