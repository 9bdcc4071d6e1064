//! Scenarios: flights in which something breaks, and what is expected of them.
//!
//! `hil-tests/scenarios/*.toml` holds them. One that shows a weakness of the firmware says so: it is flown and shown
//! all the same, with what is known of it.

mod breach;
mod file;
mod random;
mod report;

use anyhow::{Context, Result};
use reflex::config::SETTINGS;
use reflex::settings::Settings;

use crate::closed_loop::contention::Contention;
use crate::closed_loop::{FaultReport, FlyOptions, Flyer, Mission, Scene, Stress, fly};
use crate::faults::Script;
use crate::logics::LogicName;
use crate::parallel;
use crate::progress::{Progress, Silent};

use breach::Breach;
pub(crate) use file::read;
pub use file::{Scenario, read_all};
pub use random::{RandomScripts, fly_random};
pub use report::{ScenarioReport, Scenarios};

/// Where they are flown.
const ENVIRONMENT: &str = "arch";
/// What flies, unless a scenario says otherwise.
const AIRFRAME: &str = "quad_x";

/// Flies each scenario with a logic under each seed, on every core.
///
/// # Errors
/// As those of [`fly`].
pub fn fly_all(
    scenarios: &[Scenario],
    (logic, seeds): (LogicName, &[u32]),
    flyer: Flyer<'_>,
    progress: &mut dyn Progress,
) -> Result<Vec<ScenarioReport>> {
    let flights: Vec<_> = (scenarios.iter())
        .flat_map(|scenario| seeds.iter().map(move |seed| (scenario, *seed)))
        .collect();
    let flown = parallel::map(
        &flights,
        0,
        |(scenario, seed)| {
            let came = fly_one(scenario, (logic, *seed), flyer);
            came.with_context(|| format!("scenario {} with seed {seed}", scenario.name()))
        },
        progress,
    )?;
    flown.into_iter().collect()
}

fn fly_one(
    scenario: &Scenario,
    (logic, seed): (LogicName, u32),
    flyer: Flyer<'_>,
) -> Result<ScenarioReport> {
    let scene = Scene::load(ENVIRONMENT, scenario.airframe(), None)?;
    let played = (scenario.script.clone(), scenario.duration_s());
    let came = fly_script(&scene, (logic, seed), played, flyer)?;
    Ok(ScenarioReport::of(scenario, (logic, seed), came))
}

/// Hovers while a script is played; the second number is how long, s.
fn fly_script(
    scene: &Scene,
    (logic, seed): (LogicName, u32),
    (faults, duration_s): (Script, f64),
    flyer: Flyer<'_>,
) -> Result<FaultReport> {
    let options = FlyOptions {
        gains: logic.into(),
        settings: Settings { seed, ..SETTINGS },
        mission: Mission::Hover,
        duration_s,
        scored_from_s: None,
        stress: Stress::default(),
        faults,
        record: None,
        contention: Contention::default(),
    };
    let flown = fly(scene, &options, flyer, &mut Silent)?;
    flown.report.faults.context("nothing breaks in it")
}
