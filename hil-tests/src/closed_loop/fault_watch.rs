//! What a flight does behind the instant at which something breaks.

use flight_dynamics::Drone;
use reflex::app::{Fault, Telemetry};
use reflex::battery::BatteryState;
use reflex::safety::FlightState;

use super::fault_report::{FaultReport, Outcome};
use super::flying_board::{FlyingBoard, TimedRan};

/// How long nothing may be noticed for all to be over, ns.
const CALM_NS: u64 = 1_000_000_000;

/// Watches one flight.
pub(super) struct FaultWatch {
    from_ns: u64,
    now_ns: u64,
    /// What the flight had shown before the first fault.
    usual: Option<Usual>,
    newest: Counts,
    detected: Option<(u64, String)>,
    /// When the newest was noticed that is not usual.
    noticed_ns: u64,
    stopped_ns: Option<u64>,
    states: Vec<FlightState>,
    largest_tilt: f64,
    /// How it ended, once it has.
    ended: Option<Outcome>,
    bad_commands: u64,
    last_run_ns: Option<u64>,
    longest_gap_ns: u64,
    longest_transfer_ns: Option<u64>,
}

/// How often each kind of fault was counted.
type Counts = [u32; Fault::COUNT];

/// What is no news.
#[derive(Clone)]
struct Usual {
    counts: Counts,
    telemetry: Telemetry,
    battery: BatteryState,
}

impl FaultWatch {
    /// Watches from the first fault on.
    pub(super) fn new(from_ns: u64) -> Self {
        Self {
            from_ns,
            now_ns: 0,
            usual: None,
            newest: [0; Fault::COUNT],
            detected: None,
            noticed_ns: 0,
            stopped_ns: None,
            states: Vec::new(),
            largest_tilt: 0.0,
            ended: None,
            bad_commands: 0,
            last_run_ns: None,
            longest_gap_ns: 0,
            longest_transfer_ns: None,
        }
    }

    /// A run of control.
    pub(super) fn ran(&mut self, (at_ns, ran): &TimedRan) {
        let is_share = |share: &f32| (0.0..=1.0).contains(share);
        self.bad_commands += u64::from(!ran.shares.iter().all(is_share));
        if self.ended.is_none() {
            let before_ns = self.last_run_ns.replace(*at_ns);
            let gap_ns = before_ns.map_or(0, |before_ns| at_ns.saturating_sub(before_ns));
            if *at_ns >= self.from_ns {
                self.longest_gap_ns = self.longest_gap_ns.max(gap_ns);
            }
        }
    }

    /// A step of the flight has ended.
    pub(super) fn look(&mut self, now_ns: u64, board: &dyn FlyingBoard, drone: &Drone) {
        let telemetry = board.telemetry();
        let counts = Fault::ALL.map(|fault| board.counted(fault));
        let battery = board.battery();
        let Some(usual) = self.usual.as_ref().filter(|_| now_ns > self.from_ns) else {
            self.usual = Some(Usual {
                counts,
                telemetry,
                battery,
            });
            return;
        };
        if self.ended.is_some() {
            return;
        }
        self.now_ns = now_ns;
        self.longest_transfer_ns = board.longest_transfer_ns();
        let tilt = drone.state().tilt().to_degrees();
        self.largest_tilt = self.largest_tilt.max(tilt);
        let before = std::mem::replace(&mut self.newest, counts);
        if usual.is_noticed(&before, &counts, &telemetry) || battery > usual.battery {
            self.noticed_ns = now_ns;
        }
        if self.detected.is_none() {
            let news = usual.news(&counts, &telemetry, battery);
            self.detected = news.map(|news| (now_ns, news));
        }
        if self.states.last() != Some(&telemetry.state) {
            self.states.push(telemetry.state);
        }
        let is_armed = !matches!(
            telemetry.state,
            FlightState::Calibrating | FlightState::Disarmed | FlightState::Testing
        );
        if is_armed {
            // A gap that no run ends counts too.
            let since_ns = now_ns.saturating_sub(self.last_run_ns.unwrap_or(now_ns));
            self.longest_gap_ns = self.longest_gap_ns.max(since_ns);
        } else {
            self.stopped_ns = Some(now_ns);
        }
        self.ended = match (is_armed, drone.is_on_ground()) {
            _ if drone.crash().is_some() || drone.upset().is_some() => Some(Outcome::Crashed),
            (true, _) => None,
            (false, true) => Some(Outcome::Landed),
            (false, false) => Some(Outcome::Cut),
        };
    }

    /// What came of it.
    pub(super) fn report(&self) -> FaultReport {
        let since_ms = |at_ns: u64| millis(at_ns - self.from_ns);
        let detected = self.detected.as_ref();
        let is_over = self.ended.is_none() && self.now_ns > self.noticed_ns + CALM_NS;
        FaultReport {
            detected_ms: detected.map(|(at_ns, _)| since_ms(*at_ns)),
            detected_by: detected.map(|(_, news)| news.clone()),
            states: (self.states.iter())
                .map(|state| format!("{state:?}"))
                .collect(),
            stopped_ms: self.stopped_ns.map(since_ms),
            recovered_ms: (is_over && detected.is_some()).then(|| since_ms(self.noticed_ns)),
            largest_tilt_deg: self.largest_tilt,
            outcome: self.ended.unwrap_or(Outcome::Flies),
            bad_commands: self.bad_commands,
            longest_gap_ms: millis(self.longest_gap_ns),
            longest_transfer_ms: self.longest_transfer_ns.map(millis),
        }
    }
}

fn millis(ns: u64) -> f64 {
    ns as f64 * 1e-6
}

impl Usual {
    /// What the flight had not shown before: a kind of fault that was never counted, an emptier battery, another
    /// state, another phase.
    ///
    /// Kinds that were counted before are no news: some are in every flight in wind.
    fn news(
        &self,
        counts: &Counts,
        telemetry: &Telemetry,
        battery: BatteryState,
    ) -> Option<String> {
        if let Some(fault) = self.new_kinds(counts).next() {
            return Some(format!("{fault:?}"));
        }
        if battery > self.battery {
            return Some(format!("Battery{battery:?}"));
        }
        if telemetry.state != self.telemetry.state {
            return Some(format!("{:?}", telemetry.state));
        }
        (telemetry.phase != self.telemetry.phase).then(|| format!("{:?}", telemetry.phase))
    }

    /// Something is other than it was before the fault, or was counted between two looks.
    fn is_noticed(&self, before: &Counts, counts: &Counts, telemetry: &Telemetry) -> bool {
        let place = |fault: &Fault| usize::from(fault.number());
        let grew = |fault: Fault| before[place(&fault)] < counts[place(&fault)];
        (telemetry.state, telemetry.phase) != (self.telemetry.state, self.telemetry.phase)
            || self.new_kinds(counts).any(grew)
    }

    /// Kinds of fault that were counted, and never before.
    fn new_kinds(&self, counts: &Counts) -> impl Iterator<Item = Fault> {
        let kinds = Fault::ALL.into_iter().zip(self.counts.iter().zip(counts));
        kinds.filter_map(|(fault, (before, now))| (*before == 0 && *now > 0).then_some(fault))
    }
}
