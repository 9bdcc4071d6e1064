//! A profile changes nothing, and everything that was executed is in it.

use super::*;
use crate::closed_loop::contention::Contention;
use crate::closed_loop::{Mission, Stress};
use crate::faults::Script;
use crate::json::to_json;
use crate::logics::LogicName;
use crate::progress::Silent;
use crate::record::HANDLERS;
use reflex::config::{AIRFRAME, SETTINGS};

/// Every sum of a profile is what the core executed, and its busy share that of the flight's own report.
fn adds_up(profile: &Profile, busy_fraction: f64, busy_with_exceptions: f64) {
    let all = profile.all.instructions;
    let sum = |shares: &[Share]| shares.iter().map(|share| share.instructions).sum::<u64>();
    assert_eq!(sum(&profile.parts), all);
    assert_eq!(sum(&profile.functions), all);
    let tasks = profile.tasks.iter().map(|task| task.share.instructions);
    assert_eq!(tasks.sum::<u64>(), all);
    let off = profile.all.busy_fraction / busy_fraction - 1.0;
    assert!(
        off.abs() < 1e-12,
        "{} {busy_fraction}",
        profile.all.busy_fraction
    );
    // Counted by their handlers' addresses there, by the processor's status here.
    let off = profile.busy_with_exceptions / busy_with_exceptions - 1.0;
    assert!(off.abs() < 1e-4, "{profile:?} {busy_with_exceptions}");
    assert!(profile.exceptions > 1_000, "{profile:?}");
    let charged = (busy_with_exceptions / busy_fraction - 1.0) * all as f64;
    let off = charged / (22.0 * profile.exceptions as f64) - 1.0;
    assert!(off.abs() < 0.01, "{charged} for {}", profile.exceptions);
    let rest = profile.parts.last().expect("a rest");
    assert_eq!(rest.name, REST);
    assert!(rest.instructions * 200 < all, "most has a part: {rest:?}");
}

#[test]
fn a_profiled_flight_is_the_same_flight_and_adds_up() {
    let scene = Scene::load("arch", AIRFRAME, None).unwrap();
    let options = FlyOptions {
        gains: LogicName::configured().into(),
        settings: SETTINGS,
        mission: Mission::Hover,
        duration_s: 3.0,
        scored_from_s: Some(1.0),
        stress: Stress::default(),
        faults: Script::default(),
        record: None,
        contention: Contention::default(),
    };
    let firmware = Firmware::build(options.gains.logic(), &mut Silent).unwrap();
    let flyer = Flyer::Emulated(Core::of(&firmware));
    let plain = closed_loop::fly(&scene, &options, flyer, &mut Silent).unwrap();
    let Profiled { profile, stacks } =
        fly(&scene, &options, (&firmware, 168), &mut Silent).unwrap();
    assert_eq!(plain.report.digest, profile.subject.digest);
    assert_eq!(plain.report.control.runs, profile.runs);
    let cpu = plain.report.cpu.unwrap();
    adds_up(&profile, cpu.busy_fraction, cpu.busy_with_exceptions);
    let entries = |name| {
        let task = profile.tasks.iter().find(|task| task.share.name == name);
        task.expect("it ran").entries
    };
    for (name, expected, most) in [
        ("CAN2_TX, hyperperiod", profile.runs, 20),
        ("EXTI0, IMU interrupt", profile.samples, 1),
        // Behind some bursts a check is read.
        ("DMA1_STREAM0, IMU sample", profile.samples, 100),
        ("idle", 0, 0),
    ] {
        let entries = entries(name);
        assert!(
            entries.abs_diff(expected) <= most,
            "{name}: {entries} {expected}"
        );
    }
    // Every call is known, down to the handler.
    for stack in stacks.iter().filter(|stack| stack.exception != 0) {
        let outermost = &stack.frames[0].function;
        assert!(
            HANDLERS.iter().any(|(name, _)| name == outermost),
            "{stack:?}"
        );
    }
}

#[test]
fn a_profiled_replay_is_the_same_replay_and_adds_up() {
    let options = ReplayOptions {
        duration_s: Some(8.0),
        ..ReplayOptions::default()
    };
    let plain = emulated::replay(&options, &mut Silent).unwrap().run;
    let Profiled { profile, stacks } = replay(&options, &mut Silent).unwrap();
    assert_eq!(plain.digest, profile.subject.digest);
    let cpu = plain.cpu.unwrap();
    let busy = [cpu.busy_fraction, cpu.busy_with_exceptions].map(Option::unwrap);
    adds_up(&profile, busy[0], busy[1]);
    let folded = folded(&stacks);
    let counts = folded
        .lines()
        .filter_map(|line| line.rsplit_once(' ')?.1.parse::<u64>().ok());
    assert_eq!(counts.sum::<u64>(), profile.all.instructions);
    let again = replay(&options, &mut Silent).unwrap();
    assert_eq!(to_json(&again.profile).unwrap(), to_json(&profile).unwrap());
    assert_eq!(again.stacks, stacks);
}

#[test]
fn a_flame_graph_is_drawn_of_every_task() {
    let options = ReplayOptions {
        duration_s: Some(4.0),
        settings: reflex::settings::Settings {
            policy: Policy::Periodic,
            ..SETTINGS
        },
        ..ReplayOptions::default()
    };
    let profiled = replay(&options, &mut Silent).unwrap();
    let svg = figure(&profiled).unwrap();
    for task in &profiled.profile.tasks {
        let handler = task.share.name.split(',').next().unwrap();
        // Less than a tenth of a pixel is not drawn.
        if task.share.instructions * 1000 > profiled.profile.all.instructions {
            assert!(svg.contains(&format!("<title>{handler} (")), "{handler}");
        }
    }
    assert_eq!(svg, figure(&profiled).unwrap());
}
