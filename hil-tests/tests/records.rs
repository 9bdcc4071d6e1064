//! Flight logs read back by readers that somebody else wrote, whole and cut off.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, thread};

use hil_tests::closed_loop::{self, FlyOptions, Flyer, Mission, Scene, Stress};
use hil_tests::faults::Script;
use hil_tests::logics::LogicName;
use hil_tests::progress::{Progress, Silent};
use hil_tests::replay::options::ReplayOptions;
use hil_tests::replay::{emulated, native};
use hil_tests::scoring::Report;
use recorded_flights::{Flight, Reading};
use reflex::config::{AIRFRAME, SETTINGS};

const FORMATS: [&str; 2] = ["mcap", "ulg"];

/// Rows by topic.
type Rows = BTreeMap<String, Vec<String>>;

/// What independent readers read of a log; `None` where they are missing.
///
/// Continuous integration installs them and says so: there their absence is a failure.
fn rows(log: &Path) -> Option<Rows> {
    let python = env::var("REFLEX_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let found = Command::new(&python)
        .args(["-c", "import mcap_protobuf, pyulog"])
        .output();
    if !found.is_ok_and(|found| found.status.success()) {
        assert!(env::var_os("CI").is_none(), "{python} lacks the readers");
        eprintln!(
            "skipped: {python} lacks mcap-protobuf-support or pyulog, see .ci/python.txt; \
             REFLEX_PYTHON names another"
        );
        return None;
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/records.py");
    let read = Command::new(python).arg(script).arg(log).output();
    let read = read.expect("started before");
    let complaint = String::from_utf8_lossy(&read.stderr);
    assert!(read.status.success(), "{}: {complaint}", log.display());
    let mut rows = Rows::new();
    for line in String::from_utf8(read.stdout).expect("numbers").lines() {
        let (topic, row) = line.split_once(' ').expect("a topic and its row");
        rows.entry(topic.to_owned())
            .or_default()
            .push(row.to_owned());
    }
    Some(rows)
}

/// Names of topics in a ULog by their own, as the page has them.
fn names() -> BTreeMap<String, String> {
    let page = include_str!("../../docs/records.md");
    let rows = page.lines().filter_map(|line| {
        let mut cells = line.strip_prefix("| `")?.split("` | `");
        Some((cells.next()?.to_owned(), cells.next()?.to_owned()))
    });
    rows.collect()
}

fn flown(duration_s: f64, record: PathBuf) -> closed_loop::Flown {
    let options = FlyOptions {
        gains: LogicName::configured().into(),
        settings: SETTINGS,
        mission: Mission::Waypoints,
        duration_s,
        scored_from_s: None,
        stress: Stress::default(),
        faults: Script::default(),
        record: Some(record),
        contention: closed_loop::contention::Contention::default(),
    };
    let scene = Scene::load("arch", AIRFRAME, None).expect("a scene");
    closed_loop::fly(&scene, &options, Flyer::Native, &mut Silent).expect("a flight")
}

#[test]
fn the_same_flight_gives_the_same_bytes_and_both_formats_tell_the_same_numbers() {
    let folder = tempfile::tempdir().expect("a folder");
    let [mcap, ulog] = FORMATS.map(|format| {
        let [once, again] = ["once", "again"].map(|name| folder.path().join(name));
        let [once, again] = [once, again].map(|file| file.with_extension(format));
        let flights = [&once, &again].map(|file| flown(12.0, file.clone()));
        assert_eq!(flights[0], flights[1]);
        let is_same = fs::read(&once).expect("a log") == fs::read(&again).expect("a log");
        assert!(is_same, "another .{format}");
        once
    });
    let (Some(mcap), Some(mut ulog)) = (rows(&mcap), rows(&ulog)) else {
        return;
    };
    for (name, expected) in mcap {
        if name == "log" {
            continue;
        }
        let read = ulog.remove(&names()[&name]).unwrap_or_default();
        assert!(expected.len() == read.len(), "{name}: {} rows", read.len());
        for (a, b) in expected.iter().zip(&read) {
            assert_eq!(a, b, "{name}");
        }
    }
    assert!(ulog.is_empty(), "{:?}", ulog.keys());
}

#[test]
fn a_flight_that_is_written_down_is_flown_as_ever() {
    let folder = tempfile::tempdir().expect("a folder");
    let replayed = |record: Option<PathBuf>| {
        let options = ReplayOptions {
            duration_s: Some(20.0),
            record,
            ..ReplayOptions::default()
        };
        native::replay(&options, &mut Silent).expect("a replay")
    };
    let unwritten = replayed(None);
    for format in FORMATS {
        let record = folder.path().join("a").with_extension(format);
        assert_eq!(replayed(Some(record)), unwritten);
    }
}

/// A replay of either tier.
type Tier = fn(&ReplayOptions, &mut dyn Progress) -> anyhow::Result<Report>;

#[test]
fn a_log_of_either_tier_tells_every_run_of_a_replay() {
    let folder = tempfile::tempdir().expect("a folder");
    for (tier, duration_s) in [(native::replay as Tier, 20.0), (emulated::replay, 3.5)] {
        let record = folder.path().join("replay.ulg");
        let options = ReplayOptions {
            duration_s: Some(duration_s),
            record: Some(record.clone()),
            ..ReplayOptions::default()
        };
        let report = tier(&options, &mut Silent).expect("a replay");
        let Some(rows) = rows(&record) else {
            return;
        };
        // Runs on the ground are the last reason's.
        let ground = (reflex::app::Reason::COUNT - 1) as f64;
        let decisions = rows["reflex_decision"].iter();
        let in_the_air = decisions.filter(|row| {
            let reason = row.split(' ').nth(1).expect("a reason");
            reason.parse() != Ok(ground)
        });
        assert!(in_the_air.count() as u64 >= report.score.section.control.runs);
        assert_eq!(rows["actuator_motors"].len(), rows["reflex_decision"].len());
        assert_eq!(
            rows["vehicle_attitude"].len(),
            rows["actuator_motors"].len()
        );

        // What was written is a flight again.
        let again = Flight::read(&record, Reading::default()).expect("a flight");
        let length_s = again.duration_s();
        assert!((length_s - duration_s).abs() < 0.5, "{length_s}");
        assert!(again.mag.is_some());
    }
}

#[test]
fn a_program_that_is_killed_in_flight_leaves_a_log_that_is_read_up_to_there() {
    let folder = tempfile::tempdir().expect("a folder");
    for format in FORMATS {
        let record = folder.path().join("killed").with_extension(format);
        let mut child = Command::new(env!("CARGO_BIN_EXE_hil"))
            .args(["fly", "--native", "--duration", "86400", "--record"])
            .arg(&record)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("a program");
        let length = || fs::metadata(&record).map_or(0, |file| file.len());
        while length() < 2_000_000 {
            let ended = child.try_wait().expect("a child");
            assert!(ended.is_none(), "{ended:?} before anything was killed");
            thread::yield_now();
        }
        child.kill().expect("alive");
        child.wait().expect("ended");
        let written = length();
        let Some(rows) = rows(&record) else {
            return;
        };
        let imu = &rows[if format == "mcap" {
            "sensors/imu"
        } else {
            "sensor_combined"
        }];
        // A second of flight may be lost, which takes less than a third of what was waited for.
        let last = imu.last().expect("samples").split(' ').next();
        let last_us: u64 = last.expect("a time").parse().expect("microseconds");
        assert!(imu.len() > 5_000, "{} of {written} bytes", imu.len());
        assert!(last_us > 5_000_000, "{last_us}");
        if format == "ulg" {
            let flight = Flight::read(&record, Reading::default()).expect("a flight");
            assert!(flight.duration_s() > 3.0);
        }
    }
}
