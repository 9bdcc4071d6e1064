//! The plans that have a name.

use reflex::config::AIRFRAME;

use super::plan::Plan;

impl Plan {
    /// What Bregu et al. 2016 flew for eight months, section 7: 260 hours and more.
    ///
    /// Their three control logics, and the cascade that Reflex comes with.
    pub(super) fn paper() -> Self {
        Self {
            name: "paper".into(),
            environments: owned(&["lab", "rugby", "arch"]),
            airframes: owned(&["quad_x", "hexa_x", "y6"]),
            logics: owned(&["arducopter", "openpilot", "cleanflight", "cascade"]),
            seeds: 26,
            sweep_seeds: 12,
            tuned_seeds: 15,
            hover_seeds: 10,
            rates_hz: vec![12, 25, 50, 100, 200, 1000],
            sweep_logic: "arducopter".into(),
            p_runs: vec![200, 300, 400, 500, 700, 800],
            failsafes: vec![10, 50, 200, 300],
            duration_s: 100,
            long: ("hexa_x".into(), 600),
            emulated_s: Some(60),
        }
    }

    /// Every kind of flight once or twice, in a minute.
    pub(super) fn smoke() -> Self {
        Self {
            name: "smoke".into(),
            environments: owned(&["lab", "arch"]),
            airframes: owned(&[AIRFRAME]),
            logics: owned(&["arducopter", "cascade"]),
            seeds: 2,
            sweep_seeds: 2,
            tuned_seeds: 0,
            hover_seeds: 1,
            rates_hz: vec![25],
            sweep_logic: "arducopter".into(),
            p_runs: vec![300],
            failsafes: vec![200],
            duration_s: 30,
            long: (AIRFRAME.into(), 40),
            emulated_s: Some(16),
        }
    }
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}
