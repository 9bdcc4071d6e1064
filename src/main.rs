//! Reflex on the STM32F427: RTIC tasks that stamp, move bytes, call the autopilot.
//!
//! Higher priorities preempt lower ones; RTIC's locks bound how long one may be held up. Every
//! decision is taken behind the one door `Autopilot::on_*`, which a host can open as well.
//!
//! | task | bound to | priority | budget | shared | when late |
//! |---|---|---|---|---|---|
//! | `imu_ready`, `imu_due` | EXTI0, TIM2 | 6 | 2 us | `imu_line`, `imu_bus` | the sample's stamp is late by as much |
//! | `accel_threshold`, `mag_event` | EXTI1, EXTI2 | 6 | 1 us | `fetches` | as above |
//! | `imu_step` | I2C1_EV | 5 | 1 us | `imu_bus` | the bus waits, the burst takes longer |
//! | `imu_failed` | I2C1_ER | 5 | 2 us | `imu_bus` | as above |
//! | `imu_received` | DMA1_STREAM0 | 4 | 20 us | `imu_bus`, `autopilot` | the hyperperiod ends late |
//! | `hyperperiod` | CAN2_TX, pended | 4 | 200 us | `autopilot`, `motors` | the command is older; the next sample waits |
//! | `late_hyperperiod` | CAN1_RX1, timer | 4 | 5 us | - | a missing sample is noticed later |
//! | `failsafe` | CAN1_RX1, timer | 4 | 200 us | `autopilot`, `motors`, `imu_bus` | 270 ms: the watchdog resets the board |
//! | `chips` | CAN2_RX0, pended | 3 | 100 us an order | `autopilot`, `fetches` | a threshold is older; the next order waits |
//! | `link_idle`, `link_half` | USART2, DMA1_STREAM5 | 2 | 50 us a frame | `link`, `autopilot` | 5 ms: the ring overruns, counted |
//! | `link_sent` | DMA1_STREAM6 | 2 | 2 us | `link` | answers wait |
//! | `heartbeat` | CAN1_RX0, timer | 2 | 20 us a second | `link`, `autopilot` | the peer sees it late |
//! | `repair_imu` | CAN1_TX, spawned | 1 | 5 ms | `imu_bus` | the chip stays silent, the drone disarmed or on failsafe |
//! | `idle` | - | 0 | - | `autopilot`, `link` | models are refitted, events logged, settings stored later |
//!
//! Spare vectors raise tasks by software; a pend, unlike a spawn, is not lost while the task runs.
//! `autopilot` is locked at priority 4 at most: control holds up neither stamps nor bursts. The log
//! does, by microseconds: idle formats a line with interrupts masked.
#![cfg_attr(target_os = "none", no_std, no_main)]
// A part of the board that is given to no task is a forgotten task.
#![deny(unused)]

#[cfg(target_os = "none")]
mod board;

/// On a computer there is nothing to fly: prints the configuration that is built in.
#[cfg(not(target_os = "none"))]
fn main() {
    print!("{}", reflex::config::describe());
}

#[cfg(target_os = "none")]
#[rtic::app(device = stm32f4xx_hal::pac, dispatchers = [CAN1_TX, CAN1_RX0, CAN1_RX1])]
mod app {
    use crate::board::guarded::{Guarded, Piloted};
    use crate::board::{
        self, ChipLine, Chips, Engine, Gauge, ImuLine, Keeper, Link, Motors, SIGNS, Sign, Started,
        Watchdog, calls, now, sleep_until,
    };
    use cortex_m::singleton;
    use defmt_rtt as _;
    use reflex::app::Autopilot;
    use reflex::tasks::chips::{self as owner, Fetches};
    use reflex::tasks::{Board, Lock, Task, control, imu, link};
    use reflex::time::Instant;
    use rtic::Mutex;
    use stm32f4xx_hal::pac::Interrupt;

    const HYPERPERIOD: Interrupt = Interrupt::CAN2_TX;
    const CHIPS: Interrupt = Interrupt::CAN2_RX0;

    /// The autopilot with its call log.
    pub type Pilot = Autopilot<calls::Calls>;

    /// The board as the portable tasks see it: its clock, and a vector for each of them.
    struct Vectors;

    impl Board for Vectors {
        fn now(&mut self) -> Instant {
            now()
        }

        fn raise(&mut self, task: Task) {
            match task {
                Task::Hyperperiod => rtic::pend(HYPERPERIOD),
                Task::Chips => rtic::pend(CHIPS),
                Task::RepairImu => drop(repair_imu::spawn()), // One under way will do.
                Task::Idle => board::idle::raise(),
            }
        }

        fn raise_hyperperiod_at(&mut self, at: Instant) {
            let _ = late_hyperperiod::spawn(at);
        }
    }

    #[shared]
    struct Shared {
        autopilot: &'static mut Pilot,
        motors: Motors,
        #[lock_free]
        imu_line: ImuLine,
        imu_bus: Engine,
        fetches: Fetches,
        link: Link,
    }

    #[local]
    struct Local {
        accel_line: ChipLine,
        mag_line: ChipLine,
        chips: Chips,
        gauge: Gauge,
        keeper: Keeper,
        watchdog: Watchdog,
    }

    #[init]
    fn init(cx: init::Context) -> (Shared, Local) {
        let board = board::start(cx.core, cx.device);
        let calls = calls::take().expect("taken once");
        failsafe::spawn().expect("spawned once");
        heartbeat::spawn().expect("spawned once");
        let shared = Shared {
            autopilot: pilot(&board, calls),
            motors: board.motors,
            imu_line: board.imu_line,
            imu_bus: board.imu_bus,
            fetches: Fetches::default(),
            link: board.link,
        };
        let [accel_line, mag_line] = board.chip_lines;
        let local = Local {
            accel_line,
            mag_line,
            chips: board.chips,
            gauge: board.gauge,
            keeper: board.keeper,
            watchdog: board.watchdog,
        };
        (shared, local)
    }

    /// In a frame of its own: the 4 KiB of stack do not add to those of the board's start.
    #[inline(never)]
    fn pilot(board: &Started, calls: calls::Calls) -> &'static mut Pilot {
        let pilot = singleton!(: Pilot = Autopilot::new(&board.start, &board.mixer, calls));
        let pilot = pilot.expect("made once");
        pilot.on_reset(now(), &board.reset);
        pilot.on_store(now(), board.keeper.found());
        pilot
    }

    /// Stamps the MPU6050's sample and starts its burst.
    #[task(binds = EXTI0, priority = 6, shared = [imu_line, imu_bus])]
    fn imu_ready(mut cx: imu_ready::Context) {
        let edge = cx.shared.imu_line.heard();
        cx.shared.imu_bus.lock(|bus| bus.on_edge(edge));
    }

    /// Hears the line again after one that came too soon; starts a burst for one that stays away.
    #[task(binds = TIM2, priority = 6, shared = [imu_line, imu_bus])]
    fn imu_due(mut cx: imu_due::Context) {
        let edge = cx.shared.imu_line.on_timer();
        (cx.shared.imu_bus).lock(|bus| edge.map(|edge| bus.on_edge(edge)));
    }

    /// The LSM303AGR's accelerometer interrupts.
    #[task(binds = EXTI1, priority = 6, local = [accel_line], shared = [fetches])]
    fn accel_threshold(cx: accel_threshold::Context) {
        announced(cx.local.accel_line, cx.shared.fetches);
    }

    /// The LSM303AGR's magnetometer interrupts.
    #[task(binds = EXTI2, priority = 6, local = [mag_line], shared = [fetches])]
    fn mag_event(cx: mag_event::Context) {
        announced(cx.local.mag_line, cx.shared.fetches);
    }

    /// Stamps the interrupt of a sensor with a clock of its own and asks for its sample.
    fn announced((input, line): &mut ChipLine, fetches: impl Mutex<T = Fetches>) {
        owner::announced(&mut Vectors, &mut Guarded(fetches), *input, line.heard());
    }

    /// One step of a burst.
    #[task(binds = I2C1_EV, priority = 5, shared = [imu_bus])]
    fn imu_step(mut cx: imu_step::Context) {
        cx.shared.imu_bus.lock(|bus| bus.on_event());
    }

    /// A burst failed on the bus.
    #[task(binds = I2C1_ER, priority = 5, shared = [imu_bus])]
    fn imu_failed(mut cx: imu_failed::Context) {
        cx.shared.imu_bus.lock(|bus| bus.on_error());
    }

    /// A burst or a check is there, or was cut off.
    #[task(binds = DMA1_STREAM0, priority = 4, shared = [imu_bus, autopilot])]
    fn imu_received(mut cx: imu_received::Context) {
        let Some(report) = cx.shared.imu_bus.lock(|bus| bus.report()) else {
            return;
        };
        let mut autopilot = Piloted(cx.shared.autopilot);
        if let Some(difference) = imu::received(&mut Vectors, &mut autopilot, &report) {
            board::imu::warn(&difference);
        }
    }

    /// The hyperperiod's end: propagates, writes the motors; the chips' thresholds follow.
    #[task(binds = CAN2_TX, priority = 4, shared = [autopilot, motors])]
    fn hyperperiod(cx: hyperperiod::Context) {
        let (autopilot, motors) = (cx.shared.autopilot, cx.shared.motors);
        control::hyperperiod(&mut Vectors, &mut Piloted(autopilot), &mut Guarded(motors));
        Vectors.raise(Task::Idle);
    }

    /// Ends a hyperperiod in which a gating sample is missing.
    #[task(priority = 4)]
    async fn late_hyperperiod(_: late_hyperperiod::Context, at: Instant) {
        sleep_until(at).await;
        rtic::pend(HYPERPERIOD);
    }

    /// Runs control where nothing else did, feeds the watchdog, looks after the MPU6050.
    #[task(priority = 4, local = [watchdog], shared = [autopilot, motors, imu_bus])]
    async fn failsafe(cx: failsafe::Context) {
        let mut autopilot = Piloted(cx.shared.autopilot);
        let (mut motors, mut bus) = (Guarded(cx.shared.motors), Guarded(cx.shared.imu_bus));
        loop {
            let next = control::failsafe(&mut Vectors, &mut autopilot, &mut motors, &mut bus);
            cx.local.watchdog.heed(&mut autopilot);
            sleep_until(next).await;
        }
    }

    /// Owner of the SPI bus: samples first, then orders; after a failure it waits to be raised.
    #[task(binds = CAN2_RX0, priority = 3, local = [chips], shared = [autopilot, fetches])]
    fn chips(cx: chips::Context) {
        let (mut pilot, mut fetches) = (Piloted(cx.shared.autopilot), Guarded(cx.shared.fetches));
        owner::serve(&mut Vectors, &mut fetches, &mut pilot, cx.local.chips);
        SIGNS.give(Sign::Chips);
    }

    /// The serial line fell idle: takes what came.
    #[task(binds = USART2, priority = 2, shared = [link, autopilot])]
    fn link_idle(cx: link_idle::Context) {
        let (mut link, mut autopilot) = (Guarded(cx.shared.link), Piloted(cx.shared.autopilot));
        link::receive(&mut Vectors, &mut link, &mut autopilot);
    }

    /// Half of the ring is full: takes what came.
    #[task(binds = DMA1_STREAM5, priority = 2, shared = [link, autopilot])]
    fn link_half(cx: link_half::Context) {
        let (mut link, mut autopilot) = (Guarded(cx.shared.link), Piloted(cx.shared.autopilot));
        link::receive(&mut Vectors, &mut link, &mut autopilot);
    }

    /// A block went out: sends the next.
    #[task(binds = DMA1_STREAM6, priority = 2, shared = [link])]
    fn link_sent(mut cx: link_sent::Context) {
        cx.shared.link.lock(|link| link.port().on_sent());
    }

    /// Measures the battery; once a second tells the peer that the drone is there, and its state.
    #[task(priority = 2, local = [gauge], shared = [link, autopilot])]
    async fn heartbeat(cx: heartbeat::Context) {
        let (mut link, mut autopilot) = (Guarded(cx.shared.link), Piloted(cx.shared.autopilot));
        loop {
            if let Some(counters) = link::beat(&mut Vectors, &mut link, &mut autopilot) {
                defmt::warn!("link: {}", counters);
            }
            SIGNS.give(Sign::Link);
            cx.local.gauge.watch(link::BEAT, &mut autopilot).await;
        }
    }

    /// Frees the I2C bus and configures the MPU6050 anew, or resets it; bursts pause meanwhile.
    #[task(priority = 1, local = [failed: bool = false], shared = [imu_bus])]
    async fn repair_imu(cx: repair_imu::Context) {
        let mut engine = cx.shared.imu_bus;
        if let Some((mut bus, remedy)) = engine.lock(|engine| engine.lend()) {
            let repaired = board::imu::repair(&mut bus, remedy, cx.local.failed).await;
            engine.lock(|engine| engine.give_back(bus, &repaired));
        }
    }

    /// Behind a run and the failsafe, ten times a second at least: refits models, stores, logs.
    #[idle(local = [keeper], shared = [autopilot, link])]
    fn idle(cx: idle::Context) -> ! {
        let (mut autopilot, mut link) = (Piloted(cx.shared.autopilot), Guarded(cx.shared.link));
        loop {
            board::idle::wait();
            SIGNS.give(Sign::Idle);
            if let Some(job) = autopilot.lock(|pilot| pilot.refit_due(now())) {
                let fit = job.fit();
                autopilot.lock(|pilot| pilot.on_refit(now(), fit));
                Vectors.raise(Task::Idle); // Another one may be due.
            }
            if let Some(sounding) = autopilot.lock(|pilot| pilot.sounding_due(now())) {
                for column in sounding.columns() {
                    autopilot.lock(|pilot| pilot.on_column(now(), column));
                }
                autopilot.lock(|pilot| pilot.on_sounded(now()));
            }
            (cx.local.keeper).keep(&mut Vectors, &mut autopilot, &mut link);
            board::log(|| autopilot.lock(|pilot| pilot.next_event()));
        }
    }
}
