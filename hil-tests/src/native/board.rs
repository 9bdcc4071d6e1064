//! The native board: chips, buses and tasks around one autopilot, in virtual time.
//!
//! It calls the tasks of the firmware, those of `reflex::tasks`, in the same order and at nearly
//! the same instants: interrupt edges of the chip models are stamped, bytes move. Tasks do not
//! preempt each other; what a task takes is a constant of `timing`. Nothing reads a clock and
//! nothing is random but the models' seeds, so the same flight gives the same calls.
//!
//! **Not played**: the log, what is sent over the link, the motors' timers.

use std::sync::Arc;

use reflex::app::{Autopilot, Call, Recorder, Stamped};
use reflex::config::LINK_WIRED;
use reflex::reactive::Refit;
use reflex::sensors::Input;
use reflex::tasks::chips::{Done, Fetches};
use reflex::tasks::drivers::Drivers;
use reflex::tasks::imu::Guard;
use reflex::tasks::link::Link;
use reflex::tasks::mpu6050::{CONFIG, Sensor};
use reflex::time::Instant;
use reflex_drivers::legacy_hal::Lent;
use reflex_drivers::mpu6050::{ADDRESS, BURST_LENGTH, Mpu6050 as Mpu6050Driver};

use super::agenda::{Agenda, Event};
use super::gauge::Gauge;
use super::imu_line::ImuLine;
use super::serial_line::SerialLine;
use super::timing::{
    ARRIVAL_NS, BOOT_NS, CHIPS_START_NS, IMU_START_NS, IMU_WAKE_NS, SHORTEST_BURST_NS, clock,
};
use super::vectors::{Outputs, Vectors};
use super::wires::{BusTime, DieWire, I2cBus, Spi, Wire};
use crate::faults::{Effect, Fault, Script, Strikes, Struck};
use crate::ground_station::LinkFrame;
use crate::logics::{AnyLogic, Start};
use crate::record::{ChipState, OfChips};
use chip_models::{ChipOptions, DIES, Mpu6050, OwnClock, StimulusSource};
use emulated_board::Disturbance;

/// The one fault of a bus that is played here.
const SILENCE: Effect = Effect::Bus(Disturbance::NoAcknowledge);

/// Every call with its stamp.
#[derive(Debug, Default)]
pub(crate) struct Calls(pub(crate) Vec<Stamped>);

impl Recorder for Calls {
    fn record(&mut self, at: Instant, call: &Call) {
        self.0.push(Stamped { at, call: *call });
    }
}

/// A burst under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Burst {
    /// Stamp of its interrupt.
    pub(super) at: Instant,
    /// What was read; none where the chip did not answer.
    pub(super) bytes: Option<[u8; BURST_LENGTH]>,
}

/// The board, standing at the instant it was last run to.
pub(crate) struct NativeBoard {
    pub(crate) pilot: Autopilot<Calls, AnyLogic>,
    pub(super) agenda: Agenda,
    pub(crate) now_ns: u64,

    /// What the present event raised, and the firmware's time.
    pub(super) vectors: Vectors,
    pub(super) motors: Outputs,

    pub(crate) imu: Wire<Mpu6050>,
    pub(super) imu_line: ImuLine,
    pub(super) imu_bus: I2cBus,
    pub(super) burst: Option<Burst>,
    pub(super) guard: Guard<Sensor>,

    pub(crate) dies: OfChips<DieWire>,
    pub(super) spi_time: BusTime,
    pub(super) chips: Drivers<Spi>,
    pub(super) fetches: Fetches,
    /// What the chips' owner did on the bus, to be reported when the bus is done.
    pub(super) done: Option<Done>,
    /// The owner was raised again meanwhile.
    pub(super) raised_again: bool,

    pub(super) link: Link<SerialLine>,
    pub(crate) gauge: Gauge,

    pub(super) refit: Option<Refit>,

    strikes: Strikes,
    /// While one of them holds no fit succeeds.
    unfit: Vec<Fault>,
}

impl NativeBoard {
    /// Powers the chips and starts up; `frames` come in order of time.
    pub(crate) fn boot(
        start: &Start,
        source: &Arc<dyn StimulusSource>,
        options: ChipOptions,
        frames: Vec<LinkFrame>,
    ) -> Self {
        let imu = Wire::new(Mpu6050::new(Arc::clone(source), options));
        let dies = DIES.map(|die| Wire::new((die.model)(Arc::clone(source), options)));
        let spi_time = BusTime::default();
        let devices = dies.each_ref().map(|wire| Spi {
            wire: wire.clone(),
            time: spi_time.clone(),
        });
        let chips = Drivers::new(devices, &start.settings);
        let imu_bus = I2cBus {
            wire: imu.clone(),
            time: BusTime::default(),
            silences: Vec::new(),
        };
        let mut board = Self {
            pilot: start.autopilot(Calls::default()),
            agenda: Agenda::new(),
            now_ns: 0,
            vectors: Vectors::at(clock(0)),
            motors: Outputs::default(),
            imu,
            imu_line: ImuLine::new(BOOT_NS),
            imu_bus,
            burst: None,
            guard: Guard::new(clock(BOOT_NS)),
            dies,
            spi_time,
            chips,
            fetches: Fetches::default(),
            done: None,
            raised_again: false,
            link: Link::new(SerialLine::new(frames), LINK_WIRED, start.airframe.count()),
            gauge: Gauge::default(),
            refit: None,
            strikes: Strikes::default(),
            unfit: Vec::new(),
        };
        board.start_up();
        board
    }

    /// As the board does it; whatever does not answer is set up again later.
    fn start_up(&mut self) {
        self.spi_time.set_ns(CHIPS_START_NS);
        for input in Input::OF_CHIPS {
            let _ = self.chips.set_up(input);
        }
        self.imu_bus.time.set_ns(IMU_WAKE_NS);
        let mut delay = self.imu_bus.time.clone();
        let _ = mpu6050::Mpu6050::new(Lent(&mut self.imu_bus)).init(&mut Lent(&mut delay));
        self.imu_bus.time.set_ns(IMU_START_NS);
        let _ = Mpu6050Driver::new(&mut self.imu_bus, ADDRESS).configure(&CONFIG);
        self.imu_bus.time.forget_longest();
        self.spi_time.forget_longest();
        self.agenda.set(Event::Timer, BOOT_NS);
        self.agenda.set(Event::Beat, BOOT_NS);
        self.agenda.set(Event::Gauge, BOOT_NS);
        self.agenda.set(Event::ImuMissed, self.imu_line.due_ns());
        self.watch_imu();
        self.watch_chips();
        self.receive_next_frame();
    }

    /// Runs to an instant; chips break on the way when a script says so.
    pub(crate) fn run_until(&mut self, until_ns: u64) {
        while let Some(strike) = self.strikes.before(until_ns) {
            self.run_on(strike.at_ns);
            strike.strike(self.now_ns, self);
            self.watch_imu();
            self.watch_chips();
        }
        self.run_on(until_ns);
    }

    fn run_on(&mut self, until_ns: u64) {
        while let Some((at_ns, event)) = self.agenda.take(until_ns) {
            // What a bus did ahead of time is noted at its own instant, never before now.
            self.now_ns = self.now_ns.max(at_ns);
            self.vectors.now = clock(self.now_ns);
            match event {
                Event::ImuInterrupt => self.on_imu_interrupt(),
                Event::ImuMissed => self.on_imu_missed(),
                Event::DieInterrupt => self.on_die_interrupt(),
                Event::Burst => self.on_burst(),
                Event::Repaired => self.on_repaired(),
                Event::Hyperperiod | Event::LateHyperperiod => self.on_hyperperiod(),
                Event::Timer => self.on_timer(),
                Event::Chips => self.on_chips(),
                Event::Frame => self.on_frame(),
                Event::Beat => self.on_beat(),
                Event::Gauge => self.on_gauge(),
                Event::Refit => self.on_refit(),
            }
        }
        self.now_ns = self.now_ns.max(until_ns);
    }

    /// The soonest that control may run again, ns: what is under way leads to no run before.
    pub(crate) fn soonest_run_ns(&self) -> u64 {
        let due_ns = |event| self.agenda.due_ns(event);
        let sample_ns = due_ns(Event::ImuInterrupt).min(due_ns(Event::ImuMissed));
        let sample_ns = sample_ns.saturating_add(SHORTEST_BURST_NS);
        let soonest = [
            sample_ns
                .min(due_ns(Event::Burst))
                .saturating_add(ARRIVAL_NS),
            due_ns(Event::Hyperperiod),
            due_ns(Event::LateHyperperiod),
            due_ns(Event::Timer),
            due_ns(Event::Chips),
        ];
        soonest.into_iter().fold(u64::MAX, u64::min)
    }

    /// The longest time since the start that a task kept a bus, ns.
    pub(crate) fn longest_transfer_ns(&self) -> u64 {
        let imu_ns = self.imu_bus.time.longest_ns();
        imu_ns.max(self.spi_time.longest_ns())
    }

    /// Takes every call so far, without room for them being looked for anew.
    pub(crate) fn drain_calls(&mut self) -> impl Iterator<Item = Stamped> {
        self.pilot.recorder().0.drain(..)
    }

    /// Everything that was called so far.
    pub(crate) fn calls(&mut self) -> &[Stamped] {
        &self.pilot.recorder().0
    }

    /// Everything that was called so far; later calls begin anew.
    pub(crate) fn take_calls(&mut self) -> Vec<Stamped> {
        std::mem::take(&mut self.pilot.recorder().0)
    }

    /// Chips, the inertial sensor's bus and fits break when a script says so.
    pub(crate) fn disturb(&mut self, faults: &Script) {
        let with = |effect: Effect| {
            faults
                .iter()
                .copied()
                .filter(move |fault| fault.effect == effect)
        };
        self.strikes = Strikes::of(faults);
        self.imu_bus.silences = with(SILENCE).collect();
        self.unfit = with(Effect::Unfit).collect();
        self.imu_line.stuck = (faults.iter().copied())
            .filter(|fault| matches!(fault.effect, Effect::Bus(Disturbance::LineHeld { .. })))
            .collect();
    }

    /// No fit succeeds now.
    pub(super) fn is_unfit(&self) -> bool {
        self.unfit.iter().any(|fault| fault.holds(self.now_ns))
    }

    /// Sends a frame, behind those that were given before.
    pub(crate) fn transmit(&mut self, frame: LinkFrame) {
        self.link.port().push(frame);
        if self.link.port().is_idle() {
            self.receive_next_frame();
        }
    }

    pub(super) fn watch_imu(&mut self) {
        self.agenda.set(Event::ImuInterrupt, self.imu.next_ns());
    }

    /// What is seen of the chips with clocks of their own now.
    pub(crate) fn look_at_chips(&self) -> OfChips<ChipState> {
        let look = |wire: &DieWire| wire.with(|wired| ChipState::from(wired.chip.as_ref()));
        self.dies.each_ref().map(look)
    }

    pub(super) fn watch_chips(&mut self) {
        let next_ns = self.dies.iter().map(Wire::next_ns).fold(u64::MAX, u64::min);
        self.agenda.set(Event::DieInterrupt, next_ns);
    }
}

impl Struck for NativeBoard {
    fn imu(&mut self, work: &mut dyn FnMut(&mut Mpu6050)) {
        self.imu.with(|wired| work(&mut wired.chip));
    }

    fn die(&mut self, place: usize, work: &mut dyn FnMut(&mut dyn OwnClock)) {
        self.dies[place].with(|wired| work(wired.chip.as_mut()));
    }
}
