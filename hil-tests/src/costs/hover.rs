//! A short simulated hover: what each part of the firmware executes per sample.

use anyhow::Result;
use reflex::config::{AIRFRAME, SETTINGS};
use reflex::settings::WarmUp;
use reflex::time::micros;

use super::CORE_HZ;
use super::budget::Budget;
use super::table::Cost;
use crate::closed_loop::contention::Contention;
use crate::closed_loop::{FlyOptions, Mission, Scene, Stress};
use crate::faults::Script;
use crate::firmware::Firmware;
use crate::logics::LogicName;
use crate::profile;
use crate::progress::Progress;

/// From take-off: what is counted begins when drone and models are up, and lasts for 4 s.
const FROM_S: f64 = 6.0;
const LENGTH_S: f64 = 10.0;
const WARM_UP_US: u64 = 3_000_000;

/// The mean of each part, and of all, rounded up.
pub(super) fn measure(firmware: &Firmware, progress: &mut dyn Progress) -> Result<Vec<Cost>> {
    progress.stage("Counting a hover");
    let scene = Scene::load("arch", AIRFRAME, None)?;
    let mut settings = SETTINGS;
    settings.warm_up = WarmUp::Fixed(micros(WARM_UP_US));
    let options = FlyOptions {
        gains: LogicName::configured().into(),
        settings,
        mission: Mission::Hover,
        duration_s: LENGTH_S,
        scored_from_s: Some(FROM_S),
        stress: Stress::default(),
        faults: Script::default(),
        record: None,
        contention: Contention::default(),
    };
    let mhz = (CORE_HZ / 1_000_000) as u32;
    let profile = profile::fly(&scene, &options, (firmware, mhz), progress)?.profile;
    let limits = Budget::read()?.hover_instructions_per_sample;
    let shares = profile.parts.iter().chain([&profile.all]);
    let costs = shares.map(|share| {
        let name = format!("hover, a sample: {}", share.name);
        let mean = share.instructions.div_ceil(profile.samples.max(1));
        let limit = limits.get(&share.name).copied();
        Cost {
            measured: profile.samples as usize,
            ..Cost::of(&name, vec![mean], limit, CORE_HZ)
        }
    });
    Ok(costs.collect())
}
