//! What each event of the native board runs: a firmware task, on modelled buses.
//!
//! A bus transfer is played when it starts; what came of it reaches the autopilot when it ends.

use embedded_hal::i2c::I2c;
use reflex::app::Fault;
use reflex::battery;
use reflex::reactive::Fit;
use reflex::sensors::Input;
use reflex::tasks::chips::{self, Work};
use reflex::tasks::imu::{self, Configure, Imu, Report};
use reflex::tasks::mpu6050::Sensor;
use reflex::tasks::{Unshared, control, link};
use reflex_drivers::mpu6050::{ADDRESS, BURST_LENGTH, BURST_START, LONGEST_CHECK};

use super::agenda::Event;
use super::board::{Burst, NativeBoard};
use super::timing::{
    ARRIVAL_NS, BOOT_NS, BURST_START_NS, CHIPS_STEP_NS, REFIT_NS, RUN_NS, clock, nanos,
};

impl NativeBoard {
    /// Stamps the sample and starts its burst.
    pub(super) fn on_imu_interrupt(&mut self) {
        if let Some(at_ns) = self.imu.hear(self.now_ns)
            && self.imu_line.hears(at_ns.max(BOOT_NS))
        {
            self.agenda.set(Event::ImuMissed, self.imu_line.due_ns());
            self.start_burst(at_ns.max(BOOT_NS));
        }
        self.watch_imu();
    }

    /// The line is dead: asks for a sample all the same.
    pub(super) fn on_imu_missed(&mut self) {
        if self.imu_line.misses(self.now_ns) {
            self.pilot.on_fault(self.vectors.now, Fault::ImuLine);
        }
        self.agenda.set(Event::ImuMissed, self.imu_line.due_ns());
        self.start_burst(self.now_ns);
    }

    fn start_burst(&mut self, at_ns: u64) {
        if self.agenda.is_noted(Event::Repaired) {
            return;
        }
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

    /// A burst is there; a check may follow it.
    pub(super) fn on_burst(&mut self) {
        let Some(Burst { at, bytes }) = self.burst.take() else {
            return;
        };
        let now = self.vectors.now;
        let report = match bytes {
            Some(bytes) if Sensor::is_new(&bytes) => {
                self.guard.hear(at);
                Report::Burst(at, bytes)
            }
            Some(_) => Report::Fault(at, Fault::ImuStale, self.guard.is_silent(at)),
            None => Report::Fault(now, Fault::ImuBus, self.guard.fail()),
        };
        self.report_imu(&report);
        if bytes.is_some()
            && let Some(check) = self.guard.check(at, || now)
        {
            self.imu_bus.time.set_ns(self.now_ns);
            let mut held = [0; LONGEST_CHECK];
            let into = &mut held[..usize::from(check.length)];
            let read = self.imu_bus.write_read(ADDRESS, &[check.register], into);
            self.report_imu(&match read {
                Ok(()) => Report::Check(check, held),
                Err(_) => Report::Fault(now, Fault::ImuBus, false),
            });
            self.watch_imu();
        }
        // The firmware looks for refits behind its runs, ten times a second at least: here they are
        // looked for as soon as they may be due.
        self.vectors.idle = true;
        self.dispatch(ARRIVAL_NS);
    }

    fn report_imu(&mut self, report: &Report<Sensor>) {
        imu::received(&mut self.vectors, &mut Unshared(&mut self.pilot), report);
    }

    /// Configures the MPU6050 anew; bursts pause meanwhile.
    fn repair_imu(&mut self) {
        if self.agenda.is_noted(Event::Repaired) {
            return;
        }
        self.burst = None;
        self.imu_bus.time.set_ns(self.now_ns);
        let configured = Sensor::configure(&mut self.imu_bus);
        let done_ns = self.imu_bus.time.now_ns();
        if configured.is_err() {
            self.pilot.on_fault(clock(done_ns), Fault::ImuBus);
        }
        self.agenda.set(Event::Repaired, done_ns);
        self.watch_imu();
    }

    /// The bus came back: silence is counted from here.
    pub(super) fn on_repaired(&mut self) {
        self.guard.hear(self.vectors.now);
    }

    pub(super) fn on_hyperperiod(&mut self) {
        let pilot = &mut Unshared(&mut self.pilot);
        control::hyperperiod(&mut self.vectors, pilot, &mut Unshared(&mut self.motors));
        self.dispatch(0);
    }

    pub(super) fn on_timer(&mut self) {
        let pilot = &mut Unshared(&mut self.pilot);
        let motors = &mut Unshared(&mut self.motors);
        let guard = &mut Unshared(&mut self.guard);
        let next = control::failsafe(&mut self.vectors, pilot, motors, guard);
        self.agenda.set(Event::Timer, nanos(next));
        self.dispatch(0);
    }

    /// Stamps an interrupt of a die with a clock of its own and asks for its sample.
    pub(super) fn on_die_interrupt(&mut self) {
        for (place, input) in Input::OF_CHIPS.into_iter().enumerate() {
            if let Some(at_ns) = self.dies[place].hear(self.now_ns) {
                self.ask_for_sample(input, at_ns);
            }
        }
        self.watch_chips();
    }

    fn ask_for_sample(&mut self, input: Input, at_ns: u64) {
        let (at, fetches) = (clock(at_ns.max(BOOT_NS)), &mut Unshared(&mut self.fetches));
        chips::announced(&mut self.vectors, fetches, input, at);
        self.dispatch(0);
    }

    /// The owner of the chips brings what it did, and begins the next piece of work.
    pub(super) fn on_chips(&mut self) {
        let pilot = &mut Unshared(&mut self.pilot);
        let failed = self
            .done
            .take()
            .is_some_and(|done| done.report(&mut self.vectors, pilot).is_err());
        let raised_again = std::mem::take(&mut self.raised_again);
        if !failed || raised_again {
            self.spi_time.set_ns(self.now_ns + CHIPS_STEP_NS);
            let work = Work::next(&mut Unshared(&mut self.fetches), pilot);
            self.done = work.map(|work| work.carry_out(&mut self.chips));
        }
        if self.done.is_some() {
            self.agenda.set(Event::Chips, self.spi_time.now_ns());
        }
        self.watch_chips();
        self.dispatch(0);
    }

    /// Takes the frame that came; answers are not sent.
    pub(super) fn on_frame(&mut self) {
        self.link.port().receive();
        let pilot = &mut Unshared(&mut self.pilot);
        link::receive(&mut self.vectors, &mut Unshared(&mut self.link), pilot);
        self.dispatch(0);
        self.receive_next_frame();
    }

    /// Measures the battery.
    pub(super) fn on_gauge(&mut self) {
        let now = self.vectors.now;
        self.pilot.on_battery(now, &self.gauge.look());
        self.agenda.set(Event::Gauge, nanos(now + battery::LOOK));
    }

    /// Says that the drone is there.
    pub(super) fn on_beat(&mut self) {
        let now = self.vectors.now;
        let pilot = &mut Unshared(&mut self.pilot);
        link::beat(&mut self.vectors, &mut Unshared(&mut self.link), pilot);
        self.agenda.set(Event::Beat, nanos(now + link::BEAT));
    }

    pub(super) fn receive_next_frame(&mut self) {
        if let Some(received_ns) = self.link.port().start_next() {
            self.agenda.set(Event::Frame, received_ns);
        }
    }

    /// Fits where a refit is due; the fit is swapped in when it would be done.
    fn look_for_refit(&mut self) {
        if self.refit.is_none()
            && let Some(job) = self.pilot.refit_due(self.vectors.now)
        {
            let mut refit = job.fit();
            if self.is_unfit() {
                refit.fit = Fit::Unfit;
            }
            self.refit = Some(refit);
            self.agenda.set(Event::Refit, self.now_ns + REFIT_NS);
        }
        if let Some(sounding) = self.pilot.sounding_due(self.vectors.now) {
            let now = self.vectors.now;
            for column in sounding.columns() {
                self.pilot.on_column(now, column);
            }
            self.pilot.on_sounded(now);
        }
    }

    /// Swaps a fit in.
    pub(super) fn on_refit(&mut self) {
        if let Some(refit) = self.refit.take() {
            self.pilot.on_refit(self.vectors.now, refit);
        }
    }

    /// Notes what the event raised, each as long after it as the firmware takes; a hyperperiod
    /// `after_ns`.
    fn dispatch(&mut self, after_ns: u64) {
        let now_ns = self.now_ns;
        let raised = self.vectors.take();
        if raised.hyperperiod {
            self.agenda.pend(Event::Hyperperiod, now_ns + after_ns);
        }
        if let Some(at) = raised.hyperperiod_at {
            self.agenda.pend(Event::LateHyperperiod, nanos(at));
        }
        let ran = std::mem::take(&mut self.motors.written);
        if raised.chips {
            self.raised_again |= self.done.is_some();
            let step_ns = if ran { RUN_NS } else { CHIPS_STEP_NS };
            self.agenda
                .pend(Event::Chips, now_ns.max(BOOT_NS) + step_ns);
        }
        if raised.repair_imu {
            self.repair_imu();
        }
        if raised.idle {
            self.look_for_refit();
        }
    }
}
