//! The far end of the link: a ground station with exact timing.
//!
//! Frames start at their scheduled instant and their bytes follow each other
//! without a gap, at the rate the firmware has programmed.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rigless::chip::{Timeline, uart};
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;

use crate::LinkUse;

/// What the two directions of the link carry.
#[derive(Debug, Default)]
struct Wire {
    frames: VecDeque<(u64, VecDeque<u8>)>,
    heard: Vec<(u64, u8)>,
    listening: bool,
    used: LinkUse,
}

/// The link, shared between the part's serial port and the run loop.
#[derive(Clone, Debug, Default)]
pub(super) struct Link(Arc<Mutex<Wire>>);

impl Link {
    fn wire(&self) -> MutexGuard<'_, Wire> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Schedules a frame to the firmware.
    pub(super) fn schedule(&self, at_ns: u64, bytes: Vec<u8>) {
        if !bytes.is_empty() {
            self.wire().frames.push_back((at_ns, bytes.into()));
        }
    }

    /// When the next frame begins; `u64::MAX` without one.
    pub(super) fn next_start(&self) -> u64 {
        self.wire().frames.front().map_or(u64::MAX, |frame| frame.0)
    }

    /// Takes the bytes heard from the firmware, each with its instant.
    pub(super) fn take_heard(&self) -> Vec<(u64, u8)> {
        std::mem::take(&mut self.wire().heard)
    }

    /// Bytes that crossed so far.
    pub(super) fn used(&self) -> LinkUse {
        let wire = self.wire();
        let waiting = wire.frames.iter().map(|frame| frame.1.len() as u64).sum();
        LinkUse {
            waiting,
            ..wire.used
        }
    }
}

impl Store for Link {}

impl uart::Peer for Link {
    fn receive(&mut self, word: u16, context: &mut Timeline<'_, '_>) {
        let mut wire = self.wire();
        wire.used.sent += 1;
        wire.heard.push((context.now().0, word as u8));
    }

    /// Asked whenever the firmware's receiver is enabled and free.
    fn transmit(&mut self, now: VirtualNanos) -> Option<u16> {
        let mut wire = self.wire();
        if !std::mem::replace(&mut wire.listening, true) {
            wire.lose_before(now.0);
        }
        let frame = wire.frames.front_mut().filter(|frame| frame.0 <= now.0)?;
        let byte = frame.1.pop_front();
        if frame.1.is_empty() {
            wire.frames.pop_front();
        }
        wire.used.received += 1;
        byte.map(u16::from)
    }
}

impl Wire {
    /// A ground station does not wait for a receiver that is not there yet.
    fn lose_before(&mut self, now_ns: u64) {
        while self.frames.front().is_some_and(|frame| frame.0 < now_ns) {
            let lost = self.frames.pop_front().map_or(0, |frame| frame.1.len());
            self.used.lost += lost as u64;
        }
    }
}
