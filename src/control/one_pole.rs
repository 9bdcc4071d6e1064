//! One-pole low-pass filters over a measured time, exact for what moves linearly.

/// Time constant in s of a corner in Hz.
pub(in crate::control) const fn time_constant(cutoff: f32) -> f32 {
    1.0 / (core::f32::consts::TAU * cutoff)
}

/// The share of the way to a constant input that is gone in `dt` (s).
pub(in crate::control) fn gone(dt: f32, time_constant: f32) -> f32 {
    1.0 - libm::expf(-dt / time_constant)
}

/// The output after an input that moved linearly between two values in `dt` (s).
pub(in crate::control) fn along(output: f32, input: [f32; 2], dt: f32, time_constant: f32) -> f32 {
    if dt <= 0.0 {
        return output;
    }
    let [from, to] = input;
    let behind = (to - from) * (time_constant / dt);
    output + (to - from) + (from - behind - output) * gone(dt, time_constant)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_long_step_along_a_line_is_many_short_ones() {
        let often = (0..50u8).fold(0.3, |output, step| {
            let at = |step: f32| 1.0 - 0.04 * step;
            let input = [at(f32::from(step)), at(f32::from(step) + 1.0)];
            along(output, input, 0.001, 0.008)
        });
        let rarely = along(0.3, [1.0, -1.0], 0.05, 0.008);
        assert!((often - rarely).abs() < 1e-5, "{often} {rarely}");
    }

    #[test]
    fn a_step_is_followed_to_two_thirds_in_a_time_constant() {
        assert!((along(0.0, [1.0, 1.0], 0.1, 0.1) - 0.632).abs() < 1e-3);
        assert_eq!(along(0.5, [1.0, 1.0], 0.0, 0.1), 0.5);
    }
}
