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
use crate::progress::Progress;
use crate::refusal::Refusal;

/// Speeds of the core in MHz that make sense.
const CLOCKS_MHZ: std::ops::RangeInclusive<u32> = 1..=1000;
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
    #[arg(long, value_name = "FACTOR", value_parser = number, default_value = "1")]
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
    #[arg(long, value_name = "FACTOR", value_parser = number, default_value = "1")]
    plant_gain: f64,
    /// Stress: how much later motor commands apply, 0 to 0.2 s
    #[arg(long, value_name = "SECONDS", value_parser = number, default_value = "0")]
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
        super::sweep_arguments::write_figure(file, &plot::figure(&flown).to_svg()?)?;
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
