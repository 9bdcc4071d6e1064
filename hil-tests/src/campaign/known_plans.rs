//! The plans that have a name.

use reflex::config::AIRFRAME;

use super::plan::{Plan, Trade};

/// A control logic with the gains of a real airframe.
const IRIS_PLUS: &str = "arducopter/iris_plus";

impl Plan {
    /// What Bregu et al. 2016 flew for eight months, section 7: 260 hours and more.
    ///
    /// Their three control logics, ArduCopter with the gains of a real airframe too, and the cascade that
    /// Reflex comes with; the calmest and the windiest of their environments. Six rules of equal
    /// margins take the hours of a third environment and airframe, which had shown nothing of their own.
    pub(super) fn paper() -> Self {
        Self {
            name: "paper".into(),
            environments: owned(&["lab", "arch"]),
            airframes: owned(&["quad_x", "hexa_x"]),
            logics: owned(&[
                "arducopter",
                IRIS_PLUS,
                "openpilot",
                "cleanflight",
                "cascade",
            ]),
            seeds: 20,
            sweep_seeds: 12,
            tuned_seeds: 10,
            hover_seeds: 10,
            rates_hz: vec![12, 25, 50, 100, 200, 1000],
            trade: Trade::default(),
            sweep_logic: "arducopter".into(),
            p_runs: vec![200, 300, 400, 500, 700, 800],
            failsafes: vec![10, 50, 200, 300],
            duration_s: 100,
            long: ("hexa_x".into(), 600),
            emulated_s: Some(60),
        }
    }

    /// Error over runs, and load over error, for loops of one to three times the bandwidth.
    pub(super) fn trade() -> Self {
        Self {
            name: "trade".into(),
            environments: owned(&["lab", "arch"]),
            airframes: owned(&["quad_x"]),
            logics: owned(&["arducopter", IRIS_PLUS, "openpilot", "cascade"]),
            seeds: 6,
            sweep_seeds: 0,
            tuned_seeds: 0,
            hover_seeds: 6,
            rates_hz: Vec::new(),
            trade: Trade {
                bandwidths: vec![100, 200, 300],
                budgets_us: vec![1_250, 2_500, 5_000, 12_500, 25_000, 50_000],
                rates_hz: vec![12, 18, 25, 40, 60, 100, 200, 400],
            },
            sweep_logic: "arducopter".into(),
            p_runs: Vec::new(),
            failsafes: Vec::new(),
            duration_s: 60,
            long: ("quad_x".into(), 120),
            emulated_s: Some(30),
        }
    }

    /// Every kind of flight once or twice, in a minute.
    pub(super) fn smoke() -> Self {
        Self {
            name: "smoke".into(),
            environments: owned(&["lab", "arch"]),
            airframes: owned(&[AIRFRAME]),
            logics: owned(&[IRIS_PLUS, "cascade"]),
            seeds: 2,
            sweep_seeds: 2,
            tuned_seeds: 0,
            hover_seeds: 1,
            rates_hz: vec![25],
            trade: Trade::default(),
            sweep_logic: IRIS_PLUS.into(),
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
