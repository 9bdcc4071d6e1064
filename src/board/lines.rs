//! External interrupt lines: rising edges of pins.

use stm32f4xx_hal::gpio::{Edge, ExtiPin};
use stm32f4xx_hal::pac;
use stm32f4xx_hal::syscfg::SysCfg;

/// Takes note that an external interrupt was heard, so that the next edge can raise it again.
///
/// `line` is the pin's number within its port.
pub fn acknowledge(line: impl Into<u8>) {
    let line = line.into();
    // SAFETY: one store to a register in which ones clear and zeroes do nothing.
    unsafe { (*pac::EXTI::ptr()).pr().write(|w| w.bits(1 << line)) };
}

/// Has a pin's rising edge raise its external interrupt.
pub fn interrupt_on_rise(mut pin: impl ExtiPin, (routing, exti): &mut (SysCfg, pac::EXTI)) {
    pin.make_interrupt_source(routing);
    pin.trigger_on_edge(exti, Edge::Rising);
    pin.enable_interrupt(exti);
}
