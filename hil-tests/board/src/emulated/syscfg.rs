//! SYSCFG, as far as it selects the ports behind the external interrupts.
//!
//! RM0090 section 9.2. The emulator's part only stores these registers. Here a
//! write while the clock is off is lost, as on silicon, and told to the run.

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::stm32f427::generated::syscfg::Register;

use super::exti::LINES;

const SELECTORS: [(Register, &str); 4] = [
    (Register::Exticr1, "EXTICR1"),
    (Register::Exticr2, "EXTICR2"),
    (Register::Exticr3, "EXTICR3"),
    (Register::Exticr4, "EXTICR4"),
];

/// What the run is told when a selector is written without a clock.
pub(super) const UNCLOCKED: &str =
    "is written while RCC_APB2ENR.SYSCFGEN is clear, so the write is lost";

/// The selectors, and whether their clock is on.
#[derive(Debug, Default)]
pub(super) struct Syscfg {
    /// Whether RCC_APB2ENR.SYSCFGEN is set, kept up by the part's wiring.
    pub(super) clocked: bool,
    /// Set by every write that may have changed a selector.
    pub(super) changed: bool,
    kept: [u64; SELECTORS.len()],
}

impl Syscfg {
    /// The port (A = 0) behind each external interrupt line.
    pub(super) fn ports(&self) -> [u8; LINES] {
        std::array::from_fn(|line| (self.kept[line / 4] >> (4 * (line % 4)) & 0xF) as u8)
    }
}

impl Device for Syscfg {
    type Register = Register;

    fn write(
        &mut self,
        register: Register,
        _value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let selector = SELECTORS
            .iter()
            .position(|(selector, _)| *selector == register);
        let Some(index) = selector else {
            return;
        };
        if self.clocked {
            self.kept[index] = registers.get(register);
            self.changed = true;
        } else {
            registers.set(register, self.kept[index]);
            context.tell(SELECTORS[index].1, UNCLOCKED);
        }
    }

    fn reset(&mut self) {
        *self = Self {
            changed: true,
            ..Self::default()
        };
    }
}
