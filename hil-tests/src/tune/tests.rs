//! What is tried, what is made of it, and what is proposed.

use std::process::Command;

use reflex::config::SETTINGS;
use reflex::settings::Declared;

use super::effect::{Effect, confidence};
use super::tried::Tried;
use super::{TuneOptions, page, proposal, summary, trials, tune};
use crate::progress::Silent;
use crate::replay::options::ReplayOptions;
use crate::toolchain;

/// A value that was tried, with sure or unsure effects.
fn tried(section: &str, key: &str, to: &str, runs: [f64; 3], strayed: [f64; 3]) -> Tried {
    let effect = |[percent, from, to]: [f64; 3]| Effect {
        percent,
        from_percent: Some(from),
        to_percent: Some(to),
        pairs: 9,
    };
    Tried {
        section: section.to_owned(),
        key: key.to_owned(),
        from: String::new(),
        to: to.to_owned(),
        runs: Some(effect(runs)),
        strayed: Some(effect(strayed)),
        load: None,
        lost_logs: 0,
        pays: true,
    }
}

#[test]
fn each_trial_changes_one_value_to_what_its_file_may_hold() {
    let trials = trials::of(&SETTINGS);
    let file = toolchain::root().join("config/reactive.toml");
    let text = std::fs::read_to_string(file).expect("the configuration");
    assert!(trials.len() > 20, "{}", trials.len());
    for trial in &trials {
        let differing = (SETTINGS.values().zip(trial.settings.values()))
            .filter(|(configured, tried)| configured != tried);
        assert_eq!(differing.count(), 1, "{trial:?}");
        let tried = tried(&trial.section, trial.key, &trial.to, [0.0; 3], [0.0; 3]);
        let diff = proposal::diff(&text, &tried).expect("a value of the file");
        // One line goes and one comes, behind two of names.
        let lines = |sign: char| diff.lines().filter(|line| line.starts_with(sign)).count();
        assert_eq!((lines('-'), lines('+')), (2, 2), "{diff}");
    }
}

#[test]
fn a_diff_leaves_comments_where_they_are() {
    let text = "# Why.\n[runs]\np_run = 0.8 # and when\nfailsafe_s = 0.1\n";
    let tried = tried("runs", "p_run", "0.9", [0.0; 3], [0.0; 3]);
    let diff = proposal::diff(text, &tried).expect("a value of the text");
    assert!(
        diff.contains("-p_run = 0.8 # and when\n+p_run = 0.9 # and when\n"),
        "{diff}"
    );
    let missing = proposal::diff("[runs]\n", &tried).expect_err("no such value");
    assert_eq!(missing.to_string(), "has no value runs.p_run");
}

#[test]
fn what_surely_gains_most_is_proposed() {
    let sure = tried(
        "runs",
        "failsafe_s",
        "0.2",
        [-10.0, -12.0, -8.0],
        [0.0, -1.0, 1.0],
    );
    let surer = tried(
        "runs",
        "budget_s",
        "0.02",
        [-11.0, -13.0, -9.0],
        [0.0, -1.0, 1.0],
    );
    let wider = tried(
        "runs",
        "p_run",
        "0.9",
        [-30.0, -60.0, -1.0],
        [0.0, -1.0, 1.0],
    );
    let proposal = proposal::of(&[sure, surer, wider]).expect("in the file");
    assert_eq!(proposal.expect("one").value, "runs.budget_s");
    let unsure = Tried {
        pays: false,
        ..tried("runs", "p_run", "0.9", [-30.0, -60.0, 1.0], [0.0; 3])
    };
    assert_eq!(proposal::of(&[unsure]).expect("none to be found"), None);
}

#[test]
fn many_intervals_are_each_surer() {
    assert!((confidence(1) - 0.95).abs() < 1e-12);
    assert!((confidence(50) - 0.999).abs() < 1e-12);
}

/// Counts what a browser shows and fetches of a page, and how wide it is, into attributes of its body.
const COUNTING: &str = "<script>
const shown = [...document.querySelectorAll('svg')].filter(it => it.getBoundingClientRect().width > 100);
document.body.dataset.figures = shown.length;
document.body.dataset.fetched = performance.getEntriesByType('resource').length;
document.body.dataset.fits = document.documentElement.scrollWidth <= window.innerWidth;
</script>";

/// Skipped, with a word, where there is no Chromium.
fn look_in_a_browser(page: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("page.html");
    std::fs::write(&file, format!("{page}{COUNTING}")).expect("a file");
    for width in [1280, 500] {
        let browser = Command::new("chromium")
            .args([
                "--headless=new",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-dev-shm-usage",
                "--dump-dom",
            ])
            .arg(format!("--user-data-dir={}", folder.path().display()))
            .arg(format!("--window-size={width},900"))
            .arg(format!("file://{}", file.display()))
            .output();
        // One that ends without a page, for want of a sandbox or of memory, says nothing of ours.
        let Some(output) = browser.ok().filter(|output| !output.stdout.is_empty()) else {
            eprintln!("skipped: no chromium that shows a page, Debian's package is enough");
            return;
        };
        let dom = String::from_utf8_lossy(&output.stdout);
        for attribute in [
            r#"data-figures="2""#,
            r#"data-fetched="0""#,
            r#"data-fits="true""#,
        ] {
            assert!(
                dom.contains(attribute),
                "{width}: {attribute} is not in {}",
                tail(&dom)
            );
        }
    }
}

fn tail(text: &str) -> &str {
    let start = text.len().saturating_sub(600);
    text.get(start..).unwrap_or(text)
}

/// The log that comes with a crate: one log, so that windows are paired.
#[test]
fn a_flight_is_tuned_and_told_the_same_way_twice() {
    let options = TuneOptions {
        replay: ReplayOptions {
            duration_s: Some(14.0),
            ..ReplayOptions::default()
        },
        threads: 0,
    };
    let report = tune(&options, &mut Silent).expect("a log that comes with the crates");
    assert_eq!(report.logs.len(), 1);
    assert_eq!(report.values.len(), trials::of(&SETTINGS).len());
    assert!(!report.inputs.is_empty(), "{report:?}");
    let page = page(&report).expect("a page");
    assert!(page.contains("What other settings would change") && !page.contains("http-equiv"));
    look_in_a_browser(&page);
    let again = tune(&options, &mut Silent).expect("the same");
    assert_eq!(summary(&report), summary(&again));
}
