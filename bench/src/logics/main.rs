//! Runs every control logic in every way over the same steps, between marks.
//!
//! Whoever watches the function `mark` sees it called before and after each step of each way, in
//! the order of [`reflex_settings::gains::LOGICS`], ways as in [`reflex_bench::ways`]. The steps stand in
//! flash: whoever starts the program writes them over those of the file. A way that computes
//! another command than ours stops the program; the time-triggered one only as long as every
//! step sets every input.
#![cfg_attr(target_os = "none", no_std, no_main)]

/// Only the emulated core counts instructions.
#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program is for the emulated core: see `cargo hil bench`.");
}

#[cfg(target_os = "none")]
mod program {
    use core::hint::black_box;

    use defmt_rtt as _;
    use panic_probe as _;
    use reflex::airframe::MotorShares;
    use reflex::graph;
    use reflex_bench::STEPS;
    use reflex_bench::marks::{done, measured};
    use reflex_bench::step::{STEP_WORDS, Step};
    use reflex_bench::ways::{self, Way};
    use stm32f4xx_hal as _;

    /// Which logic, how many steps, then their words: see [`reflex_bench::STEPS_SYMBOL`].
    static GIVEN: [u32; 2 + STEPS * STEP_WORDS] = [0; 2 + STEPS * STEP_WORDS];
    const LOGICS: u32 = reflex_settings::gains::LOGICS.len() as u32;

    /// Runs each logic of the one list in every way over the given steps, where it is asked for.
    macro_rules! in_every_way {
        ($($(#[$doc:meta])* $module:ident: $name:literal, $Logic:ident;)*) => {
            let mut place = 0;
            $(
                if matches!(black_box(&GIVEN)[0], asked if asked == place || asked >= LOGICS) {
                    compare(
                        &mut ways::$module::straight_line::$Logic::configured(),
                        &mut graph::$Logic::configured(),
                        &mut ways::$module::callbacks::$Logic::configured(),
                        &mut ways::$module::pointer_vector::$Logic::configured(),
                    )
                }
                place += 1;
            )*
            assert!(place == LOGICS);
        };
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let mut core = cortex_m::Peripherals::take().expect("taken once");
        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();
        measured(|| ());
        reflex_settings::control_logics!(in_every_way);
        done();
        loop {
            cortex_m::asm::wfi();
        }
    }

    fn compare(
        straight_line: &mut impl Way,
        reactive: &mut impl Way,
        callbacks: &mut impl Way,
        pointer_vector: &mut impl Way,
    ) {
        let [_, count, words @ ..] = black_box(&GIVEN);
        let steps = words.as_chunks::<STEP_WORDS>().0;
        let mut whole = true;
        for words in steps.iter().take(*count as usize) {
            let step = black_box(Step::from_words(words));
            whole &= step.is_whole();
            let time_triggered = run(straight_line, &step);
            let expected = run(reactive, &step);
            assert!(same(run(callbacks, &step), expected));
            assert!(same(run(pointer_vector, &step), expected));
            // Without a new sample it advances by the old one once more.
            assert!(!whole || same(time_triggered, expected));
        }
    }

    /// Bit by bit.
    fn same(one: MotorShares, other: MotorShares) -> bool {
        one.len() == other.len()
            && one
                .iter()
                .zip(other.iter())
                .all(|(one, other)| one.to_bits() == other.to_bits())
    }

    /// One step of one way, a call of its own: nothing is computed ahead, or together.
    #[inline(never)]
    fn run<W: Way>(way: &mut W, step: &Step) -> MotorShares {
        measured(|| black_box(way).take(black_box(step)))
    }
}
