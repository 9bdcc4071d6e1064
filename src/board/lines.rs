//! External interrupt lines: rising edges of pins.

use reflex::time::Instant;
use stm32f4xx_hal::gpio::{Edge, ExtiPin};
use stm32f4xx_hal::pac;
use stm32f4xx_hal::syscfg::SysCfg;

use super::clock::now;

/// A pin whose rising edges interrupt: owned by the task that is bound to its vector.
pub struct Line<P>(P);

impl<P: ExtiPin> Line<P> {
    /// Has a pin's rising edge raise its external interrupt.
    pub fn on_rise(mut pin: P, (routing, exti): &mut (SysCfg, pac::EXTI)) -> Self {
        pin.make_interrupt_source(routing);
        pin.trigger_on_edge(exti, Edge::Rising);
        pin.enable_interrupt(exti);
        Self(pin)
    }

    /// The stamp of an edge that was heard; the next one can raise the interrupt again.
    pub fn heard(&mut self) -> Instant {
        let at = now();
        self.0.clear_interrupt_pending_bit();
        at
    }

    /// Lets no edge raise the interrupt.
    pub fn mask(&mut self, exti: &mut pac::EXTI) {
        self.0.disable_interrupt(exti);
    }

    /// Lets the next edge raise the interrupt, none of those meanwhile.
    pub fn unmask(&mut self, exti: &mut pac::EXTI) {
        self.0.clear_interrupt_pending_bit();
        self.0.enable_interrupt(exti);
    }
}
