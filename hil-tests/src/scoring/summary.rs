//! The report as text: what was flown, what was decided, how good it was.

use reflex::settings::Policy;
use reflex::time::Duration;

use super::Score;
use super::deviation::{Deviation, finite, rate};
use super::load::Reach;
use super::periodic::{PHASES, Periodic};
use super::report::{FlightPart, LatencyPart, Report, RunReport, Sensor, Tier};
use super::rules::MOST_SATURATED;
use super::section::Window;
use super::table::{Table, or_dash};

/// The report for a person: small tables with their units, and a verdict at the end.
///
/// A dash stands for what has no value.
#[must_use]
pub fn summary(report: &Report) -> String {
    let Report { run, score, .. } = report;
    let parts = [
        flown(run, score),
        sensors(&run.sensors),
        asking(&run.sensors),
        runs(run, score),
        latency_parts(&run.latency_parts_us),
        decisions(score),
        commands(report),
        windows(&score.windows),
        board(run),
        verdict(run, score),
    ];
    let present: Vec<&str> = parts
        .iter()
        .map(String::as_str)
        .filter(|part| !part.is_empty())
        .collect();
    present.join("\n")
}

/// A span in seconds.
fn seconds(span: Duration) -> f64 {
    span.ticks() as f64 / 1e6
}

fn flown(run: &RunReport, score: &Score) -> String {
    let options = &run.options;
    let settings = &options.settings;
    let when = match settings.policy {
        Policy::Periodic => format!("{} at {} Hz", run.policy, 1.0 / seconds(settings.period)),
        Policy::Reactive => format!("{}, P_run {}", run.policy, settings.p_run),
    };
    let warm_up = if score.warm_up.ended {
        "warm-up"
    } else {
        "unfinished warm-up"
    };
    let mut text = format!(
        "{}: {:.1} s, of these {:.1} s {warm_up}, then {} hyperperiods\n",
        run.log, score.duration_s, score.warm_up_s, score.hyperperiods
    );
    let FlightPart {
        from_s,
        to_s,
        reason,
    } = &run.part;
    text += &format!("part of the log {from_s:.1} to {to_s:.1} s, {reason}\n");
    text += &format!(
        "policy {when}, reference {}, failsafe {} s, quantum {:.5} of full scale, seed {}\n",
        settings.reference.word(),
        seconds(settings.failsafe),
        settings.quantum,
        run.seed
    );
    text += &format!(
        "setpoint {}, rotation {}, noise {}, motors {}\n",
        run.setpoint.name(),
        options.rotate,
        options.noise,
        settings.motors.word()
    );
    if let Some(at_s) = run.disarmed_s {
        text += &format!("motors were disarmed at {at_s:.1} s: scored to 2 s before\n");
    }
    if !run.gaps.is_empty() {
        let lost_s: f64 = run.gaps.iter().map(|gap| gap.length_s).sum();
        let count = run.gaps.len();
        text += &format!("gaps in the log: {count}, {lost_s:.3} s together");
        let failsafe_s = seconds(settings.failsafe);
        text += match run
            .gaps
            .iter()
            .filter(|gap| gap.length_s > failsafe_s)
            .count()
        {
            0 => "\n".to_owned(),
            long => format!("; {long} longer than a failsafe period are not scored\n"),
        }
        .as_str();
    }
    for note in &run.notes {
        text += &format!("log: {note}\n");
    }
    text
}

/// What a model says, and why an input may have none.
const MODELS: &str = "\
a run on a change x is changed with probability 1/(1+exp(-(b1+b2 x))), past the threshold often enough to ask for it
irrelevant: its changes say nothing that the leading input does not; unfit: too few runs tell; terms: docs/glossary.md
";

fn sensors(sensors: &[Sensor]) -> String {
    let header = ["sensor", "samples", "model", "threshold", "b1", "b2"];
    let mut table = Table::new(header);
    for sensor in sensors {
        let threshold = match sensor.threshold {
            Some(threshold) => format!("{threshold:.4} {}", sensor.unit),
            None => or_dash(None, 0),
        };
        table.row([
            sensor.name.clone(),
            sensor.samples.to_string(),
            sensor.state.name().to_owned(),
            threshold,
            or_dash(sensor.b1, 3),
            or_dash(sensor.b2, 3),
        ]);
    }
    format!("{table}{MODELS}")
}

/// Who asked for runs, and what that took: interrupts, and orders on the bus of a chip.
fn asking(sensors: &[Sensor]) -> String {
    let header = [
        "asked for runs",
        "runs",
        "first",
        "alone",
        "rightly",
        "interrupts",
        "spared",
        "orders",
    ];
    let mut table = Table::new(header);
    for sensor in sensors {
        let counts = [
            sensor.triggers,
            sensor.first,
            sensor.alone,
            sensor.rightly,
            sensor.interrupts,
            sensor.spared,
            sensor.orders,
        ];
        let [a, b, c, d, e, f, g] = counts.map(|count| count.to_string());
        table.row([sensor.name.clone(), a, b, c, d, e, f, g]);
    }
    table.to_string()
}

fn runs(run: &RunReport, score: &Score) -> String {
    let length_s = score.duration_s - score.warm_up_s;
    let control = &score.section.control;
    let header = [
        "runs",
        "",
        "per second",
        "latency p50 us",
        "p99 us",
        "max us",
    ];
    let mut table = Table::new(header);
    let latencies = run.latency_us.named();
    for ((name, runs), (_, latency)) in control.by_reason.named().iter().zip(latencies) {
        if **runs > 0 {
            table.row([
                (*name).to_owned(),
                runs.to_string(),
                or_dash(rate(**runs, length_s), 1),
                or_dash(latency.map(|latency| latency.p50), 1),
                or_dash(latency.map(|latency| latency.p99), 1),
                or_dash(latency.map(|latency| latency.max), 1),
            ]);
        }
    }
    let mut sum = |name: &str, runs: u64, rate_hz| {
        let runs = runs.to_string();
        let (none, rate) = (String::new, or_dash(rate_hz, 1));
        table.row([name.to_owned(), runs, rate, none(), none(), none()]);
    };
    sum("all", control.runs, rate(control.runs, length_s));
    let explored = control.by_reason.exploration;
    if explored > 0 {
        sum(
            "all but exploration",
            control.runs - explored,
            control.rate_hz,
        );
    }
    table.to_string()
}

fn latency_parts(parts: &[LatencyPart]) -> String {
    if parts.iter().all(|part| part.micros.is_none()) {
        return String::new();
    }
    let mut table = Table::new([
        "runs that the gyro asked for",
        "p50 us",
        "p99 us",
        "max us",
        "exceptions us",
    ]);
    for part in parts {
        table.row([
            part.part.clone(),
            or_dash(part.micros.map(|micros| micros.p50), 1),
            or_dash(part.micros.map(|micros| micros.p99), 1),
            or_dash(part.micros.map(|micros| micros.max), 1),
            format!("+ {:.2}", part.exceptions_us),
        ]);
    }
    table.to_string()
}

fn decisions(score: &Score) -> String {
    let decisions = &score.section.decisions;
    let mut table = Table::new(["hyperperiods", "run asked for", "not asked for"]);
    let mut row = |name: &str, asked: u64, not: u64| {
        table.row([name.to_owned(), asked.to_string(), not.to_string()]);
    };
    row(
        "command changed",
        decisions.true_positive,
        decisions.false_negative,
    );
    row(
        "unchanged",
        decisions.false_positive,
        decisions.true_negative,
    );
    format!(
        "{table}hyperperiods that a miss stayed open {}, without a model's decision {}; \
         failsafe runs that changed the command {}\n",
        decisions.still_missed, decisions.outside, decisions.failsafe_changed
    )
}

/// What was held by the policy and by every yardstick.
fn commands(report: &Report) -> String {
    let Report {
        run,
        score,
        without_leading,
    } = report;
    let own = &score.section.actuators;
    let mut table = Table::new([
        "held commands",
        "runs",
        "stale %",
        "RMS quanta",
        "largest",
        "felt RMS",
        "felt largest",
    ]);
    let mut row = |name: &str, runs: u64, deviation: &Deviation| {
        table.row(held_row(name, runs, deviation));
    };
    let runs = score.section.control.runs;
    let with_state = "  with the reference's state";
    row(&run.policy, runs, &own.deviation);
    let from_trigger = Deviation {
        stale_fraction: own.stale_from_trigger,
        rms_deviation_quanta: own.rms_from_trigger_quanta,
        rms_felt_quanta: own.rms_felt_from_trigger_quanta,
        ..Deviation::default()
    };
    row(with_state, runs, &from_trigger);
    let mut periodic = |name: &str, periodic: &Periodic| {
        row(name, periodic.runs, &periodic.deviation);
    };
    periodic("periodic, equal runs", &score.periodic_equal);
    periodic(with_state, &score.periodic_ideal);
    if let Some(equal_load) = &score.periodic_equal_load {
        periodic("periodic, equal load", &equal_load.periodic);
    }
    let (oracle, equal) = (&score.oracle, &score.oracle_equal);
    row(
        "dead-band's oracle, equal runs",
        equal.runs,
        &equal.deviation,
    );
    row("  one quantum", oracle.runs, &oracle.deviation);
    let (oracle, equal) = (&score.oracle_impulse, &score.oracle_impulse_equal);
    row("impulse's oracle, equal runs", equal.runs, &equal.deviation);
    let budget = format!("  {:.1} quantum ms", oracle.budget_quanta_ms);
    row(&budget, oracle.runs, &oracle.deviation);
    if let Some(without) = without_leading {
        let name = format!("{}, natively, sensors alone trigger", run.policy);
        row(&name, without.runs, &without.deviation);
        let periodic = &without.periodic_equal;
        row("  periodic, equal runs", periodic.runs, &periodic.deviation);
    }
    format!("{table}{}", yardsticks(score))
}

fn held_row(name: &str, runs: u64, deviation: &Deviation) -> [String; 7] {
    [
        name.to_owned(),
        runs.to_string(),
        or_dash(percent(deviation.stale_fraction), 2),
        or_dash(deviation.rms_deviation_quanta, 3),
        or_dash(deviation.largest_deviation_quanta, 2),
        or_dash(deviation.rms_felt_quanta, 3),
        or_dash(deviation.largest_felt_quanta, 2),
    ]
}

/// What the rows of periodic control are, and which loads are equal.
fn yardsticks(score: &Score) -> String {
    let mut text = format!(
        "felt is behind the motors' lag; periodic is the mean over {PHASES} phases\n\
             with the reference's state: holding what reference control would command at those runs"
    );
    let Some(load) = &score.periodic_equal_load else {
        return text + "; nobody measured this logic's load\n";
    };
    let from = match load.policy_load_measured {
        Some(_) => "measured",
        None => "by load.toml",
    };
    text += &format!(
        "\nload {:.2} % ({from}); periodic {:.2} % at {} Hz (by load.toml)",
        100.0 * load.policy_load(),
        100.0 * load.load_by_table,
        or_dash(load.periodic.rate_hz, 1),
    );
    text += match load.reach {
        Reach::Within => "\n",
        Reach::AboveHighest => "\nperiodic control takes less than that even at its highest rate\n",
        Reach::BelowLowest => "\nperiodic control takes more than that even at its lowest rate\n",
    };
    text
}

fn windows(windows: &[Window]) -> String {
    if windows.is_empty() {
        return String::new();
    }
    let header = [
        "from s",
        "length s",
        "runs/s",
        "stale %",
        "RMS quanta",
        "felt RMS",
        "saturated %",
    ];
    let mut table = Table::new(header);
    for window in windows {
        let actuators = &window.section.actuators;
        table.row([
            format!("{:.1}", window.start_s),
            format!("{:.1}", window.length_s),
            or_dash(window.section.control.rate_hz, 1),
            or_dash(percent(actuators.deviation.stale_fraction), 2),
            or_dash(actuators.deviation.rms_deviation_quanta, 3),
            or_dash(actuators.deviation.rms_felt_quanta, 3),
            or_dash(percent(actuators.saturated_fraction), 1),
        ]);
    }
    table.to_string()
}

fn board(run: &RunReport) -> String {
    let mut text = String::new();
    if run.tier == Tier::Native {
        text += "native: no processor, so neither load nor latency is known\n";
    }
    if let Some(cpu) = &run.cpu {
        text += &format!(
            "processor {} % busy, {} % with 22 cycles for each of {} exceptions a second, \
             {} instructions a run\n",
            or_dash(percent(cpu.busy_fraction), 2),
            or_dash(percent(cpu.busy_with_exceptions), 2),
            or_dash(cpu.exceptions_per_second, 0),
            or_dash(cpu.instructions_per_run, 0)
        );
    }
    if let Some(firmware) = &run.firmware {
        text += &format!(
            "flash {} bytes, RAM {} bytes and {} bytes of stack\n",
            firmware.flash_bytes, firmware.ram_bytes, firmware.stack_bytes
        );
    }
    text + &format!("motor writes {}\n", run.digest)
}

/// What the flight says about the policy, or why it says nothing.
fn verdict(run: &RunReport, score: &Score) -> String {
    let Some(saturated) = score.section.actuators.saturated_fraction else {
        return "verdict: not scored, no hyperperiod came after warm-up\n".to_owned();
    };
    if !score.scored {
        return format!(
            "verdict: not scored, some command sat at a limit in {:.1} % of hyperperiods (at most {:.0} % may)\n",
            100.0 * saturated,
            100.0 * MOST_SATURATED
        );
    }
    let own = &score.section.actuators.deviation;
    let mut text = format!(
        "verdict: {} strayed {} quanta RMS from control at every sample, {} as the motors feel it; that is\n",
        run.policy,
        or_dash(own.rms_deviation_quanta, 3),
        or_dash(own.rms_felt_quanta, 3),
    );
    let mut against = |name: &str, other: &Deviation| {
        let ratio = |own: Option<f64>, other: Option<f64>| finite(own? / other?);
        let felt = ratio(own.rms_felt_quanta, other.rms_felt_quanta);
        text += &format!(
            "  {} and {} times {name}: {}\n",
            or_dash(
                ratio(own.rms_deviation_quanta, other.rms_deviation_quanta),
                2
            ),
            or_dash(felt, 2),
            match (felt, other.rms_felt_quanta) {
                (Some(..0.995), _) => "better",
                (Some(..1.005), _) => "the same",
                (Some(_), _) => "worse",
                (None, Some(0.0)) => "it strayed nowhere",
                (None, _) => "unknown",
            }
        );
    };
    against(
        "periodic control at equal runs",
        &score.periodic_equal.deviation,
    );
    if let Some(load) = &score.periodic_equal_load {
        let name = match load.reach {
            Reach::Within => "periodic control at equal load",
            Reach::AboveHighest => "periodic control at its highest rate, which takes less",
            Reach::BelowLowest => "periodic control at its lowest rate, which takes more",
        };
        against(name, &load.periodic.deviation);
    }
    against(
        "the dead-band's oracle at equal runs",
        &score.oracle_equal.deviation,
    );
    against(
        "the impulse's oracle at equal runs",
        &score.oracle_impulse_equal.deviation,
    );
    text
}

fn percent(share: Option<f64>) -> Option<f64> {
    share.map(|share| 100.0 * share)
}
