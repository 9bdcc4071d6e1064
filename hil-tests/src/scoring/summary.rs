//! The report as text: what was flown, what was decided, how good it was.

use reflex::settings::Policy;
use reflex::time::Duration;

use super::Score;
use super::deviation::rate;
use super::report::{LatencyPart, Report, RunReport, Sensor, Tier};
use super::rules::MOST_SATURATED;
use super::section::Window;
use super::table::{Table, or_dash};

/// The report for a person: small tables with their units, and a verdict in the last line.
///
/// A dash stands for what has no value.
#[must_use]
pub fn summary(report: &Report) -> String {
    let Report { run, score } = report;
    let parts = [
        flown(run, score),
        sensors(&run.sensors),
        runs(run, score),
        latency_parts(&run.latency_parts_us),
        decisions(score),
        commands(run, score),
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
    if !run.gaps.is_empty() {
        let lost_s: f64 = run.gaps.iter().map(|gap| gap.length_s).sum();
        let count = run.gaps.len();
        text += &format!("gaps in the log: {count}, {lost_s:.3} s together\n");
    }
    text
}

fn sensors(sensors: &[Sensor]) -> String {
    let header = [
        "sensor",
        "samples",
        "interrupts",
        "triggers",
        "model",
        "threshold",
        "b1",
        "b2",
    ];
    let mut table = Table::new(header);
    for sensor in sensors {
        let threshold = match sensor.threshold {
            Some(threshold) => format!("{threshold:.4} {}", sensor.unit),
            None => or_dash(None, 0),
        };
        table.row([
            sensor.name.clone(),
            sensor.samples.to_string(),
            sensor.interrupts.to_string(),
            sensor.triggers.to_string(),
            sensor.state.name().to_owned(),
            threshold,
            or_dash(sensor.b1, 3),
            or_dash(sensor.b2, 3),
        ]);
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
    let mut table = Table::new(["runs that the gyro asked for", "p50 us", "p99 us", "max us"]);
    for part in parts {
        table.row([
            part.part.clone(),
            or_dash(part.micros.map(|micros| micros.p50), 1),
            or_dash(part.micros.map(|micros| micros.p99), 1),
            or_dash(part.micros.map(|micros| micros.max), 1),
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

fn commands(run: &RunReport, score: &Score) -> String {
    let own = &score.section.actuators;
    let (periodic, ideal) = (&score.periodic_equal, &score.periodic_ideal);
    let (oracle, equal) = (&score.oracle, &score.oracle_equal);
    let mut table = Table::new(["held commands", "runs", "stale %", "RMS quanta"]);
    let mut row = |name: &str, runs: u64, stale: Option<f64>, rms| {
        let stale = or_dash(percent(stale), 2);
        table.row([name.to_owned(), runs.to_string(), stale, or_dash(rms, 3)]);
    };
    let runs = score.section.control.runs;
    let with_state = "  with the reference's state";
    row(
        &run.policy,
        runs,
        own.stale_fraction,
        own.rms_deviation_quanta,
    );
    row(
        with_state,
        runs,
        own.stale_from_trigger,
        own.rms_from_trigger_quanta,
    );
    row(
        "periodic, equal runs",
        periodic.runs,
        periodic.stale_fraction,
        periodic.rms_deviation_quanta,
    );
    row(
        with_state,
        ideal.runs,
        ideal.stale_fraction,
        ideal.rms_deviation_quanta,
    );
    row(
        "oracle, equal runs",
        equal.runs,
        equal.stale_fraction,
        equal.rms_deviation_quanta,
    );
    row(
        "oracle, one quantum",
        oracle.runs,
        oracle.stale_fraction,
        oracle.rms_deviation_quanta,
    );
    table.to_string()
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
        "saturated %",
    ];
    let mut table = Table::new(header);
    for window in windows {
        let actuators = &window.section.actuators;
        table.row([
            format!("{:.1}", window.start_s),
            format!("{:.1}", window.length_s),
            or_dash(window.section.control.rate_hz, 1),
            or_dash(percent(actuators.stale_fraction), 2),
            or_dash(actuators.rms_deviation_quanta, 3),
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
            "processor {} % busy, {} instructions a run\n",
            or_dash(percent(cpu.busy_fraction), 1),
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

/// One line: what the flight says about the policy, or why it says nothing.
fn verdict(run: &RunReport, score: &Score) -> String {
    let own = &score.section.actuators;
    let Some(saturated) = own.saturated_fraction else {
        return "verdict: not scored, no hyperperiod came after warm-up\n".to_owned();
    };
    if !score.scored {
        return format!(
            "verdict: not scored, some command sat at a limit in {:.1} % of hyperperiods (at most {:.0} % may)\n",
            100.0 * saturated,
            100.0 * MOST_SATURATED
        );
    }
    let beside = |name: &str, other: Option<f64>| match (own.rms_deviation_quanta, other) {
        (Some(_), Some(0.0)) => format!("{name} strayed nowhere"),
        (Some(own), Some(other)) => {
            let ratio = own / other;
            let word = match ratio {
                ..0.995 => "better",
                ..1.005 => "the same",
                _ => "worse",
            };
            format!("{ratio:.2} times {name} ({word})")
        }
        _ => format!("{name} is unknown"),
    };
    format!(
        "verdict: {} strayed {} quanta; at equal runs: {}, {}\n",
        run.policy,
        or_dash(own.rms_deviation_quanta, 3),
        beside(
            "periodic control",
            score.periodic_equal.rms_deviation_quanta
        ),
        beside("the oracle", score.oracle_equal.rms_deviation_quanta),
    )
}

fn percent(share: Option<f64>) -> Option<f64> {
    share.map(|share| 100.0 * share)
}
