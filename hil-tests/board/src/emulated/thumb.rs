//! Where a Thumb instruction may lead: on, into a function, back, elsewhere.

use std::collections::HashMap;
use std::sync::Arc;

use crate::elf::Code;

/// What follows an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flow {
    /// The instruction behind it, unless an interrupt comes first.
    Next,
    /// A function, which returns to the instruction behind it.
    Call,
    /// The caller, or what was interrupted.
    Return,
    /// Anything: a branch, a sleep, a mask of interrupts.
    Elsewhere,
}

/// Instructions in a row: only the last may lead elsewhere.
#[derive(Debug)]
pub(super) struct Row {
    /// Address of each, then of the instruction behind the last.
    addresses: Vec<u32>,
    flow: Flow,
}

impl Row {
    /// How many they are.
    pub(super) fn len(&self) -> u32 {
        self.addresses.len() as u32 - 1
    }

    /// Addresses of the first so many.
    pub(super) fn first(&self, count: u64) -> &[u32] {
        &self.addresses[..count as usize]
    }

    /// Where the first so many lead, the address of the last of them, and the one behind it.
    pub(super) fn behind(&self, count: u64) -> (Flow, u32, u32) {
        let count = count as usize;
        let last = self.addresses[count.saturating_sub(1)];
        let whole = count + 1 == self.addresses.len();
        let flow = if whole { self.flow } else { Flow::Next };
        (flow, last, self.addresses[count])
    }
}

/// The rows of a program, found as they are asked for.
#[derive(Debug)]
pub(super) struct Rows {
    code: Code,
    known: HashMap<u32, Arc<Row>>,
}

impl Rows {
    pub(super) fn of(code: Code) -> Self {
        Self {
            code,
            known: HashMap::new(),
        }
    }

    /// The row that begins at an address. Outside the program's code each instruction is alone.
    pub(super) fn at(&mut self, address: u32) -> Arc<Row> {
        let Self { code, known } = self;
        Arc::clone(
            known
                .entry(address)
                .or_insert_with(|| Arc::new(row(code, address))),
        )
    }
}

fn row(code: &Code, start: u32) -> Row {
    let mut addresses = vec![start];
    let mut at = start;
    loop {
        let (first, second) = (code.half_word(at), code.half_word(at + 2));
        let (length, flow) = first.map_or((2, Flow::Elsewhere), |first| {
            decode(first, second.unwrap_or(0))
        });
        at += length;
        addresses.push(at);
        if flow != Flow::Next {
            return Row { addresses, flow };
        }
    }
}

/// Length in bytes and flow of an instruction (ARMv7-M ARM, A5 and A7.7).
fn decode(first: u16, second: u16) -> (u32, Flow) {
    if first >= 0xE800 {
        (4, wide(first, second))
    } else {
        (2, narrow(first))
    }
}

fn narrow(half: u16) -> Flow {
    match half {
        // bx lr; pop {.., pc}
        0x4770 | 0xBD00..=0xBDFF => Flow::Return,
        // blx
        0x4780..=0x47FF => Flow::Call,
        // bx; b<c>, udf, svc; b; cps; bkpt
        0x4700..=0x477F | 0xD000..=0xDFFF | 0xE000..=0xE7FF | 0xB660..=0xB67F | 0xBE00..=0xBEFF => {
            Flow::Elsewhere
        }
        // cbz, cbnz; add pc, mov pc; nop, wfi and their like, which end in 0 as `it` does not
        _ if half & 0xF500 == 0xB100 || half & 0xFD87 == 0x4487 || half & 0xFF0F == 0xBF00 => {
            Flow::Elsewhere
        }
        _ => Flow::Next,
    }
}

fn wide(first: u16, second: u16) -> Flow {
    let to_pc = second & 0x8000 != 0;
    if first & 0xF800 == 0xF000 && to_pc {
        // bl; b, b<c>, msr, hints, barriers
        return if second & 0xD000 == 0xD000 {
            Flow::Call
        } else {
            Flow::Elsewhere
        };
    }
    // pop {.., pc}; ldr pc, [sp], #n
    if first == 0xE8BD && to_pc || first == 0xF85D && second & 0xFF00 == 0xFB00 {
        return Flow::Return;
    }
    // ldm {.., pc}; tbb, tbh; ldr pc
    if first & 0xFE50 == 0xE810 && to_pc
        || first & 0xFFF0 == 0xE8D0 && second & 0xFFE0 == 0xF000
        || first & 0xFF70 == 0xF850 && second >> 12 == 15
    {
        return Flow::Elsewhere;
    }
    Flow::Next
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_may_lead_elsewhere_ends_a_row() {
        for (halves, expected) in [
            ([0xF000, 0xF800], (4, Flow::Call)),      // bl
            ([0x4798, 0], (2, Flow::Call)),           // blx r3
            ([0x4770, 0], (2, Flow::Return)),         // bx lr
            ([0xBD80, 0], (2, Flow::Return)),         // pop {r7, pc}
            ([0xE8BD, 0x8FF0], (4, Flow::Return)),    // pop {r4-r11, pc}
            ([0xF85D, 0xFB04], (4, Flow::Return)),    // ldr pc, [sp], #4
            ([0xE8BD, 0x4FF0], (4, Flow::Next)),      // pop {r4-r11, lr}
            ([0x4718, 0], (2, Flow::Elsewhere)),      // bx r3
            ([0xD0FE, 0], (2, Flow::Elsewhere)),      // beq
            ([0xE7FE, 0], (2, Flow::Elsewhere)),      // b
            ([0xF000, 0xB800], (4, Flow::Elsewhere)), // b.w
            ([0xF040, 0x8000], (4, Flow::Elsewhere)), // bne.w
            ([0xB108, 0], (2, Flow::Elsewhere)),      // cbz r0
            ([0xB672, 0], (2, Flow::Elsewhere)),      // cpsid i
            ([0xF380, 0x8811], (4, Flow::Elsewhere)), // msr basepri, r0
            ([0xF3BF, 0x8F6F], (4, Flow::Elsewhere)), // isb
            ([0xBF30, 0], (2, Flow::Elsewhere)),      // wfi
            ([0xE8DF, 0xF001], (4, Flow::Elsewhere)), // tbb [pc, r1]
            ([0xF85F, 0xF004], (4, Flow::Elsewhere)), // ldr pc, [pc, #-4]
            ([0x4687, 0], (2, Flow::Elsewhere)),      // mov pc, r0
            ([0xBF08, 0], (2, Flow::Next)),           // it eq
            ([0x4608, 0], (2, Flow::Next)),           // mov r0, r1
            ([0xB510, 0], (2, Flow::Next)),           // push {r4, lr}
            ([0xF8D0, 0x1004], (4, Flow::Next)),      // ldr r1, [r0, #4]
            ([0xF100, 0x0101], (4, Flow::Next)),      // add r1, r0, #1
            ([0xEE30, 0x0A01], (4, Flow::Next)),      // vadd
        ] {
            let [first, second] = halves;
            assert_eq!(decode(first, second), expected, "{first:04x} {second:04x}");
        }
    }

    #[test]
    fn a_row_knows_where_each_of_its_instructions_leads() {
        // mov r0, r1; bl; nop
        let bytes = [0x4608_u16, 0xF000, 0xF800, 0xBF00].map(u16::to_le_bytes);
        let mut rows = Rows::of(Code::from([(0x100, bytes.concat())]));
        let row = rows.at(0x100);
        assert_eq!((row.len(), row.first(2)), (2, &[0x100, 0x102][..]));
        assert_eq!(row.behind(1), (Flow::Next, 0x100, 0x102));
        assert_eq!(row.behind(2), (Flow::Call, 0x102, 0x106));
        assert_eq!(rows.at(0x2000_0000).len(), 1, "no code of the program");
    }
}
