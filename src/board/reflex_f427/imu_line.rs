//! The MPU6050's interrupt line, and a timer that knows when its next edge is due.
//!
//! TIM2 counts microseconds since the last edge that was heard. An edge sooner than a sample can come
//! is no sample's: the line is masked until one is due, so that a storm costs one such edge a sample. An
//! edge that stays away is made up for: the timer then asks for a burst at every sample's time, as a
//! broken wire is no reason to fly without a gyroscope.

use reflex::tasks::imu::{Edge, FIRST_MISSED_US, NEXT_DUE_US, SAMPLE_US, SOONEST_US};
use stm32f4xx_hal::gpio::PC0;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::board::lines::Line;
use crate::board::now;

/// 84 MHz of the timers on APB1 to 1 MHz, less one.
const PRESCALER: u16 = 83;

/// The line with its timer.
pub struct ImuLine {
    line: Line<PC0>,
    exti: pac::EXTI,
    timer: pac::TIM2,
    /// Edges stay away.
    dead: bool,
}

impl ImuLine {
    /// Counts from now on.
    pub fn new(line: Line<PC0>, exti: pac::EXTI, timer: pac::TIM2, rcc: &mut Rcc) -> Self {
        pac::TIM2::enable(rcc);
        pac::TIM2::reset(rcc);
        timer.psc().write(|w| w.psc().set(PRESCALER));
        timer.ccr1().write(|w| w.ccr().set(NEXT_DUE_US));
        timer.ccr2().write(|w| w.ccr().set(FIRST_MISSED_US));
        // Only an overflow raises the update flag, and takes 71 minutes to come.
        timer
            .cr1()
            .write(|w| w.urs().counter_only().cen().enabled());
        timer.dier().write(|w| w.cc2ie().enabled());
        timer.egr().write(|w| w.ug().update());
        // The first edge may come at once.
        timer.cnt().write(|w| w.cnt().set(SOONEST_US));
        Self {
            line,
            exti,
            timer,
            dead: false,
        }
    }

    fn count_anew(&self) {
        self.timer.egr().write(|w| w.ug().update());
    }

    /// An edge.
    #[inline]
    pub fn heard(&mut self) -> Edge {
        let at = self.line.heard();
        if self.timer.cnt().read().bits() < SOONEST_US && !self.dead {
            self.line.mask(&mut self.exti);
            self.timer.sr().write(|w| w.cc1if().clear());
            self.timer
                .dier()
                .write(|w| w.cc1ie().enabled().cc2ie().enabled());
            return Edge::TooSoon(at);
        }
        self.count_anew();
        if self.dead {
            self.dead = false;
            self.timer.ccr2().write(|w| w.ccr().set(FIRST_MISSED_US));
        }
        Edge::Sample(at)
    }

    /// The timer: an edge is due, or was missed.
    pub fn on_timer(&mut self) -> Option<Edge> {
        let at = now();
        // The flags are cleared by a zero: by the next edge that is due, too.
        self.timer.sr().write(|w| w.cc1if().clear().cc2if().clear());
        if self.timer.dier().read().cc1ie().is_enabled() {
            self.timer.dier().write(|w| w.cc2ie().enabled());
            self.line.unmask(&mut self.exti);
        }
        let due_us = if self.dead {
            SAMPLE_US
        } else {
            FIRST_MISSED_US
        };
        // Else an edge came at the same time, or is only due.
        if self.timer.cnt().read().bits() < due_us {
            return None;
        }
        self.count_anew();
        let first = !self.dead;
        self.dead = true;
        self.timer.ccr2().write(|w| w.ccr().set(SAMPLE_US));
        Some(Edge::Missed { at, first })
    }
}
