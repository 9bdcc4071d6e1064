//! Campaigns end to end: natively, in this process, in a temporary folder.

pub(super) mod made_up;

use std::fs;
use std::io::Write;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use proptest::prelude::*;
use tempfile::TempDir;

use super::journal::{Records, flight_line, ways_line};
use super::*;
use crate::progress::Silent;
use made_up::{crashed, landed, line, stamp};

/// The day of every report here.
const DATE: &str = "2016-06-26";

/// A folder whose journal is this text.
fn folder(text: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("journal.jsonl"), text).unwrap();
    folder
}

fn refusal(folder: &TempDir) -> String {
    let error = Journal::open(folder.path(), None, &stamp()).unwrap_err();
    error.to_string()
}

fn options(folder: &TempDir, plan: Plan, report_only: bool) -> CampaignOptions {
    CampaignOptions {
        plan,
        shard: None,
        folder: folder.path().to_owned(),
        report_only,
    }
}

/// A crew that only counts the flights, and stops after a number of them.
struct Pretended {
    flown: Vec<Job>,
    most: usize,
}

impl Crew for Pretended {
    fn fly(
        &mut self,
        orders: &Orders,
        progress: &mut dyn Progress,
        take: crew::Take<'_>,
    ) -> Result<()> {
        for job in &orders.jobs {
            anyhow::ensure!(self.flown.len() < self.most, "stopped");
            self.flown.push(job.clone());
            let mut landed = landed(job.sortie.role, job.sortie.seed, 1.0);
            landed.job = job.clone();
            take(landed, progress)?;
        }
        Ok(())
    }
}

fn cells_of(findings: &Findings, of: Role, against: Role) -> &[Cell] {
    let mut compared = findings.comparisons.iter();
    let is = |it: &&Compared| (it.comparison.of, it.comparison.against) == (of, against);
    &compared.find(is).unwrap().cells
}

#[test]
fn the_smoke_plan_flies_and_comes_to_the_same_report_from_its_journal() {
    let out = tempfile::tempdir().unwrap();
    let mut plan = Plan::named("smoke", None).unwrap().native();
    plan.duration_s = 20;
    plan.long.1 = 24;
    let flown = campaign(
        &options(&out, plan.clone(), false),
        &mut Here,
        DATE,
        &mut Silent,
    )
    .unwrap();
    assert_eq!(
        (flown.missing, flown.undecided),
        (0, 0),
        "{:?}",
        flown.crashes
    );
    assert_eq!(flown.flights.native, flown.planned);
    assert_eq!(cells_of(&flown, Role::Reactive, Role::EqualRuns).len(), 4);
    let observing = Role::Observing(Contender::Reactive);
    let observing = cells_of(&flown, observing, Role::Hovering(Contender::Usual));
    assert!(observing.iter().all(|cell| cell.name.logic == "cascade"));
    assert_eq!(observing.len(), 2);
    let rates = |role: Role| {
        let mut means = flown
            .means
            .iter()
            .filter(move |one| one.role == role.to_string());
        means.next().unwrap().rate_hz.unwrap().mean
    };
    let ratio = rates(Role::EqualRuns) / rates(Role::Reactive);
    assert!((ratio - 1.0).abs() < 0.03, "equal runs: {ratio}");
    let read = |name: &str| fs::read(out.path().join(name)).unwrap();
    let (table, page) = (read("flights.parquet"), read("report.html"));
    let again = campaign(
        &options(&out, plan, true),
        &mut Here,
        "another day",
        &mut Silent,
    )
    .unwrap();
    assert_eq!(again, flown);
    assert_eq!(read("flights.parquet"), table);
    let lines = |page: Vec<u8>| -> Vec<String> {
        String::from_utf8(page)
            .unwrap()
            .lines()
            .map(str::to_owned)
            .collect()
    };
    let (before, after) = (lines(page), lines(read("report.html")));
    assert_eq!(before.len(), after.len());
    let differ = before
        .iter()
        .zip(&after)
        .filter(|(before, after)| before != after);
    let differ: Vec<_> = differ.collect();
    assert_eq!(differ.len(), 1, "the date alone: {differ:?}");
    assert!(differ[0].0.contains(DATE));
}

#[test]
fn a_campaign_that_was_stopped_flies_what_is_left() {
    let out = tempfile::tempdir().unwrap();
    let plan = Plan::named("smoke", Some(2)).unwrap().native();
    let all = plan.part(None).len();
    let options = options(&out, plan, false);
    let mut crew = Pretended {
        flown: Vec::new(),
        most: 5,
    };
    let stopped = campaign(&options, &mut crew, DATE, &mut Silent).unwrap_err();
    assert_eq!(stopped.to_string(), "stopped");
    // What a kill leaves of the next line.
    let path = out.path().join("journal.jsonl");
    let mut text = fs::read_to_string(&path).unwrap();
    assert_eq!(text.lines().count(), 5);
    text.push_str("{\"stamp\":{\"ver");
    fs::write(&path, text).unwrap();
    crew.most = usize::MAX;
    let findings = campaign(&options, &mut crew, DATE, &mut Silent).unwrap();
    assert_eq!(
        (crew.flown.len(), findings.missing),
        (all, 0),
        "none was flown twice"
    );
    assert_eq!(fs::read_to_string(&path).unwrap().lines().count(), all);
}

#[test]
fn parts_in_one_folder_come_to_the_report_of_the_whole() {
    let (whole, parts) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let plan = Plan::named("smoke", Some(3)).unwrap().native();
    let crew = || Pretended {
        flown: Vec::new(),
        most: usize::MAX,
    };
    let all = campaign(
        &options(&whole, plan.clone(), false),
        &mut crew(),
        DATE,
        &mut Silent,
    );
    for index in [2, 1, 3] {
        let part = CampaignOptions {
            shard: Some(Shard { index, of: 3 }),
            ..options(&parts, plan.clone(), false)
        };
        campaign(&part, &mut crew(), DATE, &mut Silent).unwrap();
        assert!(
            parts
                .path()
                .join(format!("journal-{index}-of-3.jsonl"))
                .is_file()
        );
    }
    let reported = campaign(&options(&parts, plan, true), &mut crew(), DATE, &mut Silent).unwrap();
    assert_eq!(reported, all.unwrap());
    for name in ["flights.parquet", "report.html"] {
        let [one, other] = [&whole, &parts].map(|it| fs::read(it.path().join(name)).unwrap());
        assert_eq!(one, other, "{name}");
    }
}

#[test]
fn what_does_not_belong_to_a_journal_is_refused_with_file_and_line() {
    let good = line(landed(Role::Reactive, 1, 1.0));
    let of = |stamp: Stamp| flight_line(&stamp, landed(Role::Reactive, 2, 1.0)).unwrap();
    let another = |change: fn(&mut Stamp)| {
        let mut stamp = stamp();
        change(&mut stamp);
        of(stamp)
    };
    for (bad, expected) in [
        ("no json\n".to_owned(), "is no line of a campaign's journal"),
        ("\n".to_owned(), "is no line of a campaign's journal"),
        (
            another(|stamp| stamp.version = 2),
            "is of version 2, this program writes 1",
        ),
        (
            another(|stamp| stamp.plan = "paper".into()),
            "is of plan paper, not of smoke",
        ),
        (
            another(|stamp| stamp.sources = "ff".into()),
            "was flown by sources ff, these are 0123456789ab",
        ),
        (
            line(landed(Role::Reactive, 1, 2.0)),
            "tells of another flight than a line before",
        ),
    ] {
        let folder = folder(&(good.clone() + &bad));
        let line = refusal(&folder);
        let place = format!("{}:2: ", folder.path().join("journal.jsonl").display());
        assert!(
            line.starts_with(&place) && line.contains(expected),
            "{line}"
        );
        assert!(line.ends_with("remove that file or name another folder with --out"));
    }
}

#[test]
fn a_journal_has_one_writer() {
    let folder = folder("");
    let first = Journal::open(folder.path(), None, &stamp()).unwrap();
    assert!(refusal(&folder).contains("another campaign is writing it"));
    drop(first);
    assert!(Journal::open(folder.path(), None, &stamp()).is_ok());
}

#[test]
fn a_report_of_nothing_or_of_another_plan_is_refused() {
    let empty = tempfile::tempdir().unwrap();
    let refused = |folder: &TempDir, name: &str| {
        let plan = Plan::named(name, None).unwrap();
        let error = campaign(&options(folder, plan, true), &mut Here, DATE, &mut Silent);
        error
            .unwrap_err()
            .downcast::<Refusal>()
            .unwrap()
            .to_string()
    };
    assert!(refused(&empty, "smoke").contains("holds no journal with a flight"));
    let smoke = folder(&line(landed(Role::Reactive, 1, 1.0)));
    assert!(refused(&smoke, "paper").contains("its journals are of plan smoke, not of paper"));
}

/// Pitch errors 0.9 and 0.7 against 1: 10 and 30 % better, mean 20, t 12.7062.
#[test]
fn improvements_are_those_of_pairs_and_crashes_are_counted_and_in_no_mean() {
    let mut text = String::new();
    for (seed, pitch) in [(1, 0.9), (2, 0.7)] {
        text += &line(landed(Role::Reactive, seed, pitch));
        text += &line(landed(Role::Periodic(400), seed, 1.0));
    }
    text += &line(crashed(Role::Reactive, 3));
    text += &line(landed(Role::Periodic(400), 3, 1.0));
    let out = folder(&text);
    let plan = Plan::named("smoke", Some(3)).unwrap().native();
    let records = Records::read(out.path(), None).unwrap();
    let findings = Findings::of(&plan, &records);
    let cell = &cells_of(&findings, Role::Reactive, Role::Periodic(400))[0];
    assert_eq!((cell.pairs, cell.crashes), (3, [1, 0]));
    let pitch = cell.improvement_percent[&Metric::Pitch];
    assert!((pitch.mean - 20.0).abs() < 1e-9 && pitch.count == 2);
    let half = 12.7062 * 10.0 * 2f64.sqrt() / 2f64.sqrt();
    assert!((pitch.half_width.unwrap() - half).abs() < 1e-2);
    let time = cell.improvement_percent[&Metric::FlightTime];
    assert_eq!((time.mean, time.half_width), (0.0, Some(0.0)));
    assert_eq!((findings.crashes.len(), findings.undecided), (1, 1));
    let page = report::report(&plan, &records, &findings, DATE);
    let page = page.unwrap().page;
    assert!(page.contains("hit &lt;the&gt; ground &amp; all") && !page.contains("<the>"));
    assert!(page.contains("1 flights crashed."));
    assert!(
        !page.contains("http://")
            || page.matches("http://").count() == page.matches("xmlns=").count()
    );
}

#[test]
fn the_table_has_a_row_per_flight_and_lists_the_seconds() {
    let text = line(landed(Role::Reactive, 1, 1.0)) + &line(crashed(Role::PRun(300), 2));
    let text = text + &ways_line(&stamp(), Vec::new()).unwrap();
    let records = Records::read(folder(&text).path(), None).unwrap();
    let bytes = table::parquet(&records).unwrap();
    assert_eq!(table::parquet(&records).unwrap(), bytes);
    let mut file = tempfile::tempfile().unwrap();
    file.write_all(&bytes).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let rows: Vec<_> = reader
        .get_row_iter(None)
        .unwrap()
        .map(Result::unwrap)
        .collect();
    assert_eq!(rows.len(), 2);
    let value = |row: usize, name: &str| {
        let mut columns = rows[row].get_column_iter();
        columns
            .find(|(column, _)| *column == name)
            .unwrap()
            .1
            .clone()
    };
    assert_eq!(value(0, "role"), Field::Str("reactive".into()));
    assert_eq!(value(1, "role"), Field::Str("p-run-0.3".into()));
    let Field::ListInternal(seconds) = value(0, "per_second") else {
        panic!("a list of seconds");
    };
    assert_eq!(seconds.len(), 30);
    assert_eq!(value(0, "pitch_error_deg"), Field::Double(1.0));
    assert_eq!(value(1, "pitch_error_deg"), Field::Null);
    assert_eq!(value(1, "crash_east_m_s"), Field::Double(3.0));
    assert_eq!(value(1, "crashed"), Field::Bool(true));
}

proptest! {
    #[test]
    fn a_journal_cut_off_anywhere_gives_the_flights_before(cut in 0usize..6000) {
        let lines: Vec<String> = (1..=4).map(|seed| line(landed(Role::Reactive, seed, 1.0))).collect();
        let text = lines.concat();
        let cut = cut.min(text.len());
        let folder = folder(&text[..cut]);
        let journal = Journal::open(folder.path(), None, &stamp()).unwrap();
        let whole = text[..cut].matches('\n').count();
        prop_assert_eq!(journal.records.flights.len(), whole);
        let kept = fs::read_to_string(folder.path().join("journal.jsonl")).unwrap();
        prop_assert_eq!(kept, lines[..whole].concat());
    }
}
