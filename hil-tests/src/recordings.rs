//! Real flights for tests, where they are at hand.

use std::path::{Path, PathBuf};

/// Where recorded flights are looked for, from this package's folder.
const RECORDINGS: &str = "../../shared/streams";

/// A recorded flight, or `None`, with a message, where it is not at hand.
pub fn recording(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(RECORDINGS)
        .join(name);
    if path.is_file() {
        return Some(path);
    }
    eprintln!(
        "skipped: the recorded flight {} is not at hand",
        path.display()
    );
    None
}
