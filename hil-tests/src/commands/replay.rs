//! `cargo hil replay`: a recorded flight through the firmware, and what it decided.

use anyhow::Result;

use super::bar::Bar;
use super::replay_arguments::ReplayArguments;
use crate::native;
use crate::replay::replay;
use crate::scoring::summary;

/// Replays, then prints the report.
pub(super) fn run(arguments: &ReplayArguments) -> Result<()> {
    let options = arguments.options()?;
    let mut bar = Bar::new();
    let result = if arguments.native {
        native::replay(&options, &mut bar)
    } else {
        replay(&options, &mut bar)
    };
    bar.finish();
    let report = result?;
    // Printed only once it is whole: a failed replay leaves no half of a JSON object.
    let text = if arguments.json {
        report.to_json()?
    } else {
        summary(&report)
    };
    super::print(&text)
}
