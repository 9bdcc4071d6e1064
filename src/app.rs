//! The autopilot: the one door between a board, or a host, and the rest.
//!
//! Each `on_*` call carries its own instant, records itself, never waits and never panics. The
//! same calls in the same order give the same motor commands, bit for bit, on any machine.
//!
//! ```text
//! on_imu, on_chip_* -> arrival stage -> triggers -> asked? -> end of the hyperperiod
//! on_hyperperiod, on_timer -> graph -> motor gate -> MotorOutput;  labels, new references
//! refit_due -> (fit in idle) -> on_refit -> thresholds -> next_order -> the chips
//! ```

mod call;
mod chips;
mod goals;
mod hyperperiod;
mod inputs;
mod learners;
mod learning;
mod liveness;
mod outcome;
mod runs;
mod schedule;
mod setpoints;
mod types;

pub use call::{Call, CallRing, DecodeError, LONGEST_RECORD, RING_LENGTH, Ran, Recorder, Stamped};
pub use outcome::Outcome;
pub use types::{ChipOrder, Fault, Next, OrderError, Reason};

use crate::estimate::{Arrival, GyroCalibration};
use crate::graph::{ControlLogic, Flown};
use crate::reactive::{Exploration, Limits, Supervisor};
use crate::safety::{Arming, MotorGate};
use crate::settings::Settings;
use crate::telemetry::{Event, Events, Telemetry};
use crate::time::Instant;
use crate::units::BodyRates;
use chips::Chips;
use learners::Learners;
use liveness::Liveness;
use schedule::Schedule;
use setpoints::SetpointWatch;

/// The whole flight software above the board.
#[derive(Debug)]
pub struct Autopilot<R, L = Flown> {
    recorder: R,
    settings: Settings,
    /// The newest instant that any call carried.
    clock: Instant,

    calibration: GyroCalibration,
    bias: Option<BodyRates>,
    arrival: Arrival,
    heading: Heading,
    /// When the newest place came.
    placed_at: Option<Instant>,
    setpoints: SetpointWatch,
    liveness: Liveness,

    graph: L,
    /// The graph took motion that no run has judged yet.
    advanced: bool,
    arming: Arming,
    gate: MotorGate,

    learners: Learners,
    /// Models were swapped in since the last run.
    unjudged: bool,
    supervisor: Supervisor,
    limits: Limits,
    exploration: Exploration,
    schedule: Schedule,
    chips: Chips,

    faults: [u32; Fault::COUNT],
    outcomes: [u32; Outcome::COUNT],
    events: Events,
}

/// The error of the estimated heading, from a magnetometer or an external pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Heading {
    /// Direction of the horizontal field when it was first seen, rad in Earth axes.
    field: Option<f32>,
    error: Option<(Instant, f32)>,
    /// When an external pose last gave a heading: it goes before the magnetometer.
    pose_at: Option<Instant>,
}

impl<R: Recorder> Autopilot<R> {
    /// On the ground, not calibrated, with checked settings and the control logic built in.
    #[must_use]
    pub fn new(settings: Settings, recorder: R) -> Self {
        Self::with_logic(settings, recorder, Flown::default())
    }
}

impl<R: Recorder, L: ControlLogic> Autopilot<R, L> {
    /// With a control logic of one's own; otherwise as [`Self::new`].
    #[must_use]
    pub fn with_logic(settings: Settings, recorder: R, graph: L) -> Self {
        Self {
            recorder,
            settings,
            clock: Instant::from_ticks(0),
            calibration: GyroCalibration::default(),
            bias: None,
            arrival: Arrival::default(),
            heading: Heading::default(),
            placed_at: None,
            setpoints: SetpointWatch::default(),
            liveness: Liveness::default(),
            graph,
            advanced: false,
            arming: Arming::default(),
            gate: MotorGate::default(),
            learners: Learners::new(&settings),
            unjudged: false,
            supervisor: Supervisor::new(settings.policy, settings.warm_up),
            limits: Limits::default(),
            exploration: Exploration::new(settings.seed),
            schedule: Schedule::new(&settings),
            chips: Chips::default(),
            faults: [0; Fault::COUNT],
            outcomes: [0; Outcome::COUNT],
            events: Events::default(),
        }
    }

    /// Takes note of a call and its instant.
    fn note(&mut self, at: Instant, call: Call) {
        self.clock = self.clock.max(at);
        self.recorder.record(at, &call);
    }

    /// Something went wrong outside: counted, and told in the log.
    pub fn on_fault(&mut self, at: Instant, fault: Fault) {
        self.note(at, Call::Fault(fault));
        self.count(fault);
    }

    fn count(&mut self, fault: Fault) {
        if let Some(count) = self.faults.get_mut(fault as usize) {
            *count = count.saturating_add(1);
            let count = *count;
            // The first few of a kind, then at powers of two: a storm must not drown the log.
            if count.is_power_of_two() {
                self.events.push(Event::Fault(fault, count));
            }
        }
    }

    /// How often a fault was counted.
    #[must_use]
    pub fn faults(&self, fault: Fault) -> u32 {
        self.faults.get(fault as usize).copied().unwrap_or(0)
    }

    /// How often runs in reactive control turned out this way.
    #[must_use]
    pub fn outcomes(&self, outcome: Outcome) -> u32 {
        self.outcomes.get(outcome as usize).copied().unwrap_or(0)
    }

    /// The oldest event that waits for the log.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop()
    }

    /// The control logic, for a host that looks at it while the autopilot lives.
    pub fn logic(&mut self) -> &mut L {
        &mut self.graph
    }

    /// The recorder, for a host that reads it while the autopilot lives.
    pub fn recorder(&mut self) -> &mut R {
        &mut self.recorder
    }

    /// The state in brief.
    #[must_use]
    pub fn telemetry(&self) -> Telemetry {
        Telemetry {
            arming: self.arming,
            phase: self.supervisor.phase(),
            attitude: self.graph.estimate(),
            runs: self.schedule.runs(),
            dropped_events: self.events.dropped(),
        }
    }
}

#[cfg(test)]
mod tests;
