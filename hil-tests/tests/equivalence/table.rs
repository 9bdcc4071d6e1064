//! How often chip and software differ, and by how much: the recorded table.
//!
//! `REFLEX_BLESS=1` rewrites `measured.txt`; without it the table must be the
//! recorded one, so that a change of it is seen and explained.

use std::fmt::Write as _;
use std::ops::RangeInclusive;
use std::path::Path;

use reflex::settings::Reference;
use reflex_drivers::lsm303agr::AccelDataRate;
use reflex_drivers::mpu6050::MotionHighPass;

use super::comparison::Tally;
use super::{accelerometer, magnetometer, motion};

const RECORDED: &str = include_str!("measured.txt");
const HEADING: &str = "\
Decisions of the chips beside those of the software, over seeded streams.
Written by the test `the_measured_table_is_the_recorded_one` (REFLEX_BLESS=1 rewrites it).

decisions  samples compared
clipped    not compared: since re-arming a data register stood at its end
asked      of the decisions, above the threshold by the software
missed     asked by the software alone
extra      asked by the chip alone
worst      largest distance of change and threshold where the two differ, and as a share of the threshold
";

fn rule(text: &mut String, title: &str, unit: &str) {
    let _ = write!(
        text,
        "\n{title}\n{:>11} {:>9} {:>8} {:>8} {:>9} {:>7} {:>7} {:>12} {:>7}\n",
        "codes", "decisions", "clipped", "asked", "agreed", "missed", "extra", unit, "share"
    );
}

fn row(text: &mut String, codes: &str, tally: &Tally) {
    let _ = writeln!(
        text,
        "{codes:>11} {:>9} {:>8} {:>8} {:>9} {:>7} {:>7} {:>12.5} {:>5.1} %",
        tally.decisions,
        tally.clipped,
        tally.asked,
        tally.agreed(),
        tally.missed,
        tally.extra,
        tally.worst,
        tally.worst_share * 100.0
    );
}

fn name<T: std::fmt::Display>(codes: &RangeInclusive<T>) -> String {
    format!("{}-{}", codes.start(), codes.end())
}

fn accelerometer_table(text: &mut String) {
    use accelerometer::{Runs, Setting};
    let settings = [
        (
            "100 Hz, corner 0.2 Hz, a run within 0.1 s",
            AccelDataRate::Hz100,
            Runs::AfterInterrupts(10),
        ),
        (
            "400 Hz, corner 1 Hz, a run within 0.1 s",
            AccelDataRate::Hz400,
            Runs::AfterInterrupts(40),
        ),
        (
            "100 Hz, corner 0.2 Hz, no run at interrupts, one within 1.6 s",
            AccelDataRate::Hz100,
            Runs::Blind(160),
        ),
        (
            "100 Hz, previous sample",
            AccelDataRate::Hz100,
            Runs::EverySample,
        ),
    ];
    for (title, rate, runs) in settings {
        rule(
            text,
            &format!("LSM303AGR accelerometer, {title}"),
            "worst m/s2",
        );
        for codes in [1..=3, 4..=15, 16..=63, 64..=127] {
            let setting = Setting { rate, runs };
            let tally = accelerometer::sweep(&setting, codes.clone(), 400);
            row(text, &name(&codes), &tally);
        }
    }
}

/// Where the filter forgets too fast the code is lowered; thresholds are the wanted ones.
fn lowered_table(text: &mut String) {
    use accelerometer::{Runs, Setting};
    let (rate, runs) = (AccelDataRate::Hz400, Runs::AfterInterrupts(40));
    let title = "LSM303AGR accelerometer, 400 Hz, corner 1 Hz, a run within 0.1 s, codes lowered by the decay in 0.1 s";
    rule(text, title, "worst m/s2");
    for codes in [1..=3, 4..=15, 16..=63, 64..=127] {
        let setting = Setting { rate, runs };
        let tally = accelerometer::lowered_sweep(&setting, codes.clone(), (40, 400));
        row(text, &name(&codes), &tally);
    }
}

fn magnetometer_table(text: &mut String) {
    use magnetometer::Runs;
    for (title, runs) in [
        ("last run, within 0.2 s", Runs::Within(20)),
        ("previous sample", Runs::EverySample),
    ] {
        rule(
            text,
            &format!("LSM303AGR magnetometer, 100 Hz, {title}"),
            "worst gauss",
        );
        for band in [1..=15, 16..=255, 256..=4095, 4096..=32_767] {
            let codes = magnetometer::codes()
                .into_iter()
                .filter(|code| band.contains(code));
            let tally = magnetometer::sweep(runs, codes, 400);
            row(text, &name(&band), &tally);
        }
    }
}

fn motion_table(text: &mut String) {
    use motion::Setting;
    for (title, high_pass, reference, longest) in [
        (
            "HOLD, last run, within 0.1 s",
            MotionHighPass::Hold,
            Reference::LastRun,
            100,
        ),
        (
            "corner 0.63 Hz, last run, within 0.1 s",
            MotionHighPass::Hz0_63,
            Reference::LastRun,
            100,
        ),
        (
            "corner 5 Hz, last run, within 0.1 s",
            MotionHighPass::Hz5,
            Reference::LastRun,
            100,
        ),
        (
            "HOLD, previous sample, every third decided",
            MotionHighPass::Hold,
            Reference::PreviousSample,
            1,
        ),
        (
            "corner 0.63 Hz, previous sample, every second decided",
            MotionHighPass::Hz0_63,
            Reference::PreviousSample,
            1,
        ),
    ] {
        rule(
            text,
            &format!("MPU6050 motion detector, 1 kHz, {title}"),
            "worst m/s2",
        );
        for codes in [1..=3, 4..=15, 16..=63, 64..=255] {
            let setting = Setting {
                high_pass,
                reference,
                longest,
            };
            let tally = motion::sweep(&setting, codes.clone(), 250);
            row(text, &name(&codes), &tally);
        }
    }
}

#[test]
fn the_measured_table_is_the_recorded_one() {
    let mut text = HEADING.to_owned();
    accelerometer_table(&mut text);
    lowered_table(&mut text);
    magnetometer_table(&mut text);
    motion_table(&mut text);
    println!("{text}");
    if std::env::var_os("REFLEX_BLESS").is_some_and(|flag| flag == "1") {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/equivalence");
        std::fs::write(folder.join("measured.txt"), text).expect("the source folder is writable");
        return;
    }
    assert_eq!(
        text, RECORDED,
        "measured otherwise: explain it, then REFLEX_BLESS=1"
    );
}
