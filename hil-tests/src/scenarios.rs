//! Scenarios: flights in which something breaks, and what is expected of them.
//!
//! `hil-tests/scenarios/*.toml` holds them. One that shows a weakness of the firmware says so: it is flown and shown
//! all the same, with what is known of it.

mod file;
mod report;

use anyhow::{Context, Result};
use reflex::config::SETTINGS;
use reflex::settings::Settings;

use crate::closed_loop::contention::Contention;
use crate::closed_loop::{FlyOptions, Flyer, Mission, Scene, Stress, fly};
use crate::logics::LogicName;
use crate::progress::{Progress, Silent};

pub(crate) use file::read;
pub use file::{Scenario, read_all};
pub use report::{ScenarioReport, Scenarios};

/// From take-off to the end of each, s.
pub const DURATION_S: f64 = 45.0;
/// Where they are flown.
const ENVIRONMENT: &str = "arch";

/// Flies scenarios with a logic, each above its start.
///
/// # Errors
/// As those of [`fly`].
pub fn fly_all(
    scenarios: &[Scenario],
    (logic, seed): (LogicName, u32),
    flyer: Flyer<'_>,
    progress: &mut dyn Progress,
) -> Result<Scenarios> {
    let mut reports = Vec::new();
    for (done, scenario) in scenarios.iter().enumerate() {
        progress.done(done as f64, scenarios.len() as f64);
        let scene = Scene::load(ENVIRONMENT, scenario.airframe(), None)?;
        let options = FlyOptions {
            gains: logic.into(),
            settings: Settings { seed, ..SETTINGS },
            mission: Mission::Hover,
            duration_s: DURATION_S,
            scored_from_s: None,
            stress: Stress::default(),
            faults: scenario.script.clone(),
            contention: Contention::default(),
        };
        let flown = fly(&scene, &options, flyer, &mut Silent)
            .with_context(|| format!("scenario {}", scenario.name()))?;
        let came = flown.report.faults.context("a scenario without a fault")?;
        reports.push(ScenarioReport::of(scenario, came));
    }
    Ok(Scenarios {
        logic: logic.word().to_owned(),
        seed,
        scenarios: reports,
    })
}
