//! Fingerprint of the sources that a flight depends on.
//!
//! Flights of different sources are not comparable. What only reports flights, figures and
//! reports, may change between a campaign and its report.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use sha2::{Digest, Sha256};

use crate::toolchain;

/// Files and folders that a flight depends on.
const DEPENDED_ON: [&str; 10] = [
    "Cargo.lock",
    "Cargo.toml",
    "build.rs",
    "config",
    "dataflow-language/src",
    "dataflow-macros/src",
    "drivers/src",
    "hil-tests",
    "settings/src",
    "src",
];
/// Folders within these that only report flights, or that test.
const REPORTING: [&str; 9] = [
    "hil-tests/src/campaign",
    "hil-tests/src/commands",
    "hil-tests/src/costs",
    "hil-tests/src/picture",
    "hil-tests/src/plot",
    "hil-tests/src/scoring",
    "hil-tests/src/sweep",
    "hil-tests/flights/tests",
    "hil-tests/tests",
];
/// Bytes of the fingerprint that are kept.
const KEPT: usize = 6;

/// The fingerprint of this workspace, in hexadecimal digits.
///
/// # Errors
/// A source cannot be read.
pub fn fingerprint() -> Result<String> {
    let root = toolchain::root();
    let mut files = Vec::new();
    for name in DEPENDED_ON {
        gather(root, Path::new(name), &mut files)?;
    }
    files.sort();
    let mut hash = Sha256::new();
    for name in files {
        let bytes = fs::read(root.join(&name)).with_context(|| name.display().to_string())?;
        hash.update(name.to_string_lossy().as_bytes());
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(&bytes);
    }
    let digest = hash.finalize();
    Ok(digest
        .iter()
        .take(KEPT)
        .map(|byte| format!("{byte:02x}"))
        .collect())
}

fn gather(root: &Path, name: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let path = root.join(name);
    if path.is_dir() {
        if REPORTING
            .iter()
            .any(|reporting| name == Path::new(reporting))
        {
            return Ok(());
        }
        for entry in fs::read_dir(&path).with_context(|| name.display().to_string())? {
            gather(root, &name.join(entry?.file_name()), files)?;
        }
    } else if name
        .extension()
        .is_some_and(|kind| ["rs", "toml", "lock"].iter().any(|it| kind == *it))
    {
        files.push(name.to_owned());
    }
    Ok(())
}
