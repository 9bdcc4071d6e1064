//! Where the instructions of a flight go: by part, by function, by task.
//!
//! The emulated core counts every instruction of the flight's scored part by its address, and by the calls and
//! interrupts that led there. Debug information turns addresses into functions, the inlined ones
//! too; a table of modules turns functions into parts. What no row names is the part `rest`, so
//! that the parts add up to what the core executed.
//!
//! | file | holds |
//! |---|---|
//! | `frames` | from an address to functions and modules |
//! | `parts` | the table of parts |
//! | `flash` | the same for the bytes of flash |
//! | `stacks` | from counted addresses to stacks of functions |
//! | `floats` | which instructions compute with floats |
//! | `report`, `flame` | sums, as text and JSON; stacks, as a flame graph |

mod flame;
mod flash;
mod floats;
mod frames;
mod parts;
mod report;
mod stacks;
#[cfg(test)]
mod tests;

use anyhow::{Context, Result, ensure};
use reflex::settings::Policy;

pub use flame::{figure, folded};
pub use flash::{flash_of_parts, flash_part_names};
pub use frames::Frame;
pub use parts::{PARTS, REST};
pub use report::{Profile, Share, Subject, TaskShare};
pub use stacks::Stack;

use emulated_board::Elf;
use floats::Arithmetic;

use crate::closed_loop::{self, Core, FlyOptions, Flyer, Scene};
use crate::firmware::Firmware;
use crate::progress::Progress;
use crate::record::Counted;
use crate::replay::emulated;
use crate::replay::options::ReplayOptions;

/// A profile, and the stacks that it sums up.
#[derive(Clone, Debug)]
pub struct Profiled {
    /// The sums.
    pub profile: Profile,
    /// Stacks of functions with their instructions.
    pub stacks: Vec<Stack>,
}

/// Replays a recorded flight, and counts from the end of the warm-up.
///
/// # Errors
/// As those of a replay; a warm-up that lasts to the end.
pub fn replay(options: &ReplayOptions, progress: &mut dyn Progress) -> Result<Profiled> {
    let replayed = emulated::replay_counted(options, progress)?;
    let run = &replayed.report.run;
    let counted = replayed.counted.with_context(|| {
        format!(
            "{}: the warm-up lasts to its end, nothing was counted",
            run.log
        )
    })?;
    let settings = &options.settings;
    let subject = Subject {
        flight: run.log.clone(),
        logic: options.gains.logic().word().to_owned(),
        policy: run.policy.clone(),
        rate_hz: (settings.policy == Policy::Periodic)
            .then(|| 1e6 / settings.period.ticks() as f64),
        seed: settings.seed,
        digest: run.digest.clone(),
    };
    profiled(&replayed.firmware, subject, &counted, progress)
}

/// Flies a simulated drone, and counts in the scored part.
///
/// # Errors
/// As those of a flight; a crash before the scored part.
pub fn fly(
    scene: &Scene,
    options: &FlyOptions,
    (firmware, mhz): (&Firmware, u32),
    progress: &mut dyn Progress,
) -> Result<Profiled> {
    let core = Core {
        firmware,
        mhz,
        counts: true,
    };
    let flown = closed_loop::fly(scene, options, Flyer::Emulated(core), progress)?;
    let report = flown.report;
    let counted = flown.counted.with_context(|| match report.crash_text() {
        Some(line) => format!("nothing was counted: {line}"),
        None => "the flight ended before its scored part, nothing was counted".to_owned(),
    })?;
    let subject = Subject {
        flight: format!(
            "{} in {} with {}",
            report.mission, report.environment, report.airframe
        ),
        logic: report.logic,
        policy: report.policy,
        rate_hz: report.rate_hz,
        seed: report.seed,
        digest: report.digest,
    };
    profiled(firmware, subject, &counted, progress)
}

fn profiled(
    firmware: &Firmware,
    subject: Subject,
    counted: &Counted,
    progress: &mut dyn Progress,
) -> Result<Profiled> {
    progress.stage("Attributing instructions");
    let tally = &counted.tally;
    ensure!(
        tally.instructions() == tally.executed,
        "{} instructions were counted, the core executed {}",
        tally.instructions(),
        tally.executed
    );
    let stacks = stacks::of(&firmware.bytes, tally)?;
    let floats = Arithmetic::count(&Elf::parse(firmware.bytes.clone())?, tally);
    Ok(Profiled {
        profile: Profile::of(subject, counted, &stacks, &floats),
        stacks,
    })
}
