//! The paper's figures, redone.

use anyhow::Result;

use super::bars::{self, COLOURS, OTHERS, point};
use super::{Shown, paper};
use crate::campaign::comparison::{Compared, Metric, shown_in};
use crate::campaign::findings::{Findings, Means, Swept};
use crate::campaign::journal::Records;
use crate::campaign::plan::{Plan, USUAL_HZ};
use crate::campaign::role::Role;
use crate::campaign::sortie::Sortie;
use crate::interval::Interval;
use crate::plot::{Axis, Curve, Figure, Look, Marker, Panel, Point, Scale};

/// Least panels beside each other; otherwise as many as there are control logics.
const FEWEST_COLUMNS: usize = 2;

/// All of them, in the paper's order.
///
/// # Errors
/// None in practice: nothing is written but strings.
pub fn all(plan: &Plan, records: &Records, findings: &Findings) -> Result<Vec<Shown>> {
    Ok(vec![
        unchanged(plan, findings)?,
        pitch(plan, findings)?,
        roll_and_yaw(plan, findings)?,
        rate(plan, records)?,
        flight_time(plan, findings)?,
        ways(plan, findings)?,
        sweeps(plan, findings)?,
    ])
}

pub(super) fn svg(plan: &Plan, title: &str, panels: Vec<Panel>) -> Result<String> {
    let figure = Figure {
        title: title.to_owned(),
        panels,
        columns: plan.logics.len().max(FEWEST_COLUMNS),
    };
    figure.to_svg()
}

fn unchanged(plan: &Plan, findings: &Findings) -> Result<Shown> {
    let role = Role::Periodic(USUAL_HZ).to_string();
    let panels = plan.logics.iter().map(|logic| {
        let value = |environment: &str, airframe: &str| {
            let mut means = findings.means.iter().filter(|one| one.role == role);
            let is = |one: &&Means| one.cell.is([environment, airframe, logic]);
            means.find(is)?.unchanged_percent
        };
        bars::panel(plan, (logic, "unchanged commands, %"), &value, None)
    });
    let title = "Commands that do not change, time-triggered at 400 Hz";
    Ok(Shown {
        file: "unchanged",
        number: "5",
        title,
        svg: svg(plan, title, panels.collect())?,
        ours: "Runs in which no motor's command differs by a quantum (1/255 of full scale) from that of the \
               run before. Bars are means over seeds, with 95 % intervals."
            .into(),
        paper: paper::UNCHANGED,
    })
}

/// A row of panels, one for each logic, of one comparison.
fn improvements(
    plan: &Plan,
    compared: &Compared,
    (metric, against): (Metric, &str),
    range: Option<[f64; 2]>,
) -> Vec<Panel> {
    let panels = plan.logics.iter().map(|logic| {
        let value = |environment: &str, airframe: &str| {
            let mut cells = compared.cells.iter();
            let cell = cells.find(|cell| cell.name.is([environment, airframe, logic]))?;
            cell.improvement_percent.get(&metric).copied()
        };
        let title = format!("{logic}: {} against {against}", metric.name());
        bars::panel(plan, (&title, "improvement, %"), &value, range)
    });
    panels.collect()
}

/// Rows against each way of time-triggered control that was flown.
fn against_each(
    plan: &Plan,
    findings: &Findings,
    metrics: &[Metric],
    range: Option<[f64; 2]>,
) -> Vec<Panel> {
    let mut panels = Vec::new();
    for metric in metrics {
        for (compared, against) in shown_in(&findings.comparisons, |it| it.figure) {
            if compared.cells.is_empty() {
                continue;
            }
            // Beside the paper's numbers ours may be too small to see: then once more without.
            if range.is_some() && compared.comparison.against == Role::Periodic(USUAL_HZ) {
                panels.extend(improvements(plan, compared, (*metric, against), range));
            }
            panels.extend(improvements(plan, compared, (*metric, against), None));
        }
    }
    panels
}

pub(super) const BARS: &str = "Positive is better. Shown are means over pairs of one seed, with 95 % intervals; cells \
                    in which every pair had a crash are empty.";

fn pitch(plan: &Plan, findings: &Findings) -> Result<Shown> {
    let title = "Improvement in pitch error";
    let panels = against_each(plan, findings, &[Metric::Pitch], Some(paper::PITCH_PERCENT));
    Ok(Shown {
        file: "pitch_error",
        number: "9",
        title,
        svg: svg(plan, title, panels)?,
        ours: BARS.into(),
        paper: paper::PITCH,
    })
}

fn roll_and_yaw(plan: &Plan, findings: &Findings) -> Result<Shown> {
    let title = "Improvement in roll and yaw error";
    let panels = against_each(plan, findings, &[Metric::Roll, Metric::Yaw], None);
    Ok(Shown {
        file: "roll_and_yaw_error",
        number: "10",
        title,
        svg: svg(plan, title, panels)?,
        ours: BARS.into(),
        paper: paper::ROLL_AND_YAW,
    })
}

fn flight_time(plan: &Plan, findings: &Findings) -> Result<Shown> {
    let title = "Improvement in flight time";
    let range = Some(paper::FLIGHT_TIME_PERCENT);
    let panels = against_each(plan, findings, &[Metric::FlightTime], range);
    Ok(Shown {
        file: "flight_time",
        number: "12",
        title,
        svg: svg(plan, title, panels)?,
        ours: format!(
            "{BARS} Flight time is that from a full battery to 20 % at the scored part's mean power."
        ),
        paper: paper::FLIGHT_TIME,
    })
}

fn rate(plan: &Plan, records: &Records) -> Result<Shown> {
    let is_long =
        |sortie: &Sortie| sortie.duration_s == plan.long.1 && sortie.airframe == plan.long.0;
    let long = records.flights.iter().filter(|(sortie, _)| is_long(sortie));
    let curves = long.zip(COLOURS).map(|((sortie, landed), colour)| {
        let runs = (0u32..).zip(&landed.report.control.per_second);
        Curve {
            look: Look {
                name: format!("{}, {}", sortie.role, sortie.environment),
                colour,
                marker: Marker::None,
                width: 1,
            },
            points: runs
                .map(|(second, runs)| Point {
                    x: f64::from(second) + 0.5,
                    y: f64::from(*runs),
                    ..Point::default()
                })
                .collect(),
        }
    });
    let title = "Rate of control over time";
    let panel = Panel {
        title: format!("{}, {}", plan.long.0, plan.sweep_logic),
        x: Axis::new("s from take-off", Scale::Linear),
        y: Axis::new("runs per second", Scale::FromZero),
        curves: curves.collect(),
    };
    Ok(Shown {
        file: "rate",
        number: "11",
        title,
        svg: svg(plan, title, vec![panel])?,
        ours: "Runs in each second of single flights. Reactive control begins with its warm-up, in which it \
               runs at every sample."
            .into(),
        paper: paper::RATE,
    })
}

fn ways(plan: &Plan, findings: &Findings) -> Result<Shown> {
    let rate = |logic: &str| {
        let reactive = findings
            .means
            .iter()
            .filter(|one| one.role == Role::Reactive.to_string());
        let rates = reactive.filter(|one| one.cell.logic == logic);
        let rates: Vec<f64> = rates.filter_map(|one| Some(one.rate_hz?.mean)).collect();
        Interval::of(&rates).map(|interval| interval.mean)
    };
    type Of = fn(&crate::campaign::journal::Ways) -> u64;
    let kinds: [(&str, Of); 3] = [
        ("ours", |ways| ways.ours),
        ("callbacks", |ways| ways.callbacks),
        ("pointer vector", |ways| ways.pointer_vector),
    ];
    let curves = kinds.into_iter().enumerate().map(|(kind, (name, of))| {
        let points = (0u32..).zip(&plan.logics).filter_map(|(place, logic)| {
            let ways = findings.ways.iter().find(|ways| ways.logic == *logic)?;
            Some(Point {
                x: f64::from(place) + 0.25 * (kind as f64 - 1.0),
                y: of(ways) as f64 * rate(logic)? * 1e-6,
                ..Point::default()
            })
        });
        Curve {
            look: Look {
                name: name.to_owned(),
                colour: COLOURS[kind],
                marker: Marker::Bar,
                width: 30,
            },
            points: points.collect(),
        }
    });
    let title = "Instructions for control, in three ways";
    let panel = Panel {
        title: "control logic at its mean reactive rate".into(),
        x: Axis::of_names("control logic", plan.logics.clone()),
        y: Axis::new("million instructions per second", Scale::FromZero),
        curves: curves.collect(),
    };
    Ok(Shown {
        file: "instructions",
        number: "13",
        title,
        svg: svg(plan, title, vec![panel])?,
        ours: ways_text(findings),
        paper: paper::WAYS,
    })
}

fn ways_text(findings: &Findings) -> String {
    let reactive = findings
        .means
        .iter()
        .filter(|one| one.role == Role::Reactive.to_string());
    let times = reactive.filter_map(|one| one.metrics.get(&Metric::FlightTime));
    let times: Vec<f64> = times.map(|interval| interval.mean / 60.0).collect();
    let flies = Interval::of(&times).map_or(String::new(), |interval| {
        format!(
            " The drones here fly for {:.0} min on average, by their motors' power.",
            interval.mean
        )
    });
    format!(
        "The same graph, run as our generated code, as callbacks through function pointers, and as a pointer \
         vector like RP-Embedded's: mean instructions of a run in reactive control over a recorded flight, \
         times the mean reactive rate here. All three come to the same commands. None of it shows in flight \
         time: motors take some 100 W and more, this whole processor less than half a watt, so that the \
         processor's share of the battery is dwarfed by the motors'.{flies}"
    )
}

fn sweeps(plan: &Plan, findings: &Findings) -> Result<Shown> {
    let of = |parameter: &'static str| {
        findings
            .sweeps
            .iter()
            .filter(move |it| it.parameter == parameter)
    };
    let windiest = plan.environments.last().map_or("", String::as_str);
    let airframes = (&*plan.airframes, &COLOURS[..]);
    let environments = (&*plan.environments, &OTHERS[..]);
    let p_run = ("P_run", Scale::Linear);
    let failsafe = ("T_failsafe, s", Scale::Logarithmic);
    let by_airframe = |name: &str| -> Box<dyn Fn(&Swept) -> bool> {
        let name = name.to_owned();
        Box::new(move |it| it.cell.name.airframe == name)
    };
    let mut panels = Vec::new();
    let in_windiest: Vec<&Swept> = of("p_run")
        .filter(|it| it.cell.name.environment == windiest)
        .collect();
    panels.push(sweep(
        &format!("P_run in {windiest}"),
        p_run,
        airframes,
        &|name| curve(&in_windiest, &by_airframe(name)),
    ));
    let with_long: Vec<&Swept> = of("p_run")
        .filter(|it| it.cell.name.airframe == plan.long.0)
        .collect();
    panels.push(sweep(
        &format!("P_run with {}", plan.long.0),
        p_run,
        environments,
        &|name| curve(&with_long, &|it| it.cell.name.environment == name),
    ));
    for environment in &plan.environments {
        let here: Vec<&Swept> = of("failsafe_s")
            .filter(|it| it.cell.name.environment == *environment)
            .collect();
        panels.push(sweep(
            &format!("T_failsafe in {environment}"),
            failsafe,
            airframes,
            &|name| curve(&here, &by_airframe(name)),
        ));
    }
    let title = "Improvement in pitch error with other settings";
    Ok(Shown {
        file: "settings",
        number: "14",
        title,
        svg: svg(plan, title, panels)?,
        ours: format!(
            "{} against time-triggered control at 400 Hz. {BARS}",
            plan.sweep_logic
        ),
        paper: paper::SWEEPS,
    })
}

/// The values of one curve, with intervals.
pub(super) fn curve(swept: &[&Swept], is: &dyn Fn(&Swept) -> bool) -> Vec<Point> {
    let own = swept.iter().filter(|it| is(it));
    let points = own.filter_map(|it| {
        Some(point(
            it.value,
            it.cell.improvement_percent.get(&Metric::Pitch)?,
        ))
    });
    points.collect()
}

pub(super) fn sweep(
    title: &str,
    (x, scale): (&str, Scale),
    (names, colours): (&[String], &[(u8, u8, u8)]),
    points: &dyn Fn(&str) -> Vec<Point>,
) -> Panel {
    let markers = [Marker::Circle, Marker::Triangle, Marker::Square];
    let curves = names.iter().enumerate().map(|(kind, name)| Curve {
        look: Look {
            name: name.clone(),
            colour: colours[kind % colours.len()],
            marker: markers[kind % markers.len()],
            width: 2,
        },
        points: points(name),
    });
    Panel {
        title: title.to_owned(),
        x: Axis::new(x, scale),
        y: Axis::new("improvement in pitch error, %", Scale::Linear),
        curves: curves.collect(),
    }
}
