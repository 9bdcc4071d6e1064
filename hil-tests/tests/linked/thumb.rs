//! What Thumb instructions do to the stack pointer, and where they lead.

/// What matters of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Lowers the stack pointer by so many bytes.
    Lowers(u32),
    /// Lowers it by what a register holds.
    Unbounded,
    /// Calls, or branches to, an address.
    Leads(u32),
    /// Calls what a register points to.
    ThroughPointer,
    /// Neither.
    Other,
}

/// The instructions of a function that begins at an address.
pub fn steps(start: u32, code: &[u16]) -> Vec<(u32, Step)> {
    let mut steps = Vec::new();
    let mut place = 0;
    while let Some(first) = code.get(place) {
        let at = start + 2 * place as u32;
        let is_long = first & 0xF800 >= 0xE800;
        let step = match code.get(place + 1) {
            Some(second) if is_long => long(at, u32::from(*first), u32::from(*second)),
            _ => short(at, u32::from(*first)),
        };
        steps.push((at, step));
        place += if is_long { 2 } else { 1 };
    }
    steps
}

fn short(at: u32, code: u32) -> Step {
    let relative =
        |bits: u32, value: u32| Step::Leads(at.wrapping_add(4).wrapping_add(extended(bits, value)));
    match code {
        0xB400..0xB600 => Step::Lowers(4 * (code & 0x1FF).count_ones()),
        0xB080..0xB100 => Step::Lowers(4 * (code & 0x7F)),
        0xD000..0xDE00 => relative(9, (code & 0xFF) << 1),
        0xE000..0xE800 => relative(12, (code & 0x7FF) << 1),
        _ if code & 0xFF87 == 0x4780 => Step::ThroughPointer,
        // A return is `bx lr`.
        _ if code & 0xFF87 == 0x4700 && code != 0x4770 => Step::ThroughPointer,
        _ => Step::Other,
    }
}

fn long(at: u32, first: u32, second: u32) -> Step {
    let sign = first >> 10 & 1;
    let (j1, j2) = (second >> 13 & 1, second >> 11 & 1);
    let immediate = (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF;
    let lowers = second & 0x8F00 == 0x0D00;
    match (first, second) {
        (0xE92D, _) => Step::Lowers(4 * second.count_ones()),
        (0xED2D | 0xED6D, _) => Step::Lowers(4 * (second & 0xFF)),
        (0xF84D, _) if second & 0x0F00 == 0x0D00 => Step::Lowers(second & 0xFF),
        (0xE96D, _) => Step::Lowers(4 * (second & 0xFF)),
        _ if first & 0xFBFF == 0xF1AD && lowers => Step::Lowers(modified(immediate)),
        _ if first & 0xFBFF == 0xF2AD && lowers => Step::Lowers(immediate),
        (0xEBAD, _) if second & 0x0F00 == 0x0D00 => Step::Unbounded,
        // BL, and B to anywhere.
        _ if first & 0xF800 == 0xF000 && second & 0x9000 == 0x9000 => {
            let (i1, i2) = (1 ^ j1 ^ sign, 1 ^ j2 ^ sign);
            let offset =
                sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1;
            Step::Leads(at.wrapping_add(4).wrapping_add(extended(25, offset)))
        }
        // B on a condition; where that is 14 or 15 it is none.
        _ if first & 0xF800 == 0xF000 && second & 0xD000 == 0x8000 && first & 0x380 != 0x380 => {
            let offset =
                sign << 20 | j2 << 19 | j1 << 18 | (first & 0x3F) << 12 | (second & 0x7FF) << 1;
            Step::Leads(at.wrapping_add(4).wrapping_add(extended(21, offset)))
        }
        _ => Step::Other,
    }
}

/// A number of so many bits, with its sign.
fn extended(bits: u32, value: u32) -> u32 {
    let unused = 32 - bits;
    ((value << unused) as i32 >> unused) as u32
}

/// The constant of an immediate operand: 8 bit, repeated or rotated.
fn modified(immediate: u32) -> u32 {
    let byte = immediate & 0xFF;
    match immediate >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (0x80 | byte & 0x7F).rotate_right(immediate >> 7),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_lower_the_stack_by_what_the_manual_says() {
        let cases: [(&[u16], Step); 12] = [
            // push {r4, r6, r7, lr}
            (&[0xB5D0], Step::Lowers(16)),
            // push.w {r8-r11}
            (&[0xE92D, 0x0F00], Step::Lowers(16)),
            // vpush {d8-d15}
            (&[0xED2D, 0x8B10], Step::Lowers(64)),
            // str r11, [sp, #-4]!
            (&[0xF84D, 0xBD04], Step::Lowers(4)),
            // sub sp, #100
            (&[0xB099], Step::Lowers(100)),
            // sub.w sp, sp, #1024
            (&[0xF5AD, 0x6D80], Step::Lowers(1024)),
            // subw sp, sp, #1028
            (&[0xF2AD, 0x4D04], Step::Lowers(1028)),
            // add r7, sp, #8
            (&[0xAF02], Step::Other),
            // bx lr, blx r1
            (&[0x4770], Step::Other),
            (&[0x4788], Step::ThroughPointer),
            // b .-2, bl .+4 behind it
            (&[0xE7FD], Step::Leads(0x0800_00FE)),
            (&[0xF000, 0xF802], Step::Leads(0x0800_0108)),
        ];
        for (code, step) in cases {
            assert_eq!(steps(0x0800_0100, code), [(0x0800_0100, step)], "{code:x?}");
        }
    }
}
