//! `cargo hil fly`: a simulated flight in wind, and what came of it.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;

use super::bar::Bar;
use super::flight_numbers::CLOCK;
use super::settings_arguments::refused;
use super::simulated_arguments::SimulatedArguments;
use crate::closed_loop::{self, Core, FlyOptions, Flyer, Scene, plot, report};
use crate::faults::Script;
use crate::firmware::Firmware;
use crate::flight_log::FlightLog;
use crate::json::to_json;
use crate::output_file::OutputFile;
use crate::progress::Progress;

/// Which flight is flown, on which tier, and how it is reported.
#[derive(Clone, Debug, Args)]
pub(super) struct FlyArguments {
    #[command(flatten)]
    flight: SimulatedArguments,
    /// Fly the same code on this computer, without firmware and emulator: 100 times as fast
    #[arg(long)]
    native: bool,
    /// Break things in flight, as a script says: TOML, see docs/simulation.md
    #[arg(long, value_name = "FILE")]
    faults: Option<PathBuf>,
    /// Draw the flight to this SVG file
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Write the flight to this file as well, for other tools: .mcap or .ulg, see docs/records.md
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Print the report as one JSON object instead of a summary
    #[arg(long)]
    json: bool,
}

/// Flies, then prints the report. A crash is reported, and fails the command.
pub(super) fn run(arguments: &FlyArguments) -> Result<()> {
    let mut options = arguments.options()?;
    let scene = arguments.flight.scene()?;
    if let Some(file) = &arguments.faults {
        let limits = closed_loop::limits_of(&scene, options.duration_s, arguments.native);
        options.faults = Script::read(file, &limits)?;
    }
    let mut bar = Bar::new();
    let flown = arguments.fly(&scene, &options, &mut bar);
    bar.finish();
    let flown = flown?;
    if let Some(file) = &arguments.plot {
        OutputFile::new("plot", file).write(&plot::figure(&flown).to_svg()?)?;
    }
    let report = &flown.report;
    super::print(&if arguments.json {
        to_json(report)?
    } else {
        report::summary(report)
    })?;
    match report.crash_text() {
        None => Ok(()),
        Some(line) => bail!("{line}"),
    }
}

impl FlyArguments {
    fn options(&self) -> Result<FlyOptions> {
        if let Some(file) = &self.plot {
            OutputFile::new("plot", file).check()?;
        }
        if self.native && self.flight.numbers.given(CLOCK).is_some() {
            let line = "natively there is no processor, leave out --native";
            return Err(refused(CLOCK, line).into());
        }
        if let Some(file) = &self.record {
            FlightLog::check(file)?;
        }
        Ok(FlyOptions {
            record: self.record.clone(),
            ..self.flight.options()?
        })
    }

    fn fly(
        &self,
        scene: &Scene,
        options: &FlyOptions,
        bar: &mut Bar,
    ) -> Result<closed_loop::Flown> {
        let firmware = match self.native {
            true => None,
            false => Some(Firmware::build(options.gains.logic(), bar)?),
        };
        let flyer = match &firmware {
            None => Flyer::Native,
            Some(firmware) => Flyer::Emulated(Core {
                mhz: self.flight.clock_mhz()?,
                ..Core::of(firmware)
            }),
        };
        bar.stage(&format!("Flying in {}", self.flight.environment));
        closed_loop::fly(scene, options, flyer, bar)
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use reflex::config::AIRFRAME;

    use super::*;

    #[derive(Parser)]
    struct Only {
        #[command(flatten)]
        arguments: FlyArguments,
    }

    /// arguments | what is said
    const SENSELESS: &str = "
--mission joyride | [possible values: hover, turn, waypoints]
--gains kite --logic arducopter | --gains kite: logics/arducopter/kite.toml does not exist, must be one of: iris_plus
--logic px4 | [possible values: cascade, arducopter, cleanflight, openpilot, observer]
--duration 0 | --duration: 0 is out of range, must be above 0 and at most 86400 s
--duration nan | must be a finite number
--scored-from 60 | --scored-from: 60 is out of range, must be 0 to less than the duration of 60 s
--scored-from -1 | --scored-from: -1 is out of range, must be 0 to less than
--clock-mhz 8 | --clock-mhz: 8 is out of range, must be 36 to 672 MHz
--clock-mhz 36 --native | natively there is no processor, leave out --native
--gyro-bias 61 | --gyro-bias: 61 is out of range, must be 0 to 60 deg/s
--hard-iron -5,0,0 | --hard-iron: [-5, 0, 0] is out of range, must be each -4 to 4 gauss
--hard-iron 0.1,0 | must be three numbers, one for each axis
--motor-field 1,0,0 | --motor-field: [1, 0, 0] is out of range, must be each -0.1 to 0.1 gauss for each A
--soft-iron-diagonal 0,1,1 | must be each 0.5 to 2
--plant-gain 0 | --plant-gain: 0 is out of range, must be 0.1 to 10
--plot src | --plot src: is a folder
--plot nowhere/a.svg | --plot nowhere/a.svg: its folder does not exist
--record nowhere/a.mcap | --record nowhere/a.mcap: its folder does not exist
--record flight.csv | --record flight.csv: must end in .mcap or .ulg
--plant-delay 1 | --plant-delay: 1 is out of range, must be 0 to 0.2 s
--late-share 2 | --late-share: 2 is out of range, must be 0 to 1
--scheduler fair | [possible values: preemptive, cooperative]
--bandwidth 0.1 | --bandwidth: 0.1 is out of range, must be 0.25 to 5
--bandwidth fast | must be a finite number, 0.25 to 5
--gains iris_plus --logic cascade | --gains iris_plus: logics/cascade/ holds no gains, name a file
--rate 100 | --rate: reactive control has none
--policy periodic --rate 2000 | must be 1 to 1000 Hz
--seed -1 | must be a whole number, 0 to 4294967295
";

    /// What is said to these arguments.
    fn refusal(line: &str) -> String {
        let words = ["fly"].into_iter().chain(line.split_whitespace());
        match Only::try_parse_from(words) {
            Err(error) => error.to_string(),
            Ok(only) => {
                let options = only.arguments.options();
                match options.and_then(|_| only.arguments.flight.scene()) {
                    Err(refusal) => refusal.to_string(),
                    Ok(_) => String::new(),
                }
            }
        }
    }

    #[test]
    fn senseless_arguments_are_refused_with_their_range() {
        for (line, expected) in SENSELESS
            .trim()
            .lines()
            .filter_map(|it| it.split_once(" | "))
        {
            let said = refusal(line);
            assert!(
                said.contains(expected),
                "{line}: {said:?} does not say {expected:?}"
            );
        }
        for line in [
            "",
            "--native",
            "--clock-mhz 36",
            "--policy periodic --rate 400",
        ] {
            assert_eq!(refusal(line), "", "{line}");
        }
    }

    #[test]
    fn unknown_places_and_drones_are_named_with_those_that_are_known() {
        let refusal = Scene::load("moon", AIRFRAME, None).unwrap_err().to_string();
        assert!(
            refusal.ends_with("must be one of: arch, lab, rugby"),
            "{refusal}"
        );
        let refusal = Scene::load("arch", "kite", None).unwrap_err().to_string();
        assert!(
            refusal.ends_with("must be one of: hexa_x, quad_x, y6"),
            "{refusal}"
        );
        let refusal = Scene::load("arch", AIRFRAME, Some("stars")).unwrap_err();
        assert!(
            refusal
                .to_string()
                .ends_with("must be one of: companion, motion_capture, satellites"),
            "{refusal}"
        );
    }
}
