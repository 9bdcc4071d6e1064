//! Scripts of faults, scenarios, and the journal of a campaign.

use std::fs;
use std::path::Path;

use tempfile::NamedTempFile;

use super::samples::{self, Sample};
use super::{Loaded, Source, Target, is_one_line};
use crate::campaign::Records;
use crate::faults::{Limits, Script};
use crate::{scenarios, toolchain};

pub(super) const FAULTS: Target = Target {
    name: "faults",
    reads: "fault scripts and scenarios",
    inputs: 12_000,
    load: || {
        let mut sound = Vec::new();
        for (kind, folder) in [(SCENARIOS, "scenarios"), (SCRIPT, "corpus/faults")] {
            let files = samples::files(&toolchain::root().join("hil-tests").join(folder))?;
            sound.extend(
                files
                    .iter()
                    .map(|(_, content)| Sample::named(kind, content)),
            );
        }
        let file = NamedTempFile::new()?;
        let check = move |input: &[u8]| check_faults(file.path(), input);
        Ok(Loaded::new(Source::Spoilt(sound), check))
    },
};

pub(super) const JOURNAL: Target = Target {
    name: "journal",
    reads: "journals of campaigns",
    inputs: 20_000,
    load: || {
        let folder = tempfile::tempdir()?;
        let check = move |input: &[u8]| check_journal(folder.path(), input);
        Ok(Loaded::new(
            Source::Spoilt(samples::corpus("journal")?),
            check,
        ))
    },
};

const SCENARIOS: &str = "scenarios";
const SCRIPT: &str = "script";

fn check_faults(file: &Path, input: &[u8]) -> bool {
    let Some((kind, content)) = samples::name_of(input) else {
        return false;
    };
    fs::write(file, content).expect("a temporary file");
    let refusal = match kind {
        SCENARIOS => scenarios::read(file, false)
            .err()
            .map(|error| format!("{error:#}")),
        _ => {
            let limits = Limits {
                take_off_ns: 1_500_000_000,
                duration_s: 45.0,
                motors: Some(4),
                is_native: false,
            };
            let script = Script::read(file, &limits);
            if let Ok(script) = &script {
                assert!(
                    script.iter().all(|fault| fault.from_ns <= fault.until_ns),
                    "{script:?}"
                );
            }
            script.err().map(|error| error.to_string())
        }
    };
    refusal.inspect(|line| is_one_line(line)).is_none()
}

fn check_journal(folder: &Path, input: &[u8]) -> bool {
    fs::write(folder.join("journal.jsonl"), input).expect("a temporary file");
    let read = Records::read(folder, None);
    read.inspect_err(|refusal| is_one_line(&refusal.to_string()))
        .is_ok()
}
