//! The arguments that say which simulated flight is flown.

use anyhow::Result;
use clap::Args;
use reflex::config::AIRFRAME;

use super::flight_numbers::{
    BANDWIDTH, CLOCK, DURATION, FlightNumbers, GYRO_BIAS, HARD, JITTER, LATE, LATE_SHARE, MOTORS,
    PLANT_DELAY, PLANT_GAIN, SOFT_DIAGONAL, SOFT_OFF_DIAGONAL, WARM_UP,
};
use super::logic_arguments::LogicArguments;
use super::quantities::number;
use super::settings_arguments::SettingsArguments;
use crate::closed_loop::contention::{Contention, Scheduler};
use crate::closed_loop::{FlyOptions, Mission, Scene, Stress};
use crate::faults::Script;
use crate::refusal::Refusal;

/// What a flight is told. Defaults are those of `config/`.
#[derive(Clone, Debug, Args)]
pub(super) struct SimulatedArguments {
    /// Where to fly: a file of config/environments/
    #[arg(long, value_name = "NAME", default_value = "rugby")]
    pub(super) environment: String,
    /// How the drone's place is known: a file of config/positions/ [default: the environment's]
    #[arg(long, value_name = "NAME")]
    position: Option<String>,
    /// What to fly: a file of config/airframes/ with one in config/vehicles/
    #[arg(long, value_name = "NAME", default_value = AIRFRAME)]
    airframe: String,
    #[command(flatten)]
    logic: LogicArguments,
    /// What the drone is to do
    #[arg(long, value_enum, default_value = "waypoints")]
    mission: Mission,
    #[command(flatten)]
    settings: SettingsArguments,
    #[command(flatten)]
    pub(super) numbers: FlightNumbers,
    /// Whether other tasks give way to control at once, or as ArduPilot's: once they have ended
    #[arg(long, value_enum, default_value = "preemptive")]
    scheduler: Scheduler,
    /// Where the scored part begins, in s from take-off [default: 10 or the end of the warm-up, whichever is later]
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    scored_from: Option<f64>,
}

impl SimulatedArguments {
    /// The options, once every mix of arguments is checked.
    ///
    /// # Errors
    /// The first value that is not in its range.
    pub(super) fn options(&self) -> Result<FlyOptions> {
        let numbers = &self.numbers;
        let settings = self.settings.settings()?;
        let duration_s = numbers.get(DURATION)?;
        if let Some(from) = self.scored_from
            && !(0.0..duration_s).contains(&from)
        {
            let line = format!(
                "--scored-from: {from} is out of range, must be 0 to less than the duration of \
                 {duration_s} s"
            );
            return Err(Refusal::new(line).into());
        }
        self.clock_mhz()?;
        Ok(FlyOptions {
            gains: self.logic.gains(numbers.get(BANDWIDTH)?)?,
            settings,
            mission: self.mission,
            duration_s,
            scored_from_s: self.scored_from,
            stress: Stress {
                gain: numbers.get(PLANT_GAIN)?,
                delay_s: numbers.get(PLANT_DELAY)?,
            },
            faults: Script::default(),
            record: None,
            contention: Contention {
                jitter_s: numbers.get(JITTER)?,
                late_share: numbers.get(LATE_SHARE)?,
                late_s: numbers.get(LATE)?,
                scheduler: self.scheduler,
            },
        })
    }

    /// Speed of the emulated core, MHz.
    ///
    /// # Errors
    /// It is out of its range.
    pub(super) fn clock_mhz(&self) -> Result<u32, Refusal> {
        Ok(self.numbers.get(CLOCK)? as u32)
    }

    /// Where to fly, and what.
    ///
    /// # Errors
    /// As those of [`Scene::load`]; a number that is not in its range.
    pub(super) fn scene(&self) -> Result<Scene> {
        let position = self.position.as_deref();
        let mut scene = Scene::load(&self.environment, &self.airframe, position)?;
        let numbers = &self.numbers;
        let gyroscope = &mut scene.vehicle.gyroscope;
        numbers.replace(GYRO_BIAS, &mut gyroscope.turn_on_deg_s)?;
        numbers.replace(WARM_UP, &mut gyroscope.warm_up_c)?;
        let magnetometer = &mut scene.vehicle.magnetometer;
        for (setting, axes) in [
            (HARD, &mut magnetometer.hard_iron_gauss),
            (SOFT_DIAGONAL, &mut magnetometer.soft_iron_diagonal),
            (SOFT_OFF_DIAGONAL, &mut magnetometer.soft_iron_off_diagonal),
            (MOTORS, &mut magnetometer.motor_gauss_per_a),
        ] {
            numbers.replace_axes(setting, axes)?;
        }
        Ok(scene)
    }
}
