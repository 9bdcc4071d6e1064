//! The arguments of `cargo hil replay`, and which of them go together.

use std::path::{Path, PathBuf};

use clap::Args;

use super::recorded_arguments::RecordedArguments;
use super::sweep_arguments::SweepArguments;
use crate::flight_log::FlightLog;
use crate::output_file::OutputFile;
use crate::refusal::Refusal;
use crate::replay::options::ReplayOptions;
use crate::sweep::{Parameter, SweepOptions};

/// The options of a replay. Defaults are those of `config/`; no option needs a rebuild.
#[derive(Clone, Debug, Args)]
pub(super) struct ReplayArguments {
    #[command(flatten)]
    flight: RecordedArguments,
    /// Fly the same control logic on this computer, without firmware and emulator: 100 times as fast
    #[arg(long)]
    pub(super) native: bool,
    /// Break things on the way, as a script says: TOML, see docs/simulation.md
    #[arg(long, value_name = "FILE", conflicts_with = "sweep")]
    faults: Option<PathBuf>,
    #[command(flatten)]
    pub(super) sweep: SweepArguments,
    /// Write the firmware's decoded log to this file
    #[arg(long, value_name = "FILE")]
    defmt: Option<PathBuf>,
    /// Write the flight to this file as well, for other tools: .mcap or .ulg, see docs/records.md
    #[arg(long, value_name = "FILE", conflicts_with = "sweep")]
    record: Option<PathBuf>,
    /// Print the report as one JSON object instead of a summary
    #[arg(long)]
    pub(super) json: bool,
}

impl ReplayArguments {
    /// The options, once every mix of arguments is checked.
    ///
    /// # Errors
    /// The first mix or value that does not, with the option's name and its range.
    pub(super) fn options(&self) -> Result<ReplayOptions, Refusal> {
        let log = self.flight.log()?;
        self.check_sweep(log)?;
        let options = self.flight.options()?;
        if let Some(file) = &self.defmt {
            let native = match (&self.sweep.sweep, self.native) {
                (Some(_), _) => "--sweep, which is native",
                (None, true) => "--native",
                (None, false) => "",
            };
            if !native.is_empty() {
                return Err(Refusal::new(format!(
                    "--defmt {}: only the firmware writes a log, leave out {native}",
                    file.display()
                )));
            }
            let file = OutputFile::new("defmt", file);
            file.check()?;
            if let Some(log) = log {
                file.check_is_not(log)?;
            }
        }
        if let Some(file) = &self.record {
            FlightLog::check(file)?;
            if let Some(log) = log {
                FlightLog::check_is_not(file, log)?;
            }
        }
        Ok(ReplayOptions {
            defmt: self.defmt.clone(),
            record: self.record.clone(),
            faults: self.faults.clone(),
            ..options
        })
    }

    /// The options of a sweep, where one is asked for.
    ///
    /// # Errors
    /// As [`ReplayArguments::options`].
    pub(super) fn sweep_options(&self) -> Result<Option<SweepOptions>, Refusal> {
        let Some(grid) = self.sweep.sweep.clone() else {
            return Ok(None);
        };
        Ok(Some(SweepOptions {
            replay: self.options()?,
            grid,
            threads: 0,
        }))
    }

    fn check_sweep(&self, log: Option<&Path>) -> Result<(), Refusal> {
        let single = [
            (Parameter::PRun, self.flight.settings.gives("p-run")),
            (Parameter::Failsafe, self.flight.settings.gives("failsafe")),
            (Parameter::Quantum, self.flight.settings.gives("quantum")),
        ];
        let by_clock = self.flight.settings.is_by_clock();
        self.sweep.check(log, &single, by_clock)
    }
}

#[cfg(test)]
mod tests;
