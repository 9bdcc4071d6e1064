//! The tasks of the firmware's `main.rs`, played natively.
//!
//! Each function stands for the task of the same trigger; the table at the head of `main.rs` says
//! what they do and when. A bus transfer is played when it starts; what came of it reaches the
//! autopilot when it ends.

use embedded_hal::i2c::I2c;
use reflex::app::{ChipOrder, Fault, Next, OrderError};
use reflex::link::Incoming;
use reflex::sensors::Input;
use reflex::tasks::chips::{Chips, Obeyed, Sample};
use reflex::tasks::mpu6050::{CONFIG, reading};
use reflex::time::{Instant, span};
use reflex_drivers::mpu6050::{ADDRESS, BURST_LENGTH, BURST_START, CHECKS, LONGEST_CHECK, Mpu6050};

use super::agenda::Event;
use super::board::{Burst, NativeBoard};
use super::timing::{
    ARRIVAL_NS, BOOT_NS, BURST_START_NS, CHARACTER_NS, CHIPS_STEP_NS, REFIT_NS, RUN_NS, SILENCE,
    SLEEP, clock, nanos,
};

/// What the LSM303AGR's owner did on the bus, to be told when the bus is done.
#[derive(Clone, Copy, Debug)]
pub(super) enum Work {
    /// The sample of an interrupt with this stamp.
    Fetch(Instant, Result<Sample, OrderError>),
    /// An order, and the sample that belongs to it.
    Order(ChipOrder, Result<Obeyed, OrderError>),
}

impl NativeBoard {
    /// `imu_ready`: stamps the sample and starts its burst.
    pub(super) fn on_imu_line(&mut self) {
        if let Some(at_ns) = self.imu.hear(self.now_ns)
            && !self.agenda.is_noted(Event::Repaired)
        {
            self.start_burst(at_ns.max(BOOT_NS));
        }
        self.watch_imu();
    }

    fn start_burst(&mut self, at_ns: u64) {
        let at = clock(at_ns);
        if self.burst.is_some() {
            self.pilot.on_fault(at, Fault::ImuOverrun);
        }
        self.imu_bus.time.set_ns(at_ns + BURST_START_NS);
        let mut bytes = [0; BURST_LENGTH];
        let read = self
            .imu_bus
            .write_read(ADDRESS, &[BURST_START], &mut bytes)
            .is_ok();
        self.burst = Some(Burst {
            at,
            bytes: read.then_some(bytes),
        });
        self.agenda.set(Event::Burst, self.imu_bus.time.now_ns());
    }

    /// `imu_received`: a burst is there.
    pub(super) fn on_burst(&mut self) {
        let Some(Burst { at, bytes }) = self.burst.take() else {
            return;
        };
        self.last_burst_ns = self.now_ns;
        match bytes {
            Some(bytes) => match reading(&bytes) {
                Some(reading) => {
                    let next = self.pilot.on_imu(at, &reading);
                    self.raise(next, ARRIVAL_NS);
                }
                None => self.pilot.on_fault(at, Fault::ImuStale),
            },
            None => self.pilot.on_fault(clock(self.now_ns), Fault::ImuBus),
        }
        self.check_imu();
        self.look_for_refit();
    }

    /// The register check behind a burst, asked for by the failsafe's task.
    fn check_imu(&mut self) {
        if !std::mem::take(&mut self.imu_check_due) {
            return;
        }
        let check = CHECKS[self.imu_check % CHECKS.len()];
        self.imu_check += 1;
        self.imu_bus.time.set_ns(self.now_ns);
        let mut held = [0; LONGEST_CHECK];
        let into = &mut held[..usize::from(check.length)];
        let read = self.imu_bus.write_read(ADDRESS, &[check.register], into);
        let at = clock(self.now_ns);
        if read.is_err() {
            self.pilot.on_fault(at, Fault::ImuBus);
        } else if check.difference(&CONFIG, held).is_some() {
            self.pilot.on_fault(at, Fault::ImuConfiguration);
            self.repair_imu();
        }
        self.watch_imu();
    }

    /// `repair_imu`: configures the MPU6050 anew; bursts pause meanwhile.
    fn repair_imu(&mut self) {
        if self.agenda.is_noted(Event::Repaired) {
            return;
        }
        self.burst = None;
        self.imu_bus.time.set_ns(self.now_ns);
        let mut chip = Mpu6050::new(&mut self.imu_bus, ADDRESS);
        let configured = chip.check_identity().and_then(|()| chip.configure(&CONFIG));
        let done_ns = self.imu_bus.time.now_ns();
        if configured.is_err() {
            self.pilot.on_fault(clock(done_ns), Fault::ImuBus);
        }
        self.agenda.set(Event::Repaired, done_ns);
        self.watch_imu();
    }

    /// The bus came back: silence is counted from here.
    pub(super) fn on_repaired(&mut self) {
        self.last_burst_ns = self.now_ns;
    }

    /// `hyperperiod`: propagates; the chips' thresholds follow.
    pub(super) fn on_hyperperiod(&mut self) {
        if self.pilot.on_hyperperiod(clock(self.now_ns)).is_some() {
            self.raise_chips(RUN_NS);
        }
    }

    /// `failsafe`: runs control where nothing else did, looks after the MPU6050.
    pub(super) fn on_timer(&mut self) {
        let time = clock(self.now_ns);
        let ran = self.pilot.deadline() <= time && self.pilot.on_timer(time).is_some();
        self.raise_chips(if ran { RUN_NS } else { CHIPS_STEP_NS });
        self.imu_check_due = true;
        if span(clock(self.last_burst_ns), time) > SILENCE {
            self.repair_imu();
        }
        self.look_for_refit();
        let (soonest, latest) = (time + SLEEP.0, time + SLEEP.1);
        let wake = self.pilot.deadline().clamp(soonest, latest);
        self.agenda.set(Event::Timer, nanos(wake));
    }

    /// `accel_threshold`: stamps an interrupt and asks for its sample.
    pub(super) fn on_accel_line(&mut self) {
        if let Some(at_ns) = self.accel.hear(self.now_ns) {
            self.accel_fetch = Some(clock(at_ns.max(BOOT_NS)));
            self.raise_chips(CHIPS_STEP_NS);
        }
        self.watch_chips();
    }

    /// `mag_event`: as the accelerometer's.
    pub(super) fn on_mag_line(&mut self) {
        if let Some(at_ns) = self.mag.hear(self.now_ns) {
            self.mag_fetch = Some(clock(at_ns.max(BOOT_NS)));
            self.raise_chips(CHIPS_STEP_NS);
        }
        self.watch_chips();
    }

    /// Raises the LSM303AGR's owner.
    fn raise_chips(&mut self, after_ns: u64) {
        if self.work.is_some() {
            self.raised_again = true;
        }
        let at_ns = self.now_ns.max(BOOT_NS) + after_ns;
        self.agenda.pend(Event::Chips, at_ns);
    }

    /// `chips`: samples first, then orders; after a failure it waits to be raised.
    pub(super) fn on_chips(&mut self) {
        let failed = match self.work.take() {
            Some(work) => self.report(&work),
            None => false,
        };
        let raised_again = std::mem::take(&mut self.raised_again);
        if !failed || raised_again {
            self.work = self.next_work();
        }
        if self.work.is_some() {
            self.agenda.set(Event::Chips, self.spi_time.now_ns());
        }
        self.watch_chips();
    }

    fn next_work(&mut self) -> Option<Work> {
        self.spi_time.set_ns(self.now_ns + CHIPS_STEP_NS);
        let accel = self.accel_fetch.take().map(|at| (Input::ChipAccel, at));
        let fetch = accel.or_else(|| self.mag_fetch.take().map(|at| (Input::ChipMag, at)));
        if let Some((input, at)) = fetch {
            return Some(Work::Fetch(at, self.chips.fetch(input)));
        }
        let order = self.pilot.next_order()?;
        Some(Work::Order(order, self.chips.execute(order)))
    }

    /// Tells the autopilot what came of work on the bus; true where an order failed.
    fn report(&mut self, work: &Work) -> bool {
        let now = clock(self.now_ns);
        match work {
            Work::Fetch(at, Ok(sample)) => {
                let next = sample.deliver(&mut self.pilot, *at);
                self.raise(next, 0);
                false
            }
            Work::Fetch(at, Err(_)) => {
                self.pilot.on_fault(*at, Fault::ChipBus);
                false
            }
            Work::Order(order, done) => {
                if let Ok(Some(sample)) = done.map(|obeyed| obeyed.sample) {
                    let next = sample.deliver(&mut self.pilot, now);
                    self.raise(next, 0);
                }
                let answer = done.map(|obeyed| obeyed.setting);
                self.pilot.on_order_done(now, *order, answer);
                done.is_err()
            }
        }
    }

    /// `link_idle`: takes the frame that came; answers are not sent.
    pub(super) fn on_frame(&mut self) {
        if let Some(frame) = self.frame.take() {
            let at = clock(self.now_ns);
            let spoilt = self.parser.counters().spoilt();
            let messages: Vec<_> = self.parser.feed(at, &frame.bytes).collect();
            for incoming in messages {
                if let Incoming::Message { message, .. } = incoming {
                    let (next, _) = self.pilot.on_message(at, &message);
                    self.raise(next, 0);
                }
            }
            if self.parser.counters().spoilt() != spoilt {
                self.pilot.on_fault(at, Fault::LinkFrame);
            }
        }
        self.receive_next_frame();
    }

    /// Waits for the next frame; those sent before the receiver was there are lost.
    pub(super) fn receive_next_frame(&mut self) {
        let frame = loop {
            match self.frames.pop_front() {
                Some(frame) if frame.at_ns >= BOOT_NS => break frame,
                Some(_) => {}
                None => return,
            }
        };
        let start_ns = frame.at_ns.max(self.line_free_ns);
        self.line_free_ns = start_ns + frame.bytes.len() as u64 * CHARACTER_NS;
        // The receiver takes the line for idle after one character more, and tells after another.
        self.agenda
            .set(Event::Frame, self.line_free_ns + 2 * CHARACTER_NS);
        self.frame = Some(frame);
    }

    /// `idle`: fits where a refit is due; the fit is swapped in when it would be done.
    fn look_for_refit(&mut self) {
        if self.refit.is_none()
            && let Some(job) = self.pilot.refit_due(clock(self.now_ns))
        {
            self.refit = Some(job.fit());
            self.agenda.set(Event::Refit, self.now_ns + REFIT_NS);
        }
    }

    /// `idle`: swaps a fit in.
    pub(super) fn on_refit(&mut self) {
        if let Some(refit) = self.refit.take() {
            self.pilot.on_refit(clock(self.now_ns), refit);
        }
    }

    /// Does what a sample or a message asked for.
    fn raise(&mut self, next: Next, after_ns: u64) {
        match next {
            Next::Wait => {}
            Next::Hyperperiod => self.agenda.pend(Event::Hyperperiod, self.now_ns + after_ns),
            // Where one is awaited already, that one or the failsafe ends this one too.
            Next::HyperperiodAt(at) => self.agenda.pend(Event::LateHyperperiod, nanos(at)),
        }
    }
}
