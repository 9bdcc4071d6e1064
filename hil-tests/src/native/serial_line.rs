//! The serial line as the drone hears it: frames of given instants, at a rate.

use std::collections::VecDeque;

use crate::ground_station::LinkFrame;
use reflex::tasks::link::{Overrun, Port};

use super::timing::{BOOT_NS, CHARACTER_NS};

/// Frames to come, the one on the line, and the bytes that were received.
#[derive(Debug)]
pub(super) struct SerialLine {
    waiting: VecDeque<LinkFrame>,
    under_way: Option<LinkFrame>,
    /// When the line falls idle behind the frame on it, ns.
    free_ns: u64,
    received: VecDeque<u8>,
}

impl SerialLine {
    /// Frames in order of time.
    pub(super) fn new(frames: Vec<LinkFrame>) -> Self {
        Self {
            waiting: frames.into(),
            under_way: None,
            free_ns: 0,
            received: VecDeque::new(),
        }
    }

    /// Adds a frame behind the others.
    pub(super) fn push(&mut self, frame: LinkFrame) {
        self.waiting.push_back(frame);
    }

    pub(super) fn is_idle(&self) -> bool {
        self.under_way.is_none()
    }

    /// Puts the next frame on the line, and says when its end is noticed, ns. Frames that were
    /// sent before the receiver was there are lost.
    pub(super) fn start_next(&mut self) -> Option<u64> {
        let frame = loop {
            let frame = self.waiting.pop_front()?;
            if frame.at_ns >= BOOT_NS {
                break frame;
            }
        };
        let start_ns = frame.at_ns.max(self.free_ns);
        self.free_ns = start_ns + frame.bytes.len() as u64 * CHARACTER_NS;
        self.under_way = Some(frame);
        // The receiver takes the line for idle after one character more, and says so after another.
        Some(self.free_ns + 2 * CHARACTER_NS)
    }

    /// The frame on the line has been received.
    pub(super) fn receive(&mut self) {
        if let Some(frame) = self.under_way.take() {
            self.received.extend(frame.bytes);
        }
    }
}

impl Port for SerialLine {
    fn take(&mut self, into: &mut [u8]) -> Result<usize, Overrun> {
        let count = self.received.len().min(into.len());
        for (place, byte) in into.iter_mut().zip(self.received.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    /// Nobody listens.
    fn send(&mut self, _: &[u8]) -> Result<(), Overrun> {
        Ok(())
    }
}
