//! Sweeps end to end: logs in a temporary folder, to tables and figure.

use crate::json::to_json;
use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use super::*;
use crate::commands::grid_of;
use crate::progress::Silent;
use crate::refusal::Refusal;
use crate::replay::native::tests::log_of_gusts;
use recorded_flights::{FlightError, Rotate, Rotation};

fn options(log: &Path, grid: &str) -> SweepOptions {
    SweepOptions {
        replay: ReplayOptions {
            log: Some(log.to_owned()),
            reading: Rotate::Named(Rotation::NONE).into(),
            ..ReplayOptions::default()
        },
        grid: grid_of(grid).expect("a grid"),
        threads: 0,
    }
}

fn swept(log: &Path, grid: &str, threads: usize) -> SweepReport {
    let options = SweepOptions {
        threads,
        ..options(log, grid)
    };
    sweep(&options, &mut Silent).unwrap_or_else(|error| panic!("{error:#}"))
}

/// A folder with two short flights, a text, a folder and a log that is cut off.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write =
        |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    write("b.csv", &log_of_gusts(12));
    write("a.csv", &log_of_gusts(10));
    write("short.csv", &log_of_gusts(2));
    write("notes.txt", "no log\n");
    write("empty.ulg", "");
    fs::create_dir(folder.path().join("more")).expect("made");
    folder
}

#[test]
fn a_folder_is_flown_in_the_order_of_names_and_what_is_no_log_is_skipped() {
    let folder = folder();
    let report = swept(folder.path(), "p-run=0.3..0.8/2", 0);
    let path = |name: &str| folder.path().join(name).display().to_string();
    let flown: Vec<(&str, f64)> = (report.points.iter())
        .map(|point| (point.log.as_str(), point.at.p_run))
        .collect();
    let (a, b) = (path("a.csv"), path("b.csv"));
    assert_eq!(flown, [(a.as_str(), 0.3), (&a, 0.8), (&b, 0.3), (&b, 0.8)]);
    let reason = |name: &str| {
        let skipped = report.skipped.iter().find(|one| one.log == path(name));
        skipped.map(|one| one.reason.as_str()).unwrap_or_default()
    };
    assert_eq!(report.skipped.len(), 4, "{:?}", report.skipped);
    assert_eq!(reason("empty.ulg"), "is empty");
    assert!(reason("more").starts_with("is a folder"));
    assert!(reason("short.csv").contains("the automatic warm-up takes at least"));
    assert!(!reason("notes.txt").contains("notes.txt"));
    let text = tables(&report);
    for expected in [&a, &b, &path("notes.txt"), "median over 2 scored logs"] {
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn the_report_and_the_figure_are_the_same_whatever_the_number_of_threads() {
    let folder = folder();
    let one = swept(folder.path(), "p-run=0.3..0.8/2,failsafe=0.05..0.1/2", 1);
    let two = swept(folder.path(), "p-run=0.3..0.8/2,failsafe=0.05..0.1/2", 2);
    assert_eq!(one.points.len(), 8);
    assert!(one.points.iter().all(|point| point.score.scored));
    assert!(one == two);
    assert_eq!(to_json(&one).expect("JSON"), to_json(&two).expect("JSON"));
    let svg = |report: &SweepReport| trade_curves(report).to_svg().expect("drawn");
    assert_eq!(svg(&one), svg(&two));
}

#[test]
fn one_log_makes_one_table_and_one_panel_with_three_curves() {
    let folder = folder();
    let log = folder.path().join("a.csv");
    let report = swept(&log, "p-run=0.2..0.9/3", 0);
    assert!(!tables(&report).contains("median"));
    let figure = trade_curves(&report);
    assert_eq!(figure.panels.len(), 1);
    let curves = figure.panels[0].curves.iter();
    let names: Vec<(&str, usize)> = curves
        .map(|curve| (curve.look.name.as_str(), curve.points.len()))
        .collect();
    assert_eq!(
        names,
        [
            ("reactive", 3),
            ("periodic, equal runs", 3),
            ("oracle, equal runs", 3)
        ]
    );
    let svg = figure.to_svg().expect("drawn");
    for text in [
        "a.csv",
        "reactive",
        "periodic, equal runs",
        "oracle, equal runs",
        "runs per second",
    ] {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn a_point_is_scored_as_a_replay_with_its_settings() {
    let folder = folder();
    let log = folder.path().join("a.csv");
    let sweep = options(&log, "p-run=0.3..0.8/2");
    let report = swept(&log, "p-run=0.3..0.8/2", 0);
    let settings = sweep.grid.settings(sweep.replay.settings)[1];
    let replay = ReplayOptions {
        settings,
        ..sweep.replay
    };
    let alone = native::replay(&replay, &mut Silent).expect("a replay");
    assert_eq!(report.points[1].score, alone.score);
    assert_ne!(report.points[0].score, alone.score);
    let json: Value = serde_json::from_str(&to_json(&report).expect("JSON")).expect("an object");
    assert_eq!(json["options"]["p_run"], serde_json::json!([0.3, 0.8]));
    assert_eq!(json["points"][1]["p_run"], 0.8);
    assert_eq!(json["points"][1]["scored"], true);
    assert!(json["points"][1]["actuators"]["rms_deviation_quanta"].is_f64());
    assert_eq!(json["medians"][0]["logs"], 1);
}

#[test]
fn deviations_of_a_swept_quantum_are_shown_in_one_unit() {
    let outcome = Outcome {
        rms_deviation_quanta: Some(0.5),
        ratio_to_oracle: Some(2.0),
        ..Outcome::default()
    };
    let scaled = outcome.scaled(4.0);
    assert_eq!(scaled.rms_deviation_quanta, Some(2.0));
    assert_eq!(scaled.ratio_to_oracle, Some(2.0));
}

#[test]
fn what_holds_no_log_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refused = |log: &Path| sweep(&options(log, "p-run=0.5"), &mut Silent).expect_err("refused");
    let error = refused(folder.path());
    assert!(error.is::<Refusal>() && error.to_string().contains("is an empty folder"));
    fs::write(folder.path().join("notes.txt"), "no log\n").expect("written");
    let error = refused(folder.path());
    assert!(error.is::<Refusal>(), "{error:#}");
    assert!(error.to_string().contains("none of its 1 files"), "{error}");
    let error = refused(&folder.path().join("notes.txt"));
    assert!(error.is::<FlightError>(), "{error:#}");
}
