//! What `--sweep` and `--svg` add to a replay's arguments.

use std::path::{Path, PathBuf};

use clap::Args;

use super::sweep_text::grid;
use crate::output_file::OutputFile;
use crate::refusal::Refusal;
use crate::sweep::{Grid, Parameter};
use crate::toolchain;

/// Where the figure goes when no file is named, from the workspace's folder.
const FIGURE: &str = "target/hil/sweep.svg";

/// The arguments of a sweep.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct SweepArguments {
    /// Fly many settings natively, LOG or all logs of a folder: p-run, failsafe or quantum,
    /// each NAME=A..B, NAME=A..B/N with N values, or NAME=V
    #[arg(long, value_name = "NAME=A..B,...", value_parser = grid)]
    pub(super) sweep: Option<Grid>,
    /// Draw the sweep's trade curves to this file [default: target/hil/sweep.svg]
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
}

impl SweepArguments {
    /// Refuses options that contradict a sweep, or that only a sweep has.
    ///
    /// `single` says which of the sweep's parameters have an option of their own.
    pub(super) fn check(
        &self,
        log: Option<&Path>,
        single: &[(Parameter, bool)],
        clock: bool,
    ) -> Result<(), Refusal> {
        let refuse = |line: String| Err(Refusal::new(line));
        let Some(grid) = &self.sweep else {
            return match (&self.svg, log) {
                (Some(file), _) => refuse(format!(
                    "--svg {}: only a sweep is drawn, add --sweep p-run=0.2..0.9",
                    file.display()
                )),
                (_, Some(log)) if log.is_dir() => refuse(format!(
                    "{}: is a folder, name one log, or add --sweep p-run=0.2..0.9 to fly all of it",
                    log.display()
                )),
                _ => Ok(()),
            };
        };
        if clock {
            return refuse(format!(
                "--sweep {grid}: flies reactive control, and periodic control at equal runs beside \
                 it; leave out --rate and --policy periodic, or use --policy reactive"
            ));
        }
        for (parameter, given) in single {
            if *given && grid.names(*parameter) {
                let name = parameter.name();
                return refuse(format!(
                    "--{name}: --sweep names {name} too, leave one of them out"
                ));
            }
        }
        match &self.svg {
            Some(file) => check_file(file, log),
            None => Ok(()),
        }
    }

    /// The file to draw to: none beside `--json`, unless one is named.
    pub(super) fn figure(&self, json: bool) -> Option<PathBuf> {
        match &self.svg {
            Some(file) => Some(file.clone()),
            None if json => None,
            None => Some(toolchain::root().join(FIGURE)),
        }
    }
}

/// Writes the figure, and makes the folder of the default one.
///
/// # Errors
/// A file that cannot be written.
pub(super) fn write_figure(file: &Path, svg: &str) -> Result<(), Refusal> {
    let output = OutputFile::new("svg", file);
    if file.ends_with(FIGURE)
        && let Some(folder) = file.parent()
    {
        std::fs::create_dir_all(folder).map_err(|error| output.refusal(error))?;
    }
    output.write(svg)
}

/// The figure goes to a file of its own.
fn check_file(file: &Path, log: Option<&Path>) -> Result<(), Refusal> {
    let output = OutputFile::new("svg", file);
    output.check()?;
    match log {
        Some(log) if log.is_dir() && !is_figure(file) => {
            // It may be one of the logs in the folder.
            let name = file.file_name().unwrap_or_default();
            output.check_is_not(&log.join(name))
        }
        Some(log) if !log.is_dir() => output.check_is_not(log),
        _ => Ok(()),
    }
}

fn is_figure(file: &Path) -> bool {
    file.extension().is_some_and(|name| name == "svg")
}
