//! Arithmetic of floats on a core that has no unit for it.
//!
//! There it is calls of the compiler's library. That is linked for this core too, by the names that
//! Arm's run-time ABI gives its functions.

use core::hint::black_box;

use oorandom::Rand32;
use reflex_bench::marks::{measured, rounds};
use reflex_bench::{SOFT_COMPARISON, SOFT_CONVERSION, SOFT_PRODUCT, SOFT_QUOTIENT, SOFT_SUM};

// SAFETY: pure functions of the compiler's library (Arm IHI 0043, 4.1.2); floats travel as their bits
// in registers of the core, since the base procedure call standard knows no others.
unsafe extern "aapcs" {
    safe fn __aeabi_fadd(a: u32, b: u32) -> u32;
    safe fn __aeabi_fmul(a: u32, b: u32) -> u32;
    safe fn __aeabi_fdiv(a: u32, b: u32) -> u32;
    safe fn __aeabi_fcmplt(a: u32, b: u32) -> i32;
    safe fn __aeabi_i2f(a: i32) -> u32;
    safe fn __aeabi_f2iz(a: u32) -> i32;
}

pub fn measure() {
    let mut chance = Rand32::new(1);
    let mut float = || black_box((2.0 * chance.rand_float() - 1.0).to_bits());
    rounds(SOFT_SUM, |_| _ = two(&mut float, |a, b| __aeabi_fadd(a, b)));
    rounds(SOFT_PRODUCT, |_| {
        _ = two(&mut float, |a, b| __aeabi_fmul(a, b))
    });
    rounds(SOFT_QUOTIENT, |_| {
        _ = two(&mut float, |a, b| __aeabi_fdiv(a, b))
    });
    rounds(SOFT_COMPARISON, |_| {
        two(&mut float, |a, b| __aeabi_fcmplt(a, b) as u32);
    });
    rounds(SOFT_CONVERSION, |round| {
        let whole = black_box(round as i32 * 0x1_2345);
        if round % 2 == 0 {
            measured(|| __aeabi_i2f(whole));
        } else {
            let bits = __aeabi_i2f(whole);
            measured(|| __aeabi_f2iz(bits));
        }
    });
}

#[inline(always)]
fn two(float: &mut impl FnMut() -> u32, call: impl FnOnce(u32, u32) -> u32) -> u32 {
    let (a, b) = (float(), float());
    measured(|| call(a, b))
}
