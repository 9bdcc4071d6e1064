use reflex::dataflow::graph;
use reflex::time::micros;

/// Few different results, so that propagation often stops.
fn mixed<const A: u32, const B: u32, const C: u32, const SHIFT: u32>(values: &[u32]) -> u32 {
    let sum = values.iter().zip([A, B, C]).map(|(value, weight)| value * weight).sum::<u32>();
    ((sum + A) >> SHIFT) % 8
}

/// The same with arguments that are copies (`c`) and references (`r`).
macro_rules! with_arguments {
    ($($name:ident($($argument:ident: $type:ty = $value:expr),+);)*) => {$(
        fn $name<const A: u32, const B: u32, const C: u32, const SHIFT: u32>(
            $($argument: $type),+
        ) -> u32 {
            mixed::<A, B, C, SHIFT>(&[$($value),+])
        }
    )*};
}

with_arguments! {
    mixed_c(x: u32 = x);
    mixed_r(x: &u32 = *x);
    mixed_cc(x: u32 = x, y: u32 = y);
    mixed_cr(x: u32 = x, y: &u32 = *y);
    mixed_rc(x: &u32 = *x, y: u32 = y);
    mixed_rr(x: &u32 = *x, y: &u32 = *y);
    mixed_ccc(x: u32 = x, y: u32 = y, z: u32 = z);
    mixed_ccr(x: u32 = x, y: u32 = y, z: &u32 = *z);
    mixed_crc(x: u32 = x, y: &u32 = *y, z: u32 = z);
    mixed_crr(x: u32 = x, y: &u32 = *y, z: &u32 = *z);
    mixed_rcc(x: &u32 = *x, y: u32 = y, z: u32 = z);
    mixed_rcr(x: &u32 = *x, y: u32 = y, z: &u32 = *z);
    mixed_rrc(x: &u32 = *x, y: &u32 = *y, z: u32 = z);
    mixed_rrr(x: &u32 = *x, y: &u32 = *y, z: &u32 = *z);
}

/// A linear congruential generator (Knuth, MMIX).
struct Random(u64);

impl Random {
    fn below(&mut self, end: u32) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as u32) % end
    }
}
