//! Runs a control logic by the clock and as a graph over a whole flight.
//!
//! Every step sets every input, so that both ways must compute the same command, bit by bit: one
//! that differs stops the program. The steps come in blocks: whoever watches the function
//! `refill` writes the next one into memory when the core arrives there, and one without steps
//! after the last. After each block the log has the digests of all commands so far, of the
//! time-triggered way and of ours, for a comparison with those of the host.
#![cfg_attr(target_os = "none", no_std, no_main)]

/// Only the emulated core is given steps.
#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program is for the emulated core: see hil-tests/src/logics/tests/emulated.rs.");
}

#[cfg(target_os = "none")]
mod program {
    use core::array;
    use core::hint::black_box;
    use core::sync::atomic::{AtomicU32, Ordering};

    use defmt_rtt as _;
    use panic_probe as _;
    use reflex::graph;
    use reflex_bench::BLOCK_STEPS;
    use reflex_bench::digest::CommandDigest;
    use reflex_bench::marks::done;
    use reflex_bench::step::{STEP_WORDS, Step};
    use reflex_bench::ways::{self, Way};
    use stm32f4xx_hal as _;

    const WORDS: usize = 2 + BLOCK_STEPS * STEP_WORDS;
    /// The block that was given last: see [`reflex_bench::BLOCK_SYMBOLS`].
    static GIVEN: [AtomicU32; WORDS] = [const { AtomicU32::new(0) }; WORDS];

    /// What is there now: no compiler knows that nobody in the program writes it.
    fn given() -> &'static [AtomicU32; WORDS] {
        black_box(&GIVEN)
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        refill();
        let asked = given()[0].load(Ordering::Relaxed);
        macro_rules! compare_asked {
            ($($(#[$doc:meta])* $module:ident: $name:literal, $Logic:ident;)*) => {
                let mut place = 0;
                $(
                    if asked == place {
                        compare(
                            &mut ways::$module::straight_line::$Logic::configured(),
                            &mut graph::$Logic::configured(),
                        );
                    }
                    place += 1;
                )*
                assert!(asked < place, "no control logic has the place {asked}");
            };
        }
        reflex_settings::control_logics!(compare_asked);
        done();
        loop {
            cortex_m::asm::wfi();
        }
    }

    fn compare(time_triggered: &mut impl Way, reactive: &mut impl Way) {
        let mut digests = [CommandDigest::new(); 2];
        let mut steps = 0_u32;
        loop {
            let [_, count, words @ ..] = given();
            let count = count.load(Ordering::Relaxed) as usize;
            if count == 0 {
                return;
            }
            for words in words.as_chunks::<STEP_WORDS>().0.iter().take(count) {
                let step = read(words);
                assert!(step.is_whole(), "step {steps} leaves an input unset");
                let commands = [time_triggered.take(&step), reactive.take(&step)];
                let [expected, command] = &commands;
                let mut pairs = command.iter().zip(expected.iter());
                assert!(
                    pairs.all(|(ours, by_clock)| ours.to_bits() == by_clock.to_bits()),
                    "step {steps}: {command:?}, by the clock {expected:?}"
                );
                for (digest, command) in digests.iter_mut().zip(commands) {
                    digest.add(command);
                }
                steps += 1;
            }
            let [by_clock, ours] = digests.map(CommandDigest::value);
            defmt::info!("{=u32} {=u64:016x} {=u64:016x}", steps, by_clock, ours);
            refill();
        }
    }

    fn read(words: &[AtomicU32; STEP_WORDS]) -> Step {
        let words: [u32; STEP_WORDS] = array::from_fn(|word| words[word].load(Ordering::Relaxed));
        Step::from_words(&words)
    }

    /// Asks for the next block.
    #[inline(never)]
    fn refill() {
        black_box(());
    }
}
