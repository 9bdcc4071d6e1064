//! The flight that is replayed when no log is named.
//!
//! It comes with the crate `ulog-rs`, which cargo has on every machine that
//! could build this program, so nothing recorded needs to be in the repository.

use std::path::{Path, PathBuf};

use cargo_metadata::{Metadata, MetadataCommand};

use super::error::{Fault, FlightError};

const PACKAGE: &str = "ulog-rs";
const VERSION: &str = "0.0.4";
const LOG: &str = "test_data/sample.ulg";

/// Where the log of the default flight is on this machine.
///
/// # Errors
/// One line, where cargo fails or the log is not there.
pub fn sample_flight() -> Result<PathBuf, FlightError> {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    locate(&manifest).map_err(|fault| fault.in_file(&manifest))
}

/// Finds the log among the dependencies of a package.
fn locate(manifest: &Path) -> Result<PathBuf, Fault> {
    let metadata = metadata(manifest)?;
    let package = metadata
        .packages
        .iter()
        .find(|package| package.name.as_str() == PACKAGE && package.version.to_string() == VERSION)
        .ok_or_else(|| {
            Fault::whole(format!(
                "does not depend on {PACKAGE} {VERSION}, which holds the default flight: name a log"
            ))
        })?;
    let folder = package.manifest_path.as_std_path().parent();
    let log = folder.unwrap_or(Path::new("")).join(LOG);
    if !log.is_file() {
        let log = log.display();
        return Err(Fault::whole(format!(
            "the default flight {log} is missing: name a log, or run `cargo fetch`"
        )));
    }
    Ok(log)
}

/// What cargo knows, asked in the ways that need no network first.
fn metadata(manifest: &Path) -> Result<Metadata, Fault> {
    const WAYS: [&[&str]; 3] = [
        &["--locked", "--offline", "--filter-platform", "host-tuple"],
        &["--locked", "--offline"],
        &[],
    ];
    let mut reason = String::new();
    for options in WAYS {
        let mut command = MetadataCommand::new();
        command
            .manifest_path(manifest)
            .other_options(options.iter().map(|o| (*o).to_owned()).collect::<Vec<_>>());
        match command.exec() {
            Ok(metadata) => return Ok(metadata),
            Err(error) => reason = error.to_string(),
        }
    }
    let first_line = reason.lines().find(|line| line.contains("error"));
    let reason = first_line.or(reason.lines().next()).unwrap_or_default();
    Err(Fault::whole(format!(
        "`cargo metadata` cannot find the default flight: {reason}"
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_flight_is_found_among_the_dependencies() {
        let log = sample_flight().expect("ulog-rs is a dependency");
        assert!(log.ends_with(LOG));
    }

    #[test]
    fn a_package_without_the_dependency_is_named() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let manifest = folder.path().join("Cargo.toml");
        let package = "[package]\nname='x'\nversion='0.1.0'\nedition='2024'\n[lib]\npath='l.rs'\n";
        std::fs::write(&manifest, package).expect("written");
        std::fs::write(folder.path().join("l.rs"), "").expect("written");
        let fault = locate(&manifest).expect_err("no dependency");
        assert!(
            fault.reason.contains("does not depend on ulog-rs"),
            "{fault:?}"
        );
        let fault = locate(&folder.path().join("none/Cargo.toml")).expect_err("no manifest");
        assert!(!fault.reason.contains('\n'), "{fault:?}");
    }
}
