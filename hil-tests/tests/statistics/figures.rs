//! Figures of `docs/statistics.md`: fitted curves over their labels.
//!
//! `REFLEX_BLESS=1 cargo test -p hil-tests --profile hil statistics::figures` rewrites
//! `docs/figures/*.svg`, those of recordings where they are at hand.

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use reflex::app::{Call, Reason, Stamped};
use reflex::reactive::{EVIDENCE, Fit, Logistic, RefitJob, changes_of};
use reflex::sensors::{Input, Unit};
use reflex::settings::Settings;

use super::maximum_likelihood::Sample;
use super::recorded::settings;
use super::tap::{Lessons, tap};
use hil_tests::replay::native::fly;
use hil_tests::replay::options::ReplayOptions;
use recorded_flights::Flight;
use recorded_flights::recordings::flights;

/// Which inputs are shown, and in which of the settings: one in which the input is fitted.
fn panels() -> Vec<(Input, usize)> {
    let of_imu = [
        Input::Command,
        Input::Owed,
        Input::Gyro,
        Input::Turned,
        Input::Accel,
    ];
    (of_imu.into_iter())
        .zip([0, 3, 1, 2, 1])
        .chain(Input::OF_CHIPS.map(|input| (input, 2)))
        .collect()
}

/// Dots along the axis of changes.
const DOTS: usize = 24;

type Panel<'a> = DrawingArea<SVGBackend<'a>, Shift>;

fn unit_of(input: Input) -> String {
    match input.declaration().unit {
        Unit::Named(unit) => unit.replace("s2", "s²"),
        Unit::Quantum => "share of full scale".to_owned(),
        Unit::QuantumTime => "share of full scale times s".to_owned(),
    }
}

/// When the warm-up's last run was, in us.
fn warm_up_end(calls: &[Stamped]) -> u64 {
    let runs = calls
        .iter()
        .filter(|stamped| matches!(stamped.call, Call::Ran(ran) if ran.reason == Reason::WarmUp));
    runs.map(|stamped| stamped.at.ticks()).max().unwrap_or(0)
}

/// What an input had learned when the warm-up ended.
fn learned(flight: &Flight, settings: Settings, input: Input) -> Option<(Lessons, Fit)> {
    let options = ReplayOptions {
        settings,
        ..ReplayOptions::default()
    };
    let calls = fly(flight, &options).expect("a flight");
    let end_us = warm_up_end(&calls);
    let mut learned = None;
    tap(&calls, settings, |at, lessons| {
        if lessons.input == input && at.ticks() <= end_us + 1_000 {
            learned = Some(lessons.clone());
        }
    });
    let lessons = learned?;
    let job = RefitJob {
        input,
        leads: false,
        evidence: EVIDENCE,
        labels: lessons.binned,
    };
    let fit = job.fit().fit;
    Some((lessons, fit))
}

/// Share of changed labels and weight of each interval, by the decimal logarithm of the change.
fn dots(samples: &[Sample], from: f64, to: f64) -> Vec<(f64, f64, f64)> {
    let mut bins = [(0.0, 0.0); DOTS];
    let width = (to - from) / DOTS as f64;
    for sample in samples {
        let place = ((sample.x.log10() - from) / width).clamp(0.0, DOTS as f64 - 1.0);
        let (changed, all) = &mut bins[place as usize];
        *all += sample.weight;
        *changed += sample.weight * f64::from(u8::from(sample.changed));
    }
    let middle = |place: usize| from + (place as f64 + 0.5) * width;
    (bins.iter().enumerate())
        .filter(|(_, (_, all))| *all > 0.0)
        .map(|(place, (changed, all))| (middle(place), changed / all, *all))
        .collect()
}

fn title(input: Input, name: &str, samples: &[Sample], fit: Fit, p_run: f64) -> String {
    let state = match fit {
        Fit::Model(model) => format!("P_run {p_run:.2}, x* {:.4}", model.crossing(p_run as f32)),
        Fit::Irrelevant => "irrelevant".into(),
        Fit::Unfit => "unfit".into(),
    };
    format!("{input:?} ({name}), {} labels, {state}", samples.len())
}

type DrawResult = Result<(), Box<dyn std::error::Error>>;

fn draw(
    panel: &Panel,
    input: Input,
    name: &str,
    settings: &Settings,
    flight: &Flight,
) -> DrawResult {
    let Some((lessons, fit)) = learned(flight, *settings, input) else {
        return Ok(());
    };
    let (samples, p_run) = (lessons.samples(), f64::from(settings.p_run));
    let changes = changes_of(input, settings);
    let [from, to] = [changes.smallest, changes.largest].map(|x| f64::from(x).log10());
    let mut chart = ChartBuilder::on(panel)
        .caption(title(input, name, &samples, fit, p_run), ("sans-serif", 15))
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(42)
        .build_cartesian_2d(from..to, 0.0..1.0)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_labels(6)
        .x_label_formatter(&|x| format!("{:.1e}", 10f64.powf(*x)))
        .x_desc(format!("change, {}", unit_of(input)))
        .y_desc("share changed, L(x)")
        .draw()?;
    chart.draw_series(dots(&samples, from, to).iter().map(|&(x, share, weight)| {
        let size = (1.5 + 1.5 * weight.max(1.0).log10()) as i32;
        Circle::new((x, share), size, BLUE.mix(0.5).filled())
    }))?;
    let Fit::Model(model) = fit else {
        return Ok(());
    };
    draw_model(&mut chart, &model, p_run, [from, to])
}

fn draw_model<'a>(
    chart: &mut ChartContext<'_, SVGBackend<'a>, Plane>,
    model: &Logistic,
    p_run: f64,
    [from, to]: [f64; 2],
) -> DrawResult {
    let curve = (0..=400).map(|i| from + (to - from) * f64::from(i) / 400.0);
    let probability = |x: f64| f64::from(model.probability(10f64.powf(x) as f32));
    chart.draw_series(LineSeries::new(curve.map(|x| (x, probability(x))), &RED))?;
    chart.draw_series(LineSeries::new(
        [(from, p_run), (to, p_run)],
        BLACK.mix(0.4),
    ))?;
    let at = f64::from(model.crossing(p_run as f32)).log10();
    if at.is_finite() {
        chart.draw_series(LineSeries::new([(at, 0.0), (at, 1.0)], BLACK.mix(0.4)))?;
    }
    Ok(())
}

type Plane =
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>;

fn figure(flight: &Flight, file: &Path) -> DrawResult {
    let root = SVGBackend::new(file, (1200, 760)).into_drawing_area();
    root.fill(&WHITE)?;
    let name = flight.name.rsplit('/').next().unwrap_or(&flight.name);
    let root = root.titled(
        &format!("{name}: labels at the end of the warm-up (dot area grows with their number), fit, P_run and x*"),
        ("sans-serif", 18),
    )?;
    let all = settings();
    let panels = panels();
    let grid = root.split_evenly((panels.len().div_ceil(3), 3));
    for (panel, (input, place)) in grid.iter().zip(panels) {
        let (name, settings) = &all[place];
        draw(panel, input, name, settings, flight)?;
    }
    root.present()?;
    Ok(())
}

#[test]
fn figures_of_every_flight_can_be_drawn() {
    let bless = std::env::var_os("REFLEX_BLESS").is_some_and(|flag| flag == "1");
    let scratch = tempfile::tempdir().expect("a folder");
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/figures");
    let folder = if bless {
        docs.as_path()
    } else {
        scratch.path()
    };
    std::fs::create_dir_all(folder).expect("a folder");
    let flights = flights();
    // Without the flag one figure shows that they can be drawn.
    let count = if bless { flights.len() } else { 1 };
    for flight in flights.iter().rev().take(count) {
        let stem = flight.name.rsplit('/').next().unwrap_or("flight");
        let stem = stem.split('.').next().unwrap_or(stem);
        let file = folder.join(format!("statistics_{stem}.svg"));
        figure(flight, &file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    }
}
