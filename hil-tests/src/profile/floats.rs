//! Arithmetic of floats among the instructions.
//!
//! A core that has no unit for it calls a library for each.
//! Encodings: ARMv7-M Architecture Reference Manual, A6.4 and A6.5, single precision.

use std::collections::BTreeMap;

use emulated_board::{Code, Elf, Tally};

/// What an instruction computes with floats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Arithmetic {
    /// Sum or difference.
    Sum,
    Product,
    /// A product that is added to something.
    ProductAndSum,
    Quotient,
    SquareRoot,
    Comparison,
    /// From an integer, or to one.
    Conversion,
}

impl Arithmetic {
    /// All, with their words.
    pub(super) const ALL: [(Self, &str); 7] = [
        (Self::Sum, "sums and differences"),
        (Self::Product, "products"),
        (Self::ProductAndSum, "products that are added"),
        (Self::Quotient, "quotients"),
        (Self::SquareRoot, "square roots"),
        (Self::Comparison, "comparisons"),
        (Self::Conversion, "conversions"),
    ];

    /// That of an instruction's two half words; `None` where it moves floats, or has nothing to do with
    /// them.
    pub(super) fn of(first: u16, second: u16) -> Option<Self> {
        // Data processing of coprocessor 10; bit 4 would make it a move to a register of the core.
        let floats = first & 0xFF00 == 0xEE00 && second & 0x0F10 == 0x0A00;
        let (operation, other) = (first >> 4 & 0b1011, first & 0xF);
        match operation {
            _ if !floats => None,
            0b0000 | 0b0001 | 0b1001 | 0b1010 => Some(Self::ProductAndSum),
            0b0010 => Some(Self::Product),
            0b0011 => Some(Self::Sum),
            0b1000 => Some(Self::Quotient),
            0b1011 if second & 0x40 == 0 => None,
            0b1011 => match (other, second & 0x80 != 0) {
                (0b0001, true) => Some(Self::SquareRoot),
                (0b0100 | 0b0101, _) => Some(Self::Comparison),
                (0b0111.., _) => Some(Self::Conversion),
                _ => None,
            },
            _ => None,
        }
    }

    /// How many of each a flight executed.
    pub(super) fn count(elf: &Elf, tally: &Tally) -> BTreeMap<Self, u64> {
        let code = elf.executable();
        let mut counts = BTreeMap::new();
        for ((_, address), executed) in &tally.counts {
            if let Some(arithmetic) = at(&code, *address) {
                *counts.entry(arithmetic).or_default() += executed;
            }
        }
        counts
    }
}

fn at(code: &Code, address: u32) -> Option<Arithmetic> {
    Arithmetic::of(code.half_word(address)?, code.half_word(address + 2)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As LLVM's assembler encodes them.
    #[test]
    fn encodings_are_told_apart() {
        use Arithmetic::{
            Comparison, Conversion, Product, ProductAndSum, Quotient, SquareRoot, Sum,
        };
        let of = |word: u32| Arithmetic::of((word >> 16) as u16, word as u16);
        for (instruction, word, arithmetic) in [
            ("vadd.f32 s0, s1, s2", 0xEE30_0A81, Some(Sum)),
            ("vsub.f32 s0, s1, s2", 0xEE30_0AC1, Some(Sum)),
            ("vmul.f32 s0, s1, s2", 0xEE20_0A81, Some(Product)),
            ("vnmul.f32 s1, s1, s2", 0xEE60_0AC1, Some(Product)),
            ("vmla.f32 s0, s1, s2", 0xEE00_0A81, Some(ProductAndSum)),
            ("vmls.f32 s0, s1, s2", 0xEE00_0AC1, Some(ProductAndSum)),
            ("vfma.f32 s1, s1, s2", 0xEEE0_0A81, Some(ProductAndSum)),
            ("vdiv.f32 s0, s1, s2", 0xEE80_0A81, Some(Quotient)),
            ("vsqrt.f32 s0, s1", 0xEEB1_0AE0, Some(SquareRoot)),
            ("vcmp.f32 s0, s1", 0xEEB4_0A60, Some(Comparison)),
            ("vcmp.f32 s0, #0", 0xEEB5_0A40, Some(Comparison)),
            ("vcvt.f32.u32 s0, s1", 0xEEB8_0A60, Some(Conversion)),
            ("vcvt.s32.f32 s0, s1", 0xEEBD_0AE0, Some(Conversion)),
            ("vmov.f32 s0, s1", 0xEEB0_0A60, None),
            ("vabs.f32 s0, s1", 0xEEB0_0AE0, None),
            ("vneg.f32 s0, s1", 0xEEB1_0A60, None),
            ("vmov.f32 s0, #1.0", 0xEEB7_0A00, None),
            ("vmov s0, r1", 0xEE00_1A10, None),
            ("vmrs APSR_nzcv, fpscr", 0xEEF1_FA10, None),
            ("vldr s0, [r1]", 0xED91_0A00, None),
            ("mcr p15, 0, r0, c1, c0, 0", 0xEE01_0F10, None),
        ] {
            assert_eq!(of(word), arithmetic, "{instruction}");
        }
    }
}
