//! The command line of `cargo hil`.
//!
//! Every command refuses senseless input in one line on stderr and exit code 2, fails with one
//! line and exit code 1, and with `--json` writes one JSON object to stdout and nothing else.

mod bar;
mod bench;
mod campaign;
mod declared_options;
mod faults;
mod flight_numbers;
mod fly;
mod fuzz;
mod graph;
mod info;
mod log_arguments;
mod logic_arguments;
mod magnetometer;
mod memory;
mod profile;
mod quantities;
mod recorded_arguments;
mod replay;
mod replay_arguments;
mod settings_arguments;
mod simulated_arguments;
mod sweep_arguments;
mod sweep_text;
mod test;
mod tune;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use anyhow::Result;
use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

#[cfg(test)]
pub(crate) use sweep_text::grid as grid_of;

use crate::refusal::Refusal;
use recorded_flights::FlightError;
use reflex_config::ConfigError;

/// Exit code of input that is refused.
const REFUSED: u8 = 2;
/// Exit code of a command that failed.
const FAILED: u8 = 1;

/// Flies, measures and tests the Reflex firmware without hardware.
#[derive(Debug, Parser)]
#[command(bin_name = "cargo hil", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Boot the firmware on the emulated board and replay a recorded flight into its sensors
    Replay(Box<replay_arguments::ReplayArguments>),
    /// Say what a log holds: vehicle, sensors, flights, gaps, and what a replay would take
    Info(info::InfoArguments),
    /// Fly a simulated drone in wind, by the firmware on the emulated board
    Fly(Box<fly::FlyArguments>),
    /// Fly hundreds of simulated hours, reactive against periodic control, and report
    Campaign(campaign::CampaignArguments),
    /// Fly every scenario of faults, and check what becomes of the drone
    Faults(faults::FaultsArguments),
    /// Count the instructions of every part on the emulated core, against its limit
    Bench(bench::BenchArguments),
    /// Count where the instructions of a flight go: by part of the firmware, function and task
    Profile(profile::ProfileArguments),
    /// Measure flash, by part of the firmware, and RAM with each control logic
    Memory(memory::MemoryArguments),
    /// Try the neighbours of every configured value on recorded flights, and propose what pays
    Tune(Box<tune::TuneArguments>),
    /// Draw a control logic as a graph, for Graphviz and as SVG
    Graph(graph::GraphArguments),
    /// Try inputs that nobody meant on all that reads
    Fuzz(fuzz::FuzzArguments),
    /// Find the hard and soft iron of a board in a log of its turning, for its file in config/boards/
    Magnetometer(magnetometer::MagnetometerArguments),
    /// Run everything that continuous integration runs
    Test,
}

/// Parses the arguments (the program's name first) and runs the command.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) if is_help(error.kind()) => {
            // Help and version are longer than a line; a command without its subcommand asks for help.
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
        Err(error) => {
            complain(&one_line(&error.to_string()));
            return ExitCode::from(REFUSED);
        }
    };
    let result = match &cli.command {
        Command::Replay(arguments) => replay::run(arguments),
        Command::Info(arguments) => info::run(arguments),
        Command::Fly(arguments) => fly::run(arguments),
        Command::Campaign(arguments) => campaign::run(arguments),
        Command::Faults(arguments) => faults::run(arguments),
        Command::Bench(arguments) => bench::run(arguments),
        Command::Profile(arguments) => profile::run(arguments),
        Command::Memory(arguments) => memory::run(arguments),
        Command::Tune(arguments) => tune::run(arguments),
        Command::Graph(arguments) => graph::run(arguments),
        Command::Fuzz(arguments) => fuzz::run(arguments),
        Command::Magnetometer(arguments) => magnetometer::run(arguments),
        Command::Test => test::run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            complain(&format!("error: {}", one_line(&format!("{error:#}"))));
            ExitCode::from(exit_code(&error))
        }
    }
}

fn is_help(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::DisplayHelp
            | ErrorKind::DisplayVersion
            | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    )
}

fn exit_code(error: &anyhow::Error) -> u8 {
    let refused = error.chain().any(|cause| {
        cause.is::<Refusal>() || cause.is::<FlightError>() || cause.is::<ConfigError>()
    });
    if refused { REFUSED } else { FAILED }
}

fn complain(line: &str) {
    // Where stderr is closed, there is nowhere to write.
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Writes a command's result to stdout.
fn print(text: &str) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    let written = stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush());
    match written {
        // Whoever reads has seen enough, as `head` has.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => Ok(other?),
    }
}

/// A message of several lines as one, without usage and general hints.
fn one_line(message: &str) -> String {
    message
        .lines()
        .map(str::trim)
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more information"))
        .filter(|line| !line.is_empty() && !line.starts_with("tip: to pass"))
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    mod reference;

    use clap::CommandFactory;

    use super::*;

    fn refusal(arguments: &[&str]) -> String {
        let arguments = ["cargo hil"].iter().chain(arguments);
        one_line(&Cli::try_parse_from(arguments).unwrap_err().to_string())
    }

    #[test]
    fn wrong_usage_is_one_line() {
        for (arguments, expected) in [
            (&["fly-away"][..], "unrecognized subcommand 'fly-away'"),
            (&["replay", "--sped", "1"], "unexpected argument '--sped'"),
            (
                &["replay", "--policy", "lazy"],
                "[possible values: reactive, periodic]",
            ),
            (
                &["replay", "--rate"],
                "a value is required for '--rate <HZ>'",
            ),
            (
                &["replay", "--seed", "1", "--seed", "2"],
                "cannot be used multiple times",
            ),
            (&["bench", "--quick"], "unexpected argument '--quick'"),
            (&["test", "more"], "unexpected argument 'more'"),
        ] {
            let line = refusal(arguments);
            assert!(line.starts_with("error: "), "{line:?}");
            assert!(
                line.contains(expected),
                "{line:?} does not say {expected:?}"
            );
            assert_eq!(line.lines().count(), 1, "{line:?}");
        }
    }

    #[test]
    fn a_command_that_lacks_its_subcommand_says_which_there_are() {
        for words in [&[][..], &["profile"]] {
            let error = Cli::try_parse_from(["cargo hil"].iter().chain(words)).unwrap_err();
            assert!(is_help(error.kind()), "{words:?}");
            let help = error.to_string();
            assert!(help.contains("fly ") && help.contains("replay "), "{help}");
        }
        let all = Cli::try_parse_from(["cargo hil"]).unwrap_err().to_string();
        for command in Cli::command().get_subcommands() {
            let about = command.get_about().expect("a sentence").to_string();
            assert!(all.contains(&about), "{about}");
        }
    }

    #[test]
    fn refusals_bad_logs_and_bad_configuration_are_told_from_failures() {
        assert_eq!(exit_code(&Refusal::new("no").into()), REFUSED);
        let wrapped = anyhow::Error::from(Refusal::new("no")).context("while asking");
        assert_eq!(exit_code(&wrapped), REFUSED);
        let unknown = crate::closed_loop::Scene::load("moon", reflex::config::AIRFRAME, None);
        assert_eq!(exit_code(&unknown.unwrap_err()), REFUSED);
        assert_eq!(exit_code(&anyhow::anyhow!("broken")), FAILED);
    }

    #[test]
    fn the_command_line_is_well_formed() {
        Cli::command().debug_assert();
    }
}
