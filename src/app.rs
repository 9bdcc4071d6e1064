//! The autopilot: the one door between a board, or a host, and the rest.
//!
//! Each `on_*` call carries its own instant, records itself, never waits and never panics. The
//! same calls in the same order give the same motor commands, bit for bit, on any machine.
//!
//! A sample's way is `on_imu`, `on_hyperperiod` and `run` below: take, ask; then, where a run is
//! due, estimate and control, gate, learn.

mod call;
mod chips;
mod demand;
mod door;
mod flight;
mod notice;
mod record;
mod sensing;
mod storage;
mod telemetry;

pub use crate::reactive::{Next, Outcome, Reason};
pub use call::{Call, CallRing, DecodeError, LONGEST_RECORD, RING_LENGTH, Ran, Recorder, Stamped};
pub use demand::Silence;
pub use door::{ChipAction, ChipOrder, ChipSetting, Fault, OrderError};
pub use sensing::{Condition, Health};
pub use storage::{StoreEvent, Wish};
pub use telemetry::{Event, Events, RunCounts, Telemetry};

use crate::airframe::Mixer;
use crate::battery::{Battery, BatteryReading, BatteryState};
use crate::config::NOT_FINITE_LIMIT;
use crate::control::Setpoint;
use crate::estimate::{Followed, Motion, Place, Response, in_small_turns};
use crate::graph::{ControlLogic, Flown, Tuned};
use crate::link::{Answer, Destination, ExternalPose, Message, Notice};
use crate::math::{Quaternion, Vec3, wrapped};
use crate::reactive::{
    Column, FallbackReason, Fit, Foresight, Labels, Phase, PhaseEvent, Reactive, Refit, RefitJob,
    Review, Run, Situation, Sounding,
};
use crate::reset::Reset;
use crate::safety::{FlightEvent, FlightState, MotorOutput, Passed, Safety};
use crate::sensors::{Cause, ChipSample, ImuReading, Input, Inputs};
use crate::settings::{Settings, Start};
use crate::time::Instant;
use chips::Chips;
use demand::{Aim, Demand};
use record::Record;
use sensing::{Sensing, Taken};
use storage::Storage;

/// Rates (rad/s) of a drone that is turned to find its iron.
const TURNED_BY_HAND: f32 = 0.15;

/// The whole flight software above the board.
#[derive(Debug)]
pub struct Autopilot<R, L = Flown> {
    /// What the sensors say.
    sensing: Sensing,
    /// What shall be flown.
    demand: Demand,
    /// When control runs.
    reactive: Reactive,
    /// The estimator and the control laws.
    graph: L,
    /// Whether motors may turn, and the gate to them.
    safety: Safety,
    /// Whether the body answers the motors.
    response: Response,
    /// The newest estimate that was sound.
    sound: Quaternion,
    /// Orders to the chips that compare by themselves.
    chips: Chips,
    /// Why the board started.
    reset: Option<Reset>,
    /// What waits to be stored.
    storage: Storage,
    /// What flies it.
    battery: Battery,
    /// What happened.
    record: Record<R>,
}

impl<R: Recorder> Autopilot<R> {
    /// On the ground, not calibrated, with what was checked at the start and the mixer of its
    /// airframe; flies the control logic that is built in.
    #[must_use]
    pub fn new(start: &Start<<Flown as Tuned>::Gains>, mixer: &Mixer, recorder: R) -> Self {
        Self::with_logic(start.settings, recorder, Flown::with(start.gains, *mixer))
    }
}

impl<R: Recorder, L: ControlLogic> Autopilot<R, L> {
    /// With a control logic of one's own; otherwise as [`Self::new`].
    #[must_use]
    pub fn with_logic(settings: Settings, recorder: R, graph: L) -> Self {
        let motors = graph.mixed().shares.len();
        Self {
            sensing: Sensing::new(&settings),
            demand: Demand::default(),
            reactive: Reactive::new(&settings, &graph),
            graph,
            safety: Safety::new(motors),
            response: Response::default(),
            sound: Quaternion::IDENTITY,
            chips: Chips::new(&settings),
            reset: None,
            storage: Storage::default(),
            battery: Battery::default(),
            record: Record::new(recorder),
        }
    }

    // The way of a sample, from its reading to the motors.

    /// The inertial sensor was read; `at` is the stamp of its interrupt.
    ///
    /// Filters, sums and compares; ends the hyperperiod where it is the last that gates.
    pub fn on_imu(&mut self, at: Instant, reading: &ImuReading) -> Next {
        self.record.frequent(at, Call::Imu(*reading));
        let Some(summed) = self.take(at, reading) else {
            return Next::Wait;
        };
        if summed {
            self.ask(at);
            self.watch_response(at);
        }
        self.reactive.end_hyperperiod(at, Inputs::OF_IMU)
    }

    /// The hyperperiod ended: control runs if a run is due.
    ///
    /// The output must be written to the motors at once.
    pub fn on_hyperperiod(&mut self, now: Instant) -> Option<MotorOutput> {
        self.record.frequent(now, Call::Hyperperiod);
        if self.reactive.notice_late_run(now) {
            self.record.fault(Fault::LateRun);
        }
        let reason = self.reactive.take_due(now)?;
        Some(self.run(now, reason))
    }

    /// Takes what the sensors say, runs the graph, passes the gate, learns.
    fn run(&mut self, now: Instant, reason: Reason) -> MotorOutput {
        self.check_silences(now);
        self.aim(now);
        let motion = self.take_motion(now);
        self.propagate(now, &motion);
        self.watch_flight(now);
        self.hold_integrals();
        let passed = self.pass_gate(now);
        self.learn(now, reason, &motion, &passed);
        passed.output
    }

    // The steps of that way.

    /// Filters and sums a sample; `false` where it is not believed, `None` where it calibrates.
    fn take(&mut self, at: Instant, reading: &ImuReading) -> Option<bool> {
        let (armed, cutoff) = (self.safety.is_armed(), self.graph.derivative_cutoff());
        let mut tell = |fault| self.record.fault(fault);
        let taken = self.sensing.take(at, reading, armed, cutoff, &mut tell);
        match taken {
            Taken::Calibrating => return None,
            Taken::Turning => {
                self.record.fault(Fault::Turning);
                self.move_state(FlightEvent::ImuLost, at);
                return None;
            }
            Taken::Lost => {
                self.on_imu_lost(at);
                return self.is_calibrated().then_some(false);
            }
            Taken::Filtered {
                jumped,
                turned,
                rest,
            } => {
                if jumped {
                    self.record.fault(Fault::ImuJump);
                }
                if turned.is_some() || rest.is_some() {
                    self.realign(at, turned, rest);
                }
                if self.reactive.is_blind() {
                    self.move_phase(PhaseEvent::ImuBack);
                    self.move_state(FlightEvent::ImuBack, at);
                }
            }
        }
        Some(true)
    }

    /// The attitude is set behind a gap, in which the body turned, or at rest.
    ///
    /// In flight the accelerometer feels the propellers' push, and says nothing about the vertical.
    #[inline(never)] // Rare.
    fn realign(&mut self, at: Instant, turned: Option<Vec3>, rest: Option<Vec3>) {
        let estimate = self.graph.estimate();
        let bridged = turned.map(|turned| in_small_turns(estimate, turned));
        let standing = (!self.safety.flies()).then(|| self.sensing.force().0);
        let level = rest.or(standing).and_then(|force| estimate.levelled(force));
        if let Some(attitude) = level.or(bridged) {
            self.graph.align(attitude);
        }
        if rest.is_some() {
            self.move_state(FlightEvent::Calibrated, at);
        }
    }

    fn is_calibrated(&self) -> bool {
        self.safety.state() != FlightState::Calibrating
    }

    /// Shows the filtered sample to its inputs, and what can be derived from it.
    fn ask(&mut self, at: Instant) {
        let motion = self.sensing.motion();
        self.reactive.take_motion(&motion, self.sensing.force().0);
        match self.reactive.foresight() {
            Foresight::None => {}
            Foresight::Predicted => {
                let tell = self.record.labels();
                let changed = self.reactive.take_predicted(at, &motion, tell);
                self.record.judged(at, changed);
            }
            Foresight::Exact => self.foresee(at, &motion),
        }
    }

    /// Shows the command that a run would compute.
    fn foresee(&mut self, at: Instant, motion: &Motion) {
        self.graph.take(motion, self.sensing.heading_error(at));
        let foreseen = self.graph.foresee();
        let (held, tell) = (self.safety.applied(), self.record.labels());
        let changed = self
            .reactive
            .take_foreseen(at, &foreseen.shares, held, motion, tell);
        self.record.judged(at, changed);
        if foreseen.saturated != self.graph.mixed().saturated {
            self.advance(at);
        }
    }

    fn take_motion(&mut self, now: Instant) -> Motion {
        self.sensing
            .take_motion(now, &mut |fault| self.record.fault(fault))
    }

    /// The graph takes the motion, estimates and controls.
    fn propagate(&mut self, now: Instant, motion: &Motion) {
        self.graph.go_blind(self.reactive.is_blind());
        self.graph.take(motion, self.sensing.heading_error(now));
        self.graph.run();
        self.check_sound();
    }

    /// On the ground integrals would only wind up.
    fn hold_integrals(&mut self) {
        if !self.safety.is_armed() {
            self.graph.reset_integrals();
        } else if !self.safety.flies() {
            self.graph.stand();
        }
    }

    /// A graph with a value that is not finite begins anew where it last was sound.
    fn check_sound(&mut self) {
        let estimate = self.graph.estimate();
        let mut shares = self.graph.mixed().shares.iter();
        if estimate.is_finite() && shares.all(|share| share.is_finite()) {
            self.sound = estimate;
        } else {
            self.record.fault(Fault::Command);
            // The gate still sees this command: it counts those in a row.
            self.graph.restart(self.sound);
        }
    }

    /// A command that is no number is passed over; several in a row cut the motors.
    fn pass_gate(&mut self, now: Instant) -> Passed {
        let passed = self.safety.pass(&self.graph.mixed().shares);
        if passed.refused == 0 {
            return passed;
        }
        if passed.refused < NOT_FINITE_LIMIT {
            return passed;
        }
        self.move_state(FlightEvent::NotFinite, now);
        self.safety.pass(&self.graph.mixed().shares)
    }

    /// What a run taught, and what follows; its samples are the new references.
    fn learn(&mut self, now: Instant, reason: Reason, motion: &Motion, passed: &Passed) {
        let applied = passed.output.share();
        let run = Run {
            at: now,
            reason,
            motion,
            force: self.sensing.force().0,
            before: &passed.before,
            applied: &applied,
        };
        let judged = self.reactive.learn(&run, self.record.labels());
        self.record.judged(now, judged.last);
        if let Some(reason) = self.reactive.passed_limit() {
            self.move_phase(PhaseEvent::Fail(reason));
        }
        self.review_models(now);
        let (command, flown) = (self.graph.mixed(), self.graph.flown());
        if !self.reactive.on_run(&run, command, flown) {
            self.record.fault(Fault::Prediction);
        }
        self.chips.on_run(self.reactive.phase() == Phase::Reactive);
        let ran = Ran {
            reason,
            asked: judged.asked,
            expected: judged.expected,
            shares: applied,
        };
        self.record
            .ran(now, ran, judged.changed, self.reactive.runs());
    }

    /// What the newest models mean: whether the phase ends, and the chips' thresholds.
    fn review_models(&mut self, now: Instant) {
        match self.reactive.review_models(now, self.chips.delivering()) {
            None => {}
            // Brings the new phase's thresholds with it.
            Some(Review::Move(event)) => self.move_phase(event),
            Some(Review::Stay(turning)) => {
                if !turning.is_empty() {
                    self.record.event(Event::Lags(turning));
                }
                self.want_thresholds();
            }
        }
    }

    /// The graph takes the motion so far; the motors keep their command.
    ///
    /// States depend on what held while time passed, such as the setpoint and saturation. Where
    /// that changes between runs, the motion so far is taken first, so that states do not depend
    /// on how often control runs. Not inlined: in its many places it would cost 2 KiB.
    #[inline(never)]
    fn advance(&mut self, now: Instant) {
        let motion = self.take_motion(now);
        if motion.sums.dt > 0.0 {
            self.graph.take(&motion, self.sensing.heading_error(now));
            self.graph.run();
            self.reactive
                .on_advance(&motion, self.graph.mixed(), self.safety.applied());
        }
    }

    // Time.

    /// The timer that depends on no sensor: control runs if the failsafe is due.
    ///
    /// To be called at [`Self::deadline`]; an early call does no harm.
    pub fn on_timer(&mut self, now: Instant) -> Option<MotorOutput> {
        self.record.call(now, Call::Timer);
        if now < self.deadline() {
            return None;
        }
        Some(self.run(now, Reason::Failsafe))
    }

    /// True where samples have the command foreseen exactly: what that costs is a host's to count.
    #[must_use]
    pub fn foresees(&self) -> bool {
        self.reactive.foresight_in_use() == Foresight::Exact
    }

    /// True unless the inertial sensor fell silent and no run noticed.
    #[must_use]
    pub fn senses(&self, now: Instant) -> bool {
        !self.sensing.overlooks_silence(now)
    }

    /// When [`Self::on_timer`] is due next: control runs no later, nor is silence noticed later.
    #[must_use]
    pub fn deadline(&self) -> Instant {
        let run = self.reactive.deadline();
        let silence = self.sensing.silence_deadline();
        silence.map_or(run, |silence| run.min(silence))
    }

    /// Checked in every run, whatever its reason: a drone that tumbles without its gyroscope
    /// may be run by the other chip often enough that the failsafe never is.
    fn check_silences(&mut self, now: Instant) {
        if self.sensing.notice_silence(now) {
            self.record.fault(Fault::ImuSilent);
            self.on_imu_lost(now);
        }
        for input in self.chips.notice_silence(now).iter() {
            self.record.fault(Fault::ChipSilent(input));
            self.on_chip_lost(input);
        }
        self.check_demand(now);
        self.check_battery(now);
    }

    fn on_imu_lost(&mut self, now: Instant) {
        self.move_phase(PhaseEvent::Fail(FallbackReason::ImuLost));
        self.move_state(FlightEvent::ImuLost, now);
    }

    // The chips that compare.

    /// A sample of a chip with a clock of its own; `at` is the stamp of its interrupt.
    pub fn on_chip(&mut self, at: Instant, sample: &ChipSample) -> Next {
        self.record.call(at, Call::Chip(*sample));
        if self.chips.on_sample(at, sample) {
            self.record.fault(Fault::ChipStuck(sample.input));
            self.on_chip_lost(sample.input);
        }
        if sample.input == Input::ChipMag && self.is_turned_by_hand() {
            self.record.event(Event::Field(sample.axes.to_array()));
        }
        if self.chips.delivering().contains(sample.input) {
            let tell = &mut |fault| self.record.fault(fault);
            match sample.input {
                Input::ChipMag => {
                    let attitude = self.graph.estimate();
                    let turned = self.sensing.take_field(at, sample.axes, attitude, tell);
                    if turned.is_some() {
                        self.realign(at, turned, None);
                    }
                }
                // What passed a threshold is no sample of the mean.
                Input::ChipAccel if sample.cause != Cause::Threshold => {
                    let armed = self.safety.is_armed();
                    self.sensing.take_other_force(at, sample.axes, armed, tell);
                }
                _ => {}
            }
        }
        let (command, tell) = (self.safety.applied(), self.record.labels());
        self.reactive.take_sample(at, sample, command, tell)
    }

    /// True where the field may show the board's iron: motors stand, and somebody turns the drone.
    fn is_turned_by_hand(&self) -> bool {
        let turning = self.sensing.motion().rotation.rates.0.max_norm() > TURNED_BY_HAND;
        turning && self.safety.state() == FlightState::Disarmed
    }

    /// True where a chip is to be asked though nothing else raises its owner.
    #[must_use]
    pub fn are_chips_due(&self, now: Instant) -> bool {
        self.chips.are_due(now)
    }

    /// The next order for a chip, where one is due; the board reports when it is done.
    pub fn next_order(&mut self) -> Option<ChipOrder> {
        self.chips.next_order(self.record.clock())
    }

    /// The board carried an order out, or could not.
    pub fn on_order_done(
        &mut self,
        at: Instant,
        order: ChipOrder,
        result: Result<ChipSetting, OrderError>,
    ) {
        self.record.call(at, Call::OrderDone(order, result));
        // By the clock that orders are given by: with an older stamp the same would be due at once.
        let at = self.record.clock();
        let Some(failures) = self.chips.on_order_done(at, &order, result) else {
            return;
        };
        match (order.action, result) {
            (ChipAction::DataReady | ChipAction::Threshold(_), Ok(setting)) => {
                self.record.event(Event::Programmed(order.input, setting));
            }
            (_, Ok(_)) => {}
            (_, Err(error)) => {
                if failures.is_power_of_two() {
                    self.record.event(Event::OrderFailed(order, error));
                }
                self.record.fault(Fault::ChipBus);
            }
        }
    }

    /// A chip fell silent or repeats itself: what its model knew is missing from now on.
    fn on_chip_lost(&mut self, input: Input) {
        if self.reactive.is_counted_on(input) {
            self.move_phase(PhaseEvent::Fail(FallbackReason::SensorLost));
        }
    }

    // What the peer asks for.

    /// A message of the link; the answer where it was a command.
    pub fn on_message(&mut self, at: Instant, message: &Message) -> (Next, Option<Answer>) {
        self.record.call(at, Call::Message(*message));
        if !message.is_finite() {
            self.record.fault(Fault::NotFinite);
            return (Next::Wait, None);
        }
        match message {
            Message::Heartbeat => {}
            Message::Setpoint(setpoint) => self.on_setpoint(at, setpoint),
            Message::Arm(arm) => return self.on_arm(at, arm),
            Message::TestMotor(test) => return self.on_motor_test(at, test),
            Message::Calibrate(what) => return (Next::Wait, Some(self.on_calibrate(at, *what))),
            Message::Store(what) => return (Next::Wait, Some(self.on_store_command(*what))),
            Message::Pose(pose) => self.on_pose(at, pose),
            Message::Goal(destination) => self.on_goal(at, destination),
        }
        (Next::Wait, None)
    }

    /// A setpoint joins: the next run uses it. It forces a run once it moved past its quantum.
    fn on_setpoint(&mut self, at: Instant, setpoint: &Setpoint) {
        if self.graph.flown_to().is_some() {
            self.demand.forget();
        }
        let first = self.demand.is_silent();
        let turning = self.demand.take_setpoint(at, self.graph.flown(), setpoint);
        if Reactive::are_aerobatics(turning) {
            self.move_phase(PhaseEvent::Fail(FallbackReason::Aerobatics));
        }
        if self.obeys(at, first) {
            self.fly(at, Aim::Setpoint(*setpoint));
            self.reactive.take_setpoint(setpoint, first);
        }
    }

    /// A goal joins: the next run flies to it. Past its quantum it forces one.
    ///
    /// Without a fresh place it is refused, since position loops would begin where the drone was
    /// when the last one came. The setpoint in force then keeps its own timeout.
    fn on_goal(&mut self, at: Instant, destination: &Destination) {
        if !self.graph.flies_to_goals() || !self.demand.knows_place(at) {
            self.record.fault(Fault::Goal);
            return;
        }
        let first = self.demand.is_silent();
        self.demand.take_goal(at);
        if !self.obeys(at, first) {
            return;
        }
        self.advance(at);
        let before = self.graph.flown_to();
        // The heading at the beginning: one taken anew each time would turn with every error.
        let heading = before.map_or_else(|| self.graph.estimate().heading(), |goal| goal.heading);
        let goal = self.demand.tracked(destination.goal(heading));
        self.fly(at, Aim::Goal(goal));
        self.reactive.take_goal(before.as_ref(), &goal);
    }

    /// A pose joins: its place clocks the position loops, its attitude shows yaw drift.
    fn on_pose(&mut self, at: Instant, pose: &ExternalPose) {
        if self.graph.flies_to_goals() {
            match self.demand.take_place(at, pose) {
                Followed::On(place) => self.see(at, place),
                Followed::Reset(place) => {
                    self.record.event(Event::PlaceReset);
                    self.record.notice(notice::PLACE_RESET);
                    self.see(at, place);
                }
                Followed::Jumped => {
                    self.record.fault(Fault::PlaceJump);
                    if self.record.faults(Fault::PlaceJump).is_power_of_two() {
                        self.record.notice(notice::PLACE_JUMPED);
                    }
                    return;
                }
            }
        }
        if let Some(attitude) = pose.attitude {
            let error = wrapped(attitude.heading() - self.graph.estimate().heading());
            self.sensing.take_pose_error(at, error);
        }
    }

    /// A place joins, behind the motion that led to it; motors keep their command.
    fn see(&mut self, at: Instant, place: Place) {
        self.advance(at);
        self.graph.see(place);
        self.join();
    }

    /// A new setpoint or goal, behind the motion that the one before led to.
    fn fly(&mut self, now: Instant, aim: Aim) {
        self.advance(now);
        match aim {
            Aim::Setpoint(setpoint) => {
                self.graph.fly_to(None);
                self.graph.fly(setpoint);
            }
            Aim::Goal(goal) => self.graph.fly_to(Some(goal)),
        }
        self.join();
    }

    /// The graph takes what joined it; the motors keep their command.
    fn join(&mut self) {
        self.graph.run();
        self.reactive
            .on_joined(self.graph.mixed(), &self.sensing.motion());
    }

    // States.

    /// How the sensors do.
    #[must_use]
    pub fn health(&self) -> Health {
        self.sensing.health(self.graph.estimate())
    }

    /// The chips compare with the thresholds of the models.
    fn want_thresholds(&mut self) {
        self.chips
            .want(|input| self.reactive.threshold_for_chip(input));
    }

    fn move_phase(&mut self, event: PhaseEvent) {
        if let Some(phase) = self.reactive.on_phase_event(event, self.record.clock()) {
            self.record.event(Event::Phase(phase));
            self.chips.retry();
            self.want_thresholds();
        }
    }

    // Models.

    /// The labels of an input whose refit is due, copied: to be fitted in idle, without a lock.
    #[must_use]
    pub fn refit_due(&mut self, now: Instant) -> Option<RefitJob> {
        self.reactive.refit_due(now)
    }

    /// The control logic, copied, where it is to be sounded: in idle, without a lock.
    #[must_use]
    pub fn sounding_due(&self, now: Instant) -> Option<Sounding<L>>
    where
        L: Clone,
    {
        let situation = Situation {
            rotation: self.sensing.motion().rotation,
            force: self.sensing.force().0,
            heading: self.sensing.heading_error(now),
        };
        self.reactive.sounding_due(now, &self.graph, &situation)
    }

    /// Takes what a sounding found of one feature of motion.
    pub fn on_column(&mut self, now: Instant, column: Column) {
        self.record.call(now, Call::Column(column));
        if !self.reactive.on_column(&column) {
            self.record.fault(Fault::NotFinite);
        }
    }

    /// A sounding ended.
    pub fn on_sounded(&mut self, now: Instant) {
        self.record.call(now, Call::Sounded);
        self.reactive.on_sounded(now);
    }

    /// Swaps a fit in and forgets a little; the next run judges what it means.
    ///
    /// A symbol of its own, so that the lock around it can be measured.
    #[inline(never)]
    pub fn on_refit(&mut self, now: Instant, refit: Refit) {
        self.record.call(now, Call::Refit(refit));
        let Refit { input, mut fit } = refit;
        if !fit.is_usable() {
            self.record.fault(Fault::NotFinite);
            fit = Fit::Unfit;
        }
        let labels = self.reactive.swap_model(now, &Refit { input, fit });
        self.record.event(Event::Refit {
            input,
            fit,
            threshold: self.reactive.threshold(input),
            labels,
        });
    }

    /// The change of an input above which it calls for a run, in its SI unit.
    #[must_use]
    pub fn threshold(&self, input: Input) -> f32 {
        self.reactive.threshold(input)
    }

    /// The labels of an input.
    #[must_use]
    pub fn labels(&self, input: Input) -> &Labels {
        self.reactive.labels(input)
    }

    /// What the labels say of an input.
    #[must_use]
    pub fn fit(&self, input: Input) -> Fit {
        self.reactive.fit(input)
    }

    /// The change of an input that the last run met, in its SI unit; `None` where none was measured.
    #[must_use]
    pub fn change_met(&self, input: Input) -> Option<f32> {
        self.reactive.change_met(input)
    }

    // What a board knows of itself.

    /// What the board found of the start before this one.
    pub fn on_reset(&mut self, at: Instant, reset: &Reset) {
        self.record.call(at, Call::Reset(*reset));
        self.reset = Some(*reset);
    }

    /// What the board found of the start before this one; `None` where no board told.
    #[must_use]
    pub fn reset(&self) -> Option<&Reset> {
        self.reset.as_ref()
    }

    /// The store was read, is written, or is to be: the pilot is told.
    pub fn on_store(&mut self, at: Instant, event: StoreEvent) {
        self.record.call(at, Call::Store(event));
        if let Some(notice) = self.storage.take(event) {
            self.record.event(Event::Store(event));
            self.record.notice(notice);
        }
    }

    /// What is to be stored now, where something is and motors stand.
    #[must_use]
    pub fn to_store(&self) -> Option<Wish> {
        self.storage.due().filter(|_| !self.stands_no_longer())
    }

    /// The accelerometer's trim in force, in m/s2.
    #[must_use]
    pub fn accel_trim(&self) -> [f32; 3] {
        self.sensing.trim().to_array()
    }

    /// The battery was measured; its state, where that is new.
    pub fn on_battery(&mut self, at: Instant, reading: &BatteryReading) -> Option<BatteryState> {
        self.record.call(at, Call::Battery(*reading));
        if !reading.is_finite() {
            self.record.fault(Fault::NotFinite);
            return None;
        }
        let stands = !self.stands_no_longer();
        let state = self.battery.take(at, reading, stands);
        if self.battery.collapses() && !stands {
            self.record.fault(Fault::BatteryCollapsed);
            self.record.notice(notice::BATTERY_COLLAPSED);
        }
        let state = state?;
        self.record.notice(notice::battery(state));
        Some(state)
    }

    /// The battery as it was measured so far.
    #[must_use]
    pub fn battery(&self) -> &Battery {
        &self.battery
    }

    // What happened.

    /// Something went wrong outside: counted, and told in the log.
    pub fn on_fault(&mut self, at: Instant, fault: Fault) {
        self.record.call(at, Call::Fault(fault));
        self.record.fault(fault);
    }

    /// How often a fault was counted.
    #[must_use]
    pub fn faults(&self, fault: Fault) -> u32 {
        self.record.faults(fault)
    }

    /// How often runs in reactive control turned out this way.
    #[must_use]
    pub fn outcomes(&self, outcome: Outcome) -> u32 {
        self.reactive.outcomes(outcome)
    }

    /// The oldest event that waits for the log.
    pub fn next_event(&mut self) -> Option<Event> {
        self.record.events().pop()
    }

    /// The oldest notice that waits to be told to the pilot; [`Self::on_told`] is the next step.
    #[must_use]
    pub fn notice(&self) -> Option<Notice> {
        self.record.notice_due()
    }

    /// The pilot was told the oldest notice.
    pub fn on_told(&mut self) {
        self.record.on_told();
    }

    /// The state in brief.
    #[must_use]
    pub fn telemetry(&self) -> Telemetry {
        Telemetry {
            state: self.safety.state(),
            phase: self.reactive.phase(),
            attitude: self.graph.estimate(),
            runs: self.reactive.runs(),
            dropped_events: self.record.dropped_events(),
        }
    }

    /// The control logic, for a host that looks at it while the autopilot lives.
    pub fn logic(&mut self) -> &mut L {
        &mut self.graph
    }

    /// The recorder, for a host that reads it while the autopilot lives.
    pub fn recorder(&mut self) -> &mut R {
        self.record.recorder()
    }
}

#[cfg(test)]
mod tests;
