//! A drone with nothing wrong raises no alarm, wherever it flies.

use clap::ValueEnum;
use reflex::app::Fault;
use reflex::settings::Policy;

use super::{FlyOptions, Flyer, Mission, Scene, SimulatedFlight, options};
use crate::logics::{GainSet, LogicName};

/// Verdicts on sensors and motors: what a flight without a fault never counts.
pub(crate) const ALARMS: [Fault; 14] = [
    Fault::ImuSilent,
    Fault::ImuStarved,
    Fault::ImuSpike,
    Fault::GyroFrozen,
    Fault::GyroRail,
    Fault::GyroJumping,
    Fault::AccelFrozen,
    Fault::AccelRail,
    Fault::AccelJumping,
    Fault::Implausible,
    Fault::AccelsApart,
    Fault::MotorLost,
    Fault::Contrary,
    Fault::BatteryCollapsed,
];

/// Alarms of a flight, with its name.
fn alarms(environment: &str, airframe: &str, options: &FlyOptions) -> Vec<String> {
    let scene = Scene::load(environment, airframe, None).unwrap();
    let mut flight = SimulatedFlight::new(&scene, options, Flyer::Native).unwrap();
    while flight.goes_on() {
        flight.step().unwrap();
    }
    let name = format!(
        "{environment} {airframe} {:?} {:?}",
        options.gains.logic(),
        options.settings.policy
    );
    let raised = ALARMS.into_iter().chain([Fault::FieldBent]);
    raised
        .filter(|alarm| flight.board.counted(*alarm) > 0)
        .map(|alarm| format!("{name}: {alarm:?}"))
        .collect()
}

#[test]
fn whole_drones_raise_no_alarm_in_any_environment() {
    let mut raised = Vec::new();
    for (seed, environment) in (10..).zip(["lab", "rugby", "arch"]) {
        for airframe in ["quad_x", "hexa_x", "y6"] {
            for logic in LogicName::value_variants() {
                for policy in [Policy::Reactive, Policy::Periodic] {
                    let options = options(*logic, policy, seed);
                    raised.extend(alarms(environment, airframe, &options));
                }
            }
        }
    }
    assert_eq!(raised, Vec::<String>::new());
}

#[test]
fn faster_and_slower_loops_and_stronger_drones_raise_none_either() {
    let mut raised = Vec::new();
    for (seed, bandwidth) in (20..).zip([0.7, 1.5, 2.0]) {
        for gain in [0.7, 1.0, 1.5] {
            let mut options = options(LogicName::configured(), Policy::Reactive, seed);
            options.gains = GainSet::load(LogicName::configured(), None, bandwidth).unwrap();
            options.stress.gain = gain;
            options.mission = Mission::Hover;
            raised.extend(alarms("arch", "quad_x", &options));
        }
    }
    assert_eq!(raised, Vec::<String>::new());
}
