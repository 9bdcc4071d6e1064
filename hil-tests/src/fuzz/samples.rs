//! Sound inputs: what readers are meant for.

use std::path::Path;

use anyhow::{Context, Result, ensure};

use crate::toolchain;

/// A sound input.
pub(super) struct Sample {
    pub(super) bytes: Vec<u8>,
    /// The first bytes, which are not spoilt: they say what the rest is.
    pub(super) kept: usize,
}

impl Sample {
    /// All of it may be spoilt.
    pub(super) fn new(bytes: Vec<u8>) -> Self {
        Self { bytes, kept: 0 }
    }

    /// A file under a name that stays, on a line before it.
    pub(super) fn named(name: &str, content: &[u8]) -> Self {
        let line = format!("{name}\n");
        Self {
            bytes: [line.as_bytes(), content].concat(),
            kept: line.len(),
        }
    }
}

/// The line before a file, and the file.
pub(super) fn name_of(input: &[u8]) -> Option<(&str, &[u8])> {
    let end = input.iter().position(|byte| *byte == b'\n')?;
    let name = std::str::from_utf8(&input[..end]).ok()?;
    Some((name, &input[end + 1..]))
}

/// The files of a folder under `hil-tests/corpus/`, in order.
pub(super) fn corpus(folder: &str) -> Result<Vec<Sample>> {
    let folder = toolchain::root().join("hil-tests/corpus").join(folder);
    let found = files(&folder)?;
    ensure!(!found.is_empty(), "{}: no files", folder.display());
    Ok(found
        .into_iter()
        .map(|(_, bytes)| Sample::new(bytes))
        .collect())
}

/// The files of a folder and of those in it, by their paths from it, in order.
pub(super) fn files(folder: &Path) -> Result<Vec<(String, Vec<u8>)>> {
    let mut found = Vec::new();
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    for entry in entries {
        let path = entry?.path();
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if path.is_dir() {
            let inner = files(&path)?.into_iter();
            found.extend(inner.map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
            found.push((name, bytes));
        }
    }
    found.sort();
    Ok(found)
}
