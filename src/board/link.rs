//! The link's task: bytes from the port, frames from the bytes, answers back.

use reflex::app::Fault;
use reflex::config::MOTORS;
use reflex::link::{ARM_DISARM, Answer, Incoming, LinkCounters, Message, Parser, Sender, Status};
use reflex::safety::Arming;
use reflex::time::{Duration, Instant, micros};

use crate::board::link_port::LinkPort;

/// Between two heartbeats.
pub const BEAT: Duration = micros(1_000_000);

/// Bytes taken from the ring at once: a setpoint's frame and its like.
const CHUNK: usize = 64;

/// Port, parser and sender of one peer.
pub struct Link {
    port: LinkPort,
    parser: Parser,
    sender: Sender,
    /// What was logged last.
    told: LinkCounters,
}

impl Link {
    /// A link over a started port.
    pub fn new(port: LinkPort) -> Self {
        Self {
            port,
            parser: Parser::new(),
            sender: Sender::new(MOTORS),
            told: LinkCounters::default(),
        }
    }

    /// Takes what came until `at`, hands each message to `deliver` and queues its answers.
    ///
    /// A fault where bytes were lost or a frame was spoilt.
    pub fn receive(
        &mut self,
        at: Instant,
        mut deliver: impl FnMut(&Message) -> Option<Answer>,
    ) -> Option<Fault> {
        let spoilt = self.parser.counters().spoilt();
        let mut chunk = [0; CHUNK];
        loop {
            let Ok(count) = self.port.take(&mut chunk) else {
                return Some(Fault::LinkOverrun);
            };
            if count == 0 {
                let more = self.parser.counters().spoilt() != spoilt;
                return more.then_some(Fault::LinkFrame);
            }
            for incoming in self.parser.feed(at, chunk.get(..count).unwrap_or_default()) {
                let (from, command, answer) = match incoming {
                    Incoming::Message { from, message } => (from, ARM_DISARM, deliver(&message)),
                    Incoming::Refused {
                        from,
                        command,
                        answer,
                    } => (from, command, Some(answer)),
                };
                if let Some(answer) = answer {
                    let frame = self.sender.command_ack(from, command, answer);
                    // No room means a line far too slow: the peer asks again.
                    let _ = self.port.send(frame.as_bytes());
                }
            }
        }
    }

    /// Sends a HEARTBEAT; left out where the line is still busy with earlier ones.
    ///
    /// Also logs what the link counted, where frames were spoilt since the last one.
    pub fn beat(&mut self, arming: Arming) {
        let status = match arming {
            Arming::Calibrating => Status::Calibrating,
            Arming::Disarmed => Status::Standby,
            Arming::Armed => Status::Active,
        };
        let counters = self.parser.counters();
        if counters.spoilt() != self.told.spoilt() {
            defmt::warn!("link: {}", counters);
            self.told = counters;
        }
        let frame = self.sender.heartbeat(arming == Arming::Armed, status);
        let _ = self.port.send(frame.as_bytes());
    }

    /// The end of a block going out.
    pub fn on_sent(&mut self) {
        self.port.on_sent();
    }
}
