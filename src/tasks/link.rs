//! The link: frames from bytes, messages to the autopilot, answers and heartbeats.

use super::{Board, Lock, Task, follow};
use crate::app::{Autopilot, Fault, Recorder, StoreEvent};
use crate::graph::ControlLogic;
use crate::link::{
    Frame, Incoming, LinkCounters, Notice, Parser, Sender, Severity, SigningKey, Status,
};
use crate::safety::FlightState;
use crate::time::{Duration, Instant, micros, span};

/// Between two heartbeats.
pub const BEAT: Duration = micros(1_000_000);

/// The stamp that frames are signed with is stored this often: a restart goes on from it, and frames of
/// the time since could be sent again. Flash bears 100,000 saves and more.
const KEY_LIFE: Duration = micros(600_000_000);

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
    /// A cable to something that the user holds: a signing key may come over it.
    wired: bool,
    parser: Parser,
    sender: Sender,
    /// When the key or its stamp was last handed over to be stored.
    key_stored: Instant,
    /// What was returned for the log last.
    logged: LinkCounters,
}

impl<P: Port> Link<P> {
    /// A link over a started port, a cable or not, to a drone of so many motors.
    pub fn new(port: P, wired: bool, motors: usize) -> Self {
        Self {
            port,
            wired,
            parser: Parser::new(),
            sender: Sender::new(motors),
            key_stored: Instant::from_ticks(0),
            logged: LinkCounters::default(),
        }
    }

    /// Goes on with the key of an earlier start.
    pub fn restore(&mut self, at: Instant, key: SigningKey) {
        self.parser.signing().set(at, key);
        self.key_stored = at;
    }

    /// The key with the stamp of now: to be stored.
    pub fn key_to_store(&mut self, at: Instant) -> Option<SigningKey> {
        self.key_stored = at;
        self.parser.signing().key(at)
    }

    fn is_key_due(&mut self, at: Instant) -> bool {
        span(self.key_stored, at) >= KEY_LIFE && self.parser.signing().key(at).is_some()
    }

    /// The port.
    pub fn port(&mut self) -> &mut P {
        &mut self.port
    }

    /// Takes what came; messages go to the autopilot, answers back to the peer.
    ///
    /// A fault where bytes were lost or a frame was spoilt.
    fn receive<R: Recorder, L: ControlLogic>(
        &mut self,
        board: &mut impl Board,
        pilot: &mut impl Lock<Target = Autopilot<R, L>>,
    ) -> Option<Fault> {
        let (at, spoilt) = (board.now(), self.parser.counters().spoilt());
        let mut chunk = [0; CHUNK];
        loop {
            let Ok(count) = self.port.take(&mut chunk) else {
                return Some(Fault::LinkOverrun);
            };
            let mut feed = self.parser.feed(at, chunk.get(..count).unwrap_or_default());
            while let Some(incoming) = feed.next() {
                let frame = match incoming {
                    Incoming::Message { from, message } => {
                        let (next, answer) =
                            pilot.lock(|pilot| pilot.on_message(board.now(), &message));
                        follow(board, next);
                        let answered = message.command().zip(answer);
                        answered
                            .map(|(command, answer)| self.sender.command_ack(from, command, answer))
                    }
                    Incoming::Refused {
                        from,
                        command,
                        answer,
                    } => Some(self.sender.command_ack(from, command, answer)),
                    Incoming::Key(key) => {
                        let armed = pilot.lock(|pilot| pilot.telemetry().state.is_armed());
                        let notice = refusal_of_key(self.wired, armed).unwrap_or_else(|| {
                            feed.signing().set(at, key);
                            pilot.lock(|pilot| pilot.on_store(at, StoreEvent::KeyDue));
                            board.raise(Task::Idle);
                            KEY_SET
                        });
                        Some(self.sender.notice(&notice))
                    }
                };
                if let Some(mut frame) = frame {
                    feed.signing().sign(at, &mut frame);
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
    pub fn tell(&mut self, at: Instant, notice: &Notice) -> Result<(), Overrun> {
        let frame = self.sender.notice(notice);
        self.send(at, frame)
    }

    fn send(&mut self, at: Instant, mut frame: Frame) -> Result<(), Overrun> {
        self.parser.signing().sign(at, &mut frame);
        self.port.send(frame.as_bytes())
    }

    /// Sends a HEARTBEAT; left out where the serial line is still busy with earlier ones.
    ///
    /// Returns what the link counted, where frames were spoilt since it last did: for the log.
    pub fn beat(&mut self, at: Instant, state: FlightState) -> Option<LinkCounters> {
        let status = match state {
            FlightState::Calibrating => Status::Calibrating,
            FlightState::Disarmed | FlightState::Testing => Status::Standby,
            FlightState::Armed | FlightState::Flying => Status::Active,
            FlightState::Waiting | FlightState::Descending => Status::Critical,
            FlightState::Blind => Status::Emergency,
        };
        let frame = self.sender.heartbeat(state.is_armed(), status);
        let _ = self.send(at, frame);
        let counters = self.parser.counters();
        let news = counters.spoilt() != self.logged.spoilt();
        news.then(|| {
            self.logged = counters;
            counters
        })
    }
}

/// What is told where a signing key was taken.
const KEY_SET: Notice = Notice::new(Severity::Notice, "signing key", "set");

/// Why no signing key is taken: over the air it would be heard, in flight it might be wrong.
fn refusal_of_key(wired: bool, armed: bool) -> Option<Notice> {
    const NOT_WIRED: Notice = Notice::new(Severity::Warning, "signing key refused", "not wired");
    const ARMED: Notice = Notice::new(Severity::Warning, "signing key refused", "armed");
    if !wired {
        return Some(NOT_WIRED);
    }
    armed.then_some(ARMED)
}

/// Tells the pilot what waits to be told, as long as the serial line takes it.
fn tell_pilot<P: Port, R: Recorder, L: ControlLogic>(
    at: Instant,
    link: &mut impl Lock<Target = Link<P>>,
    pilot: &mut impl Lock<Target = Autopilot<R, L>>,
) {
    while let Some(notice) = pilot.lock(|pilot| pilot.notice()) {
        if link.lock(|link| link.tell(at, &notice)).is_err() {
            return;
        }
        pilot.lock(Autopilot::on_told);
    }
}

/// Once a second: that the drone is there, its state, and what the pilot was not told yet.
///
/// Returns what the link counted, where frames were spoilt since it last did: for the log.
pub fn beat<P: Port, R: Recorder, L: ControlLogic>(
    board: &mut impl Board,
    link: &mut impl Lock<Target = Link<P>>,
    pilot: &mut impl Lock<Target = Autopilot<R, L>>,
) -> Option<LinkCounters> {
    let at = board.now();
    let state = pilot.lock(|pilot| pilot.telemetry().state);
    let (counters, due) = link.lock(|link| (link.beat(at, state), link.is_key_due(at)));
    if due {
        pilot.lock(|pilot| pilot.on_store(at, StoreEvent::KeyDue));
    }
    tell_pilot(at, link, pilot);
    counters
}

/// Takes what the link brought; messages go to the autopilot, answers back to the peer.
pub fn receive<P: Port, R: Recorder, L: ControlLogic>(
    board: &mut impl Board,
    link: &mut impl Lock<Target = Link<P>>,
    pilot: &mut impl Lock<Target = Autopilot<R, L>>,
) {
    if let Some(fault) = link.lock(|link| link.receive(board, pilot)) {
        pilot.lock(|pilot| pilot.on_fault(board.now(), fault));
    }
    tell_pilot(board.now(), link, pilot);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signing_key_is_taken_over_a_cable_and_never_while_armed() {
        let taken = |wired, armed| refusal_of_key(wired, armed).is_none();
        assert!(taken(true, false));
        assert!(!taken(true, true) && !taken(false, false) && !taken(false, true));
    }
}
