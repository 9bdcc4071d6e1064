//! The external interrupt controller, which the emulator's part lacks.
//!
//! RM0090 chapter 12: edge detectors on 16 lines, each fed by the port that
//! SYSCFG_EXTICR selects; pending bits that a written one clears; software
//! triggers; a mask in front of the interrupt controller. The event mask is
//! stored only, as nothing on this board waits for events.

use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::soc::stm32f427::generated::exti::Register;

/// Lines that come from port pins; the others belong to peripherals.
pub(super) const LINES: usize = 16;
/// Mask of [`LINES`] lines.
const PORT_LINES: u64 = 0xFFFF;

/// Which pending bits share an interrupt, and the interrupt's position in the
/// part's table: EXTI0 to EXTI4 alone, then 9..5 and 15..10 together.
const INTERRUPTS: [(u64, usize); 7] = [
    (1 << 0, 1),
    (1 << 1, 2),
    (1 << 2, 3),
    (1 << 3, 4),
    (1 << 4, 5),
    (0x03E0, 6),
    (0xFC00, 7),
];

/// Edge detectors, pending bits and the interrupts they raise.
#[derive(Debug, Default)]
pub(super) struct Exti {
    pending: u64,
    software: u64,
    levels: u64,
    raised: [bool; INTERRUPTS.len()],
}

impl Exti {
    /// The selected source of `line` is now at `level`.
    pub(super) fn set_line(
        &mut self,
        line: u8,
        level: bool,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let bit = 1_u64 << line;
        if (self.levels & bit != 0) == level {
            return;
        }
        self.levels ^= bit;
        let trigger = if level {
            Register::Rtsr
        } else {
            Register::Ftsr
        };
        self.pending |= registers.get(trigger) & bit;
        self.refresh(registers, context);
    }

    /// `line` has another source: its level is taken over without an edge.
    pub(super) fn reselect(&mut self, line: u8, level: bool) {
        let bit = 1_u64 << line;
        self.levels = (self.levels & !bit) | if level { bit } else { 0 };
    }

    fn refresh(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        registers.set(Register::Pr, self.pending);
        registers.set(Register::Swier, self.software);
        let active = self.pending & registers.get(Register::Imr);
        for ((lines, position), raised) in INTERRUPTS.into_iter().zip(&mut self.raised) {
            let wanted = active & lines != 0;
            if wanted != *raised {
                *raised = wanted;
                context.interrupt(position, Level::from(wanted));
            }
        }
    }
}

impl Device for Exti {
    type Register = Register;

    fn write(
        &mut self,
        register: Register,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        match register {
            Register::Pr => {
                self.pending &= !value;
                self.software &= !value;
            }
            Register::Swier => {
                self.pending |= value & !self.software & PORT_LINES;
                self.software |= value & PORT_LINES;
            }
            Register::Imr | Register::Emr | Register::Rtsr | Register::Ftsr => {}
        }
        self.refresh(registers, context);
    }

    fn reset(&mut self) {
        // The pins stay where the chips drive them.
        *self = Self {
            levels: self.levels,
            ..Self::default()
        };
    }
}
