//! What is measured, in order: shared by the programs and their reader.
#![cfg_attr(target_os = "none", no_std)]
#![forbid(unsafe_code)]

use reflex::config::LINK_BAUD;

pub mod digest;
pub mod marks;
pub mod step;
pub mod ways;

/// Most steps that the program `flights` takes at once, until it gets none.
pub const BLOCK_STEPS: usize = 512;
/// The function of `flights` that asks for a block, and the block's path.
///
/// A block is the place of a logic in [`reflex_settings::gains::LOGICS`], how many steps there are, then the words of each.
pub const BLOCK_SYMBOLS: [[&str; 2]; 2] = [["program", "refill"], ["program", "GIVEN"]];

/// Most steps that the program `logics` takes at once.
pub const STEPS: usize = 256;
/// The path of their place in its memory: the place of a logic in [`reflex_settings::gains::LOGICS`], or a larger number for
/// all of them, how many steps there are, then the words of each.
pub const STEPS_SYMBOL: [&str; 2] = ["program", "GIVEN"];
/// The ways in which each step is run: time-triggered, ours, callbacks, pointer vector.
pub const WAYS: usize = 4;
/// One part: what it is, and how often it is measured on other inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// As the table says it.
    pub name: &'static str,
    /// Measurements, of which the dearest counts.
    pub rounds: usize,
    /// Most instructions that it may cost.
    pub limit: Option<u64>,
}

/// A test of a sample against a threshold is to cost nothing against the run that it saves.
const TRIGGER_LIMIT: u64 = 60;
/// A look at what is owed replaces a foresight. Every second sample is left out unless what is owed grows
/// fast, so that a sample costs less than 150.
const PREDICTION_LIMIT: u64 = 190;
/// A refit is to be done in idle between two samples of the gyroscope, more or less: 1.2 ms.
const REFIT_LIMIT: u64 = 200_000;
/// Bytes of garbage in a measurement: 22 ms of the link.
pub const GARBAGE_BYTES: usize = 1024;
/// As many as the link's task takes at once.
pub const GARBAGE_CHUNK: usize = 64;
/// A twentieth of what the core executes while so many bytes arrive, of 10 bits each.
const GARBAGE_LIMIT: u64 = 168_000_000 / LINK_BAUD as u64 * 10 * GARBAGE_BYTES as u64 / 20;

const fn part(name: &'static str, rounds: usize, limit: Option<u64>) -> Part {
    Part {
        name,
        rounds,
        limit,
    }
}

/// The pair of marks with nothing between: what is taken off every other part.
pub const NOTHING: Part = part("nothing", 4, None);
/// A sample of three axes that changed less than its threshold.
pub const AXES_BELOW: Part = part("trigger test, three axes, below", 32, Some(TRIGGER_LIMIT));
/// A sample of three axes that changed more.
pub const AXES_ABOVE: Part = part("trigger test, three axes, above", 32, Some(TRIGGER_LIMIT));
/// A foreseen command that changed less than its threshold.
pub const COMMAND_BELOW: Part = part("trigger test, command, below", 32, Some(TRIGGER_LIMIT));
/// A foreseen command that changed more.
pub const COMMAND_ABOVE: Part = part("trigger test, command, above", 32, Some(TRIGGER_LIMIT));
/// `Arrival::take`.
pub const ARRIVAL: Part = part("arrival of one IMU sample", 64, None);
/// `ControlLogic::take` and `foresee`.
pub const FORESEE: Part = part("foreseeing the command", 64, None);
/// `Prediction::predict`.
pub const PREDICT: Part = part("predicting what is owed", 64, Some(PREDICTION_LIMIT));
/// `Prediction::on_run`, which learns from the run and begins anew.
pub const ANCHOR: Part = part("prediction after a run", 64, None);
/// `ControlLogic::take` and `run`.
pub const RUN: Part = part("run, from motion to command", 64, None);
/// `ShadowHolds::take`, all candidates.
pub const HOLDS: Part = part("shadow holds of one input, one sample", 256, None);
/// `Labels::add`.
pub const LABEL: Part = part("adding one label", 64, None);
/// `Labels::fade`, and the `Labels::add` that settles it.
pub const FADE: Part = part("forgetting, with the label after it", 4, None);
/// `Decision::set_fit`.
pub const SWAP: Part = part("swapping a model in", 16, None);
/// `RefitJob::fit` on what a flight brings.
pub const REFIT: Part = part("refit, typical labels", 16, Some(REFIT_LIMIT));
/// `RefitJob::fit` on what a search for the dearest labels brings.
pub const WORST_REFIT: Part = part("refit, dearest labels found", 1024, Some(REFIT_LIMIT));
/// `Parser::feed` at the full rate of the link, with a key: random bytes.
pub const NOISE: Part = part(
    "garbage on the link: random bytes",
    256,
    Some(GARBAGE_LIMIT),
);
/// Random bytes, half of which may be starts of frames.
pub const STARTS: Part = part(
    "garbage on the link: starts of frames",
    256,
    Some(GARBAGE_LIMIT),
);
/// Right headers, wrong checksums.
pub const WRONG_CHECKSUM: Part = part(
    "garbage on the link: wrong checksums",
    64,
    Some(GARBAGE_LIMIT),
);
/// Right checksums, wrong signatures.
pub const WRONG_SIGNATURE: Part = part(
    "garbage on the link: wrong signatures",
    64,
    Some(GARBAGE_LIMIT),
);
/// Starts of the longest frames, each within the one before.
pub const NESTED: Part = part(
    "garbage on the link: frames within frames",
    64,
    Some(GARBAGE_LIMIT),
);

/// A sum of two floats where no unit computes it, by the library of the compiler.
pub const SOFT_SUM: Part = part("without an FPU: a sum", 256, None);
/// A product.
pub const SOFT_PRODUCT: Part = part("without an FPU: a product", 256, None);
/// A quotient.
pub const SOFT_QUOTIENT: Part = part("without an FPU: a quotient", 256, None);
/// A comparison.
pub const SOFT_COMPARISON: Part = part("without an FPU: a comparison", 256, None);
/// A conversion from an integer, or to one.
pub const SOFT_CONVERSION: Part = part("without an FPU: a conversion", 256, None);

/// All of them, in the order in which the program measures.
pub const PARTS: [Part; 26] = [
    NOTHING,
    AXES_BELOW,
    AXES_ABOVE,
    COMMAND_BELOW,
    COMMAND_ABOVE,
    ARRIVAL,
    PREDICT,
    ANCHOR,
    FORESEE,
    RUN,
    HOLDS,
    LABEL,
    FADE,
    SWAP,
    REFIT,
    WORST_REFIT,
    NOISE,
    STARTS,
    WRONG_CHECKSUM,
    WRONG_SIGNATURE,
    NESTED,
    SOFT_SUM,
    SOFT_PRODUCT,
    SOFT_QUOTIENT,
    SOFT_COMPARISON,
    SOFT_CONVERSION,
];
