//! Motor pulses: TIM3 drives motors 1 to 4, TIM4 motors 5 to 8.
//!
//! Compare registers are preloaded: a command takes effect at the timer's next update event, so
//! no pulse is ever cut. Both timers count 84 MHz of APB1, divided as the protocol asks, and start
//! together, so that their update events coincide but for a few clocks. A channel without a motor
//! stays low.
//!
//! [`stop`] needs nothing but the registers: it is what a fault does first.

use core::sync::atomic::{AtomicU32, Ordering};

use reflex::airframe::{MotorShares, period_ticks, ticks};
use reflex::safety::MotorOutput;
use reflex::settings::{MOST_MOTORS, MotorProtocol};
use reflex::tasks::control;
use stm32f4xx_hal::pac::{self, tim3};
use stm32f4xx_hal::rcc::{self, Enable, Reset};

/// Channels of one timer.
const CHANNELS: usize = 4;

/// What [`stop`] writes: ticks of the shortest pulse, above them how many motors; 0 before the start.
static STOPPED: AtomicU32 = AtomicU32::new(0);
/// Where the number of motors is in it.
const MOTORS_AT: u32 = 16;

/// Clock of both timers while the crystal lives, and once the processor runs without it, in MHz.
const TIMER_MHZ: u32 = 84;
const TIMER_MHZ_WITHOUT_CRYSTAL: u32 = 16;

/// The timers; made with all motors at the shortest pulse.
pub struct Motors {
    first: pac::TIM3,
    second: pac::TIM4,
    protocol: MotorProtocol,
}

impl Motors {
    /// Starts the pulses; the pins must be in their alternate function.
    pub fn start(
        first: pac::TIM3,
        second: pac::TIM4,
        protocol: MotorProtocol,
        motors: usize,
        rcc: &mut rcc::Rcc,
    ) -> Self {
        pac::TIM3::enable(rcc);
        pac::TIM3::reset(rcc);
        let has_second = motors > CHANNELS;
        let stopped = MotorShares::all(0.0, motors);
        let mut motors = Self {
            first,
            second,
            protocol,
        };
        if has_second {
            pac::TIM4::enable(rcc);
            pac::TIM4::reset(rcc);
        }
        motors.store(&stopped);
        let shortest = ticks(protocol, 0.0);
        STOPPED.store(
            u32::from(shortest) | (stopped.len() as u32) << MOTORS_AT,
            Ordering::Relaxed,
        );
        prepare(&motors.first, protocol);
        if has_second {
            prepare(&motors.second, protocol);
        }
        count(&motors.first);
        if has_second {
            count(&motors.second);
        }
        motors
    }

    fn store(&mut self, shares: &MotorShares) {
        let mut pulses = [0; MOST_MOTORS];
        for (pulse, share) in pulses.iter_mut().zip(shares.iter()) {
            *pulse = ticks(self.protocol, *share);
        }
        let mut pulses = pulses.into_iter().take(shares.len());
        for (register, pulse) in self.first.ccr_iter().zip(&mut pulses) {
            register.write(|w| w.ccr().set(pulse));
        }
        for (register, pulse) in self.second.ccr_iter().zip(pulses) {
            register.write(|w| w.ccr().set(pulse));
        }
    }
}

impl control::Motors for Motors {
    /// Writes the whole vector; it takes effect at the next update event.
    ///
    /// The arithmetic comes first: the stores are back to back, so that an update event finds
    /// either none or all of them but for a share of 10^-4 of its period.
    fn write(&mut self, output: &MotorOutput) {
        self.store(&output.share());
    }
}

/// Up-counting PWM mode 1 with preload on all four channels, ready to count.
fn prepare(timer: &tim3::RegisterBlock, protocol: MotorProtocol) {
    let (divider, period) = period_ticks(protocol);
    timer.psc().write(|w| w.psc().set(divider - 1));
    timer.arr().write(|w| w.arr().set(period - 1));
    timer.ccmr1_output().write(|w| {
        w.oc1m().pwm_mode1().oc1pe().enabled();
        w.oc2m().pwm_mode1().oc2pe().enabled()
    });
    timer.ccmr2_output().write(|w| {
        w.oc3m().pwm_mode1().oc3pe().enabled();
        w.oc4m().pwm_mode1().oc4pe().enabled()
    });
    timer.ccer().write(|w| {
        w.cc1e().set_bit().cc2e().set_bit();
        w.cc3e().set_bit().cc4e().set_bit()
    });
    // Loads prescaler, period and the shortest pulses before the first count.
    timer.egr().write(|w| w.ug().set_bit());
}

/// Starts the first period.
fn count(timer: &tim3::RegisterBlock) {
    timer.cr1().write(|w| w.arpe().enabled().cen().enabled());
}

/// Has all motors get the shortest pulse, from the next update event on.
///
/// Only for the end of the firmware: it takes the timers from the task that owns them.
pub fn stop() {
    let (motors, shortest) = stopped();
    set(motors, shortest);
}

/// As [`stop`], at once, where the crystal stopped: the processor goes on with its own oscillator,
/// and pulses would be ten times as long.
pub fn stop_without_crystal() {
    let (motors, shortest) = stopped();
    // SAFETY: as in `set`; the prescaler of APB1 matters to the motors' timers alone from here on.
    let rcc = unsafe { &*pac::RCC::PTR };
    rcc.cfgr().modify(|_, w| w.ppre1().div1());
    let slowed = |ticks: u32| (ticks * TIMER_MHZ_WITHOUT_CRYSTAL / TIMER_MHZ) as u16;
    let mut divider = 1;
    for timer in running(motors) {
        divider = timer.psc().read().psc().bits() + 1;
        let period = u32::from(divider) * (u32::from(timer.arr().read().arr().bits()) + 1);
        timer.psc().write(|w| w.psc().set(0));
        timer.arr().write(|w| w.arr().set(slowed(period) - 1));
    }
    set(motors, slowed(u32::from(divider) * u32::from(shortest)));
    for timer in running(motors) {
        timer.egr().write(|w| w.ug().set_bit());
    }
}

/// How many motors there are, and the ticks of their shortest pulse.
fn stopped() -> (usize, u16) {
    let stopped = STOPPED.load(Ordering::Relaxed);
    ((stopped >> MOTORS_AT) as usize, stopped as u16)
}

/// The timers that run.
fn running(motors: usize) -> impl Iterator<Item = &'static tim3::RegisterBlock> {
    // SAFETY: both timers are there for as long as the processor is; their owner, whom this
    // preempted, is not returned to.
    let timers = unsafe { [&*pac::TIM3::PTR, &*pac::TIM4::PTR] };
    timers.into_iter().take(motors.div_ceil(CHANNELS))
}

fn set(motors: usize, pulse: u16) {
    let registers = running(motors).flat_map(|timer| timer.ccr_iter());
    for register in registers.take(motors) {
        register.write(|w| w.ccr().set(pulse));
    }
}
