//! The link: frames from bytes, messages to the autopilot, answers and heartbeats.

use super::{Board, Lock, follow};
use crate::app::{Autopilot, Fault, Recorder};
use crate::graph::ControlLogic;
use crate::link::{
    ARM_DISARM, Answer, Incoming, LinkCounters, Message, Notice, Parser, Sender, Status,
};
use crate::safety::FlightState;
use crate::time::{Duration, Instant, micros};

/// Between two heartbeats.
pub const BEAT: Duration = micros(1_000_000);

/// Bytes taken from the port at once: a setpoint's frame and its like.
const CHUNK: usize = 64;

/// Bytes were lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overrun;

/// The port that a link uses.
pub trait Port {
    /// Copies what came since the last call into `into`, and says how many bytes that was. Only
    /// where it is full may more wait for the next call.
    ///
    /// # Errors
    /// Bytes were lost; those that wait are dropped.
    fn take(&mut self, into: &mut [u8]) -> Result<usize, Overrun>;

    /// Queues a frame; one that does not fit any more is dropped whole.
    ///
    /// # Errors
    /// The frame was dropped: the serial line is slower than what is to be said.
    fn send(&mut self, frame: &[u8]) -> Result<(), Overrun>;
}

/// Port, parser and sender of one peer.
pub struct Link<P> {
    port: P,
    parser: Parser,
    sender: Sender,
    /// What was returned for the log last.
    logged: LinkCounters,
}

impl<P: Port> Link<P> {
    /// A link over a started port, to a drone of so many motors.
    pub fn new(port: P, motors: usize) -> Self {
        Self {
            port,
            parser: Parser::new(),
            sender: Sender::new(motors),
            logged: LinkCounters::default(),
        }
    }

    /// The port.
    pub fn port(&mut self) -> &mut P {
        &mut self.port
    }

    /// Takes what came until `at`, hands each message to `deliver` and queues its answers.
    ///
    /// A fault where bytes were lost or a frame was spoilt.
    fn receive(
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
                    // No room means a serial line far too slow: the peer asks again.
                    let _ = self.port.send(frame.as_bytes());
                }
            }
            if count < CHUNK {
                let more = self.parser.counters().spoilt() != spoilt;
                return more.then_some(Fault::LinkFrame);
            }
        }
    }

    /// Tells all who listen what happened.
    ///
    /// # Errors
    /// The serial line is still busy with earlier frames: to be told again later.
    pub fn tell(&mut self, notice: &Notice) -> Result<(), Overrun> {
        let frame = self.sender.notice(notice);
        self.port.send(frame.as_bytes())
    }

    /// Sends a HEARTBEAT; left out where the serial line is still busy with earlier ones.
    ///
    /// Returns what the link counted, where frames were spoilt since it last did: for the log.
    pub fn beat(&mut self, state: FlightState) -> Option<LinkCounters> {
        let status = match state {
            FlightState::Calibrating => Status::Calibrating,
            FlightState::Disarmed => Status::Standby,
            FlightState::Armed | FlightState::Flying => Status::Active,
            FlightState::Waiting | FlightState::Descending => Status::Critical,
            FlightState::Blind => Status::Emergency,
        };
        let frame = self.sender.heartbeat(state.is_armed(), status);
        let _ = self.port.send(frame.as_bytes());
        let counters = self.parser.counters();
        let news = counters.spoilt() != self.logged.spoilt();
        news.then(|| {
            self.logged = counters;
            counters
        })
    }
}

/// Tells the pilot what waits to be told, as long as the serial line takes it.
fn tell_pilot<P: Port, R: Recorder, L: ControlLogic>(
    link: &mut impl Lock<Target = Link<P>>,
    pilot: &mut impl Lock<Target = Autopilot<R, L>>,
) {
    while let Some(notice) = pilot.lock(|pilot| pilot.notice()) {
        if link.lock(|link| link.tell(&notice)).is_err() {
            return;
        }
        pilot.lock(Autopilot::on_told);
    }
}

/// Once a second: that the drone is there, its state, and what the pilot was not told yet.
///
/// Returns what the link counted, where frames were spoilt since it last did: for the log.
pub fn beat<P: Port, R: Recorder, L: ControlLogic>(
    link: &mut impl Lock<Target = Link<P>>,
    pilot: &mut impl Lock<Target = Autopilot<R, L>>,
) -> Option<LinkCounters> {
    let state = pilot.lock(|pilot| pilot.telemetry().state);
    let counters = link.lock(|link| link.beat(state));
    tell_pilot(link, pilot);
    counters
}

/// Takes what the link brought; messages go to the autopilot, answers back to the peer.
pub fn receive<P: Port, R: Recorder, L: ControlLogic>(
    board: &mut impl Board,
    link: &mut impl Lock<Target = Link<P>>,
    pilot: &mut impl Lock<Target = Autopilot<R, L>>,
) {
    let fault = link.lock(|link| {
        let at = board.now();
        link.receive(at, |message| {
            let (next, answer) = pilot.lock(|pilot| pilot.on_message(board.now(), message));
            follow(board, next);
            answer
        })
    });
    if let Some(fault) = fault {
        pilot.lock(|pilot| pilot.on_fault(board.now(), fault));
    }
    tell_pilot(link, pilot);
}
