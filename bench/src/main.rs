//! Runs the portable library's parts one by one between marks.
//!
//! Whoever watches the function `mark` sees it called before and after each measurement, in the
//! order of [`reflex_bench::PARTS`]. Inputs pass through `black_box`: nothing is computed ahead.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod garbage;
#[cfg(target_os = "none")]
mod refits;
#[cfg(target_os = "none")]
mod sample;
#[cfg(target_os = "none")]
mod soft_floats;
#[cfg(target_os = "none")]
mod triggers;

/// Only the emulated core counts instructions.
#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program is for the emulated core: see `cargo hil bench`.");
}

#[cfg(target_os = "none")]
mod program {
    use defmt_rtt as _;
    use panic_probe as _;
    use reflex_bench::NOTHING;
    use reflex_bench::marks::{done, measured, rounds};
    use stm32f4xx_hal as _;

    use crate::{garbage, refits, sample, soft_floats, triggers};

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let mut core = cortex_m::Peripherals::take().expect("taken once");
        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();
        rounds(NOTHING, |_| measured(|| ()));
        triggers::measure();
        sample::measure();
        refits::measure();
        garbage::measure();
        soft_floats::measure();
        done();
        loop {
            cortex_m::asm::wfi();
        }
    }
}
