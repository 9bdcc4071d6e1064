//! `cargo hil fly`: a simulated flight in wind, and what came of it.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use reflex::config::AIRFRAME;

use super::bar::Bar;
use super::quantities::number;
use super::settings_arguments::SettingsArguments;
use crate::airframes::{self, Variant};
use crate::closed_loop::{self, FlyOptions, Flyer, Mission, Scene, Stress, plot, report};
use crate::firmware::Firmware;
use crate::logics::LogicName;
use crate::output_file::OutputFile;
use crate::progress::Progress;
use crate::refusal::Refusal;

/// Speeds of the core in MHz: below, start-up waits for sensors until after take-off, since it
/// counts that time in instructions.
const CLOCKS_MHZ: std::ops::RangeInclusive<u32> = 36..=672;
/// Longest flight, s: a day.
const LONGEST_S: f64 = 86_400.0;

/// What a flight is told. Defaults are those of `config/`.
#[derive(Clone, Debug, Args)]
pub(super) struct FlyArguments {
    /// Where to fly: a file of config/environments/
    #[arg(long, value_name = "NAME", default_value = "rugby")]
    environment: String,
    /// What to fly: a file of config/airframes/ with one in config/vehicles/; another one than
    /// that of config/selection.toml is built first
    #[arg(long, value_name = "NAME", default_value = AIRFRAME)]
    airframe: String,
    /// Control logic that flies: the firmware is built with it [default: that of config/selection.toml]
    #[arg(long, value_enum)]
    logic: Option<LogicName>,
    /// How many times as fast as configured attitude and rate loops are: 0.5, 0.7, 1, 1.4 or 2;
    /// all but 1 are built first
    #[arg(long, value_name = "FACTOR", value_parser = number, allow_negative_numbers = true, default_value = "1")]
    bandwidth: f64,
    /// What the drone is to do
    #[arg(long, value_enum, default_value = "waypoints")]
    mission: Mission,
    #[command(flatten)]
    settings: SettingsArguments,
    /// From take-off to the end, in s
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true, default_value = "60")]
    duration: f64,
    /// Where the scored part begins, in s from take-off [default: 10 or the end of the warm-up, whichever is later]
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    scored_from: Option<f64>,
    /// Speed of the emulated core; buses and timers keep theirs [default: 168]
    #[arg(long, value_name = "MHZ")]
    clock_mhz: Option<u32>,
    /// Fly the same code on this computer, without firmware and emulator: 100 times as fast
    #[arg(long)]
    native: bool,
    /// Stress: how many times as much the drone answers its motors, 0.1 to 10
    #[arg(long, value_name = "FACTOR", value_parser = number, allow_negative_numbers = true, default_value = "1")]
    plant_gain: f64,
    /// Stress: how much later motor commands apply, 0 to 0.2 s
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true, default_value = "0")]
    plant_delay: f64,
    /// Draw the flight to this SVG file
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Print the report as one JSON object instead of a summary
    #[arg(long)]
    json: bool,
}

/// Flies, then prints the report. A crash is reported, and fails the command.
pub(super) fn run(arguments: &FlyArguments) -> Result<()> {
    let options = arguments.options()?;
    let mut bar = Bar::new();
    let variant = Variant {
        airframe: arguments.airframe.clone(),
        bandwidth: arguments.bandwidth,
    };
    if !variant.built_in() {
        let program = airframes::program(&variant, &mut bar);
        bar.finish();
        return super::become_program(program?);
    }
    let scene = Scene::load(&arguments.environment)?;
    let flown = arguments.fly(&scene, &options, &mut bar);
    bar.finish();
    let flown = flown?;
    if let Some(file) = &arguments.plot {
        OutputFile::new("plot", file).write(&plot::figure(&flown).to_svg()?)?;
    }
    let report = &flown.report;
    super::print(&if arguments.json {
        report.to_json()?
    } else {
        report::summary(report)
    })?;
    match report.crash_line() {
        None => Ok(()),
        Some(line) => bail!("{line}"),
    }
}

impl FlyArguments {
    fn options(&self) -> Result<FlyOptions, Refusal> {
        let refuse = |line: String| Err(Refusal::new(line));
        if let Some(file) = &self.plot {
            OutputFile::new("plot", file).check()?;
        }
        let settings = self.settings.settings()?;
        if !(self.duration > 0.0 && self.duration <= LONGEST_S) {
            return refuse(format!(
                "--duration {}: must be above 0 and at most {LONGEST_S} s",
                self.duration
            ));
        }
        if let Some(from) = self.scored_from
            && !(0.0..self.duration).contains(&from)
        {
            return refuse(format!(
                "--scored-from {from}: must be 0 to less than the duration of {} s",
                self.duration
            ));
        }
        if !(0.1..=10.0).contains(&self.plant_gain) {
            return refuse(format!(
                "--plant-gain {}: must be 0.1 to 10",
                self.plant_gain
            ));
        }
        if !(0.0..=0.2).contains(&self.plant_delay) {
            return refuse(format!(
                "--plant-delay {}: must be 0 to 0.2 s",
                self.plant_delay
            ));
        }
        match self.clock_mhz {
            Some(mhz) if self.native => refuse(format!(
                "--clock-mhz {mhz}: natively there is no processor, leave out --native"
            )),
            Some(mhz) if !CLOCKS_MHZ.contains(&mhz) => refuse(format!(
                "--clock-mhz {mhz}: must be {} to {} MHz",
                CLOCKS_MHZ.start(),
                CLOCKS_MHZ.end()
            )),
            _ => Ok(FlyOptions {
                logic: self.logic.unwrap_or_else(LogicName::configured),
                settings,
                mission: self.mission,
                duration_s: self.duration,
                scored_from_s: self.scored_from,
                stress: Stress {
                    gain: self.plant_gain,
                    delay_s: self.plant_delay,
                },
            }),
        }
    }

    fn fly(
        &self,
        scene: &Scene,
        options: &FlyOptions,
        bar: &mut Bar,
    ) -> Result<closed_loop::Flown> {
        let firmware = match self.native {
            true => None,
            false => Some(Firmware::build(options.logic, bar)?),
        };
        let flyer = match &firmware {
            None => Flyer::Native,
            Some(firmware) => Flyer::Emulated(firmware, self.clock_mhz.unwrap_or(168)),
        };
        bar.stage(&format!("Flying in {}", self.environment));
        closed_loop::fly(scene, options, flyer, bar)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;
    use clap::Parser;

    #[derive(Parser)]
    struct Only {
        #[command(flatten)]
        arguments: FlyArguments,
    }

    /// What is said to these arguments.
    fn refusal(line: &str) -> String {
        let words = ["fly"].into_iter().chain(line.split_whitespace());
        match Only::try_parse_from(words) {
            Err(error) => error.to_string(),
            Ok(only) => match only.arguments.options() {
                Err(refusal) => refusal.to_string(),
                Ok(_) => String::new(),
            },
        }
    }

    #[test]
    fn senseless_arguments_are_refused_with_their_range() {
        for (line, expected) in [
            ("--mission joyride", "[possible values: hover, waypoints]"),
            (
                "--logic px4",
                "[possible values: cascade, arducopter, cleanflight, openpilot, observer]",
            ),
            (
                "--duration 0",
                "--duration 0: must be above 0 and at most 86400 s",
            ),
            ("--duration nan", "must be a finite number"),
            (
                "--scored-from 60",
                "--scored-from 60: must be 0 to less than the duration of 60 s",
            ),
            (
                "--scored-from -1",
                "--scored-from -1: must be 0 to less than",
            ),
            ("--clock-mhz 8", "--clock-mhz 8: must be 36 to 672 MHz"),
            (
                "--clock-mhz 36 --native",
                "natively there is no processor, leave out --native",
            ),
            ("--plant-gain 0", "--plant-gain 0: must be 0.1 to 10"),
            ("--plot src", "--plot src: is a folder"),
            (
                "--plot nowhere/a.svg",
                "--plot nowhere/a.svg: its folder does not exist",
            ),
            ("--plant-delay 1", "--plant-delay 1: must be 0 to 0.2 s"),
            ("--rate 100", "--rate: reactive control has none"),
            ("--policy periodic --rate 2000", "must be 1 to 1000 Hz"),
            ("--seed -1", "must be a whole number, 0 to 4294967295"),
        ] {
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
        let told = Scene::load("moon").unwrap_err().to_string();
        assert!(told.ends_with("must be one of: arch, lab, rugby"), "{told}");
        let mut variant = Variant::of("kite");
        let told = airframes::program(&variant, &mut Silent)
            .unwrap_err()
            .to_string();
        assert_eq!(told, "--airframe kite: must be one of hexa_x, quad_x, y6");
        variant = Variant::of(AIRFRAME);
        variant.bandwidth = 3.0;
        let told = airframes::program(&variant, &mut Silent)
            .unwrap_err()
            .to_string();
        assert_eq!(
            told,
            "--bandwidth 3: must be one of [1.0, 0.5, 0.7, 1.4, 2.0]"
        );
    }
}
