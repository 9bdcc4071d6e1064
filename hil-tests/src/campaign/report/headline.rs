//! The answer in plain words, made from the numbers.

use maud::{Markup, html};

use super::paper;
use super::tables::percent;
use crate::campaign::comparison::{Cell, Compared, Metric, shown_in};
use crate::campaign::findings::Findings;
use crate::campaign::role::Role;
use crate::interval::Interval;

/// The first section.
pub fn section(findings: &Findings) -> Markup {
    let [low, high] = paper::PITCH_PERCENT;
    let [short, long] = paper::FLIGHT_TIME_PERCENT;
    html! {
        p {
            (format!("{:.1}", findings.hours.native)) " simulated flight hours ("
            (findings.flights.native) " flights)"
            @if findings.flights.emulated > 0 {
                " and " (format!("{:.2}", findings.hours.emulated))
                " hours of the firmware on the emulated board (" (findings.flights.emulated)
                " flights, " (findings.equal_runs) " runs, all of which came to the host's command bit by bit)"
            }
            ". Percentages are means over all environments, airframes and control logics, with their "
            "95 % confidence interval over seeds. Positive is better: less error, or more flight time."
        }
        (effort(findings))
        ul {
            @for (compared, title) in shown_in(&findings.comparisons, |it| it.headline) {
                (answer(compared, title))
            }
        }
        p class="paper" {
            "The paper found, against time-triggered control at " (paper::RATE_HZ) " Hz: " (low) " to "
            (high) " % less pitch error, and " (short) " to " (long) " % more flight time."
        }
        @if findings.missing > 0 {
            p class="warning" {
                (findings.missing) " of " (findings.planned) " planned flights are not flown yet: the same "
                "command flies them."
            }
        }
        (crashes(findings))
    }
}

fn answer(compared: &Compared, title: &str) -> Markup {
    html! {
        li {
            strong { (title) ": " }
            @if compared.improvement_percent.is_empty() {
                "not flown."
            } @else {
                ul {
                    @for metric in [Metric::Attitude, Metric::Pitch, Metric::FlightTime] {
                        @if let Some(interval) = compared.improvement_percent.get(&metric) {
                            li { (sentence(metric, interval)) (range(metric, &compared.cells)) }
                        }
                    }
                }
            }
        }
    }
}

/// One metric in words.
fn sentence(metric: Metric, interval: &Interval) -> String {
    let name = metric.name();
    let change = match (interval.mean > 0.0) == (metric == Metric::FlightTime) {
        true => "more",
        false => "less",
    };
    let by = interval.mean.abs();
    let [low, high] = interval.ends().map(percent);
    match interval.half_width {
        None => format!("{name}: {by:.2} % {change}, by too few seeds for an interval"),
        Some(half) if half >= by => {
            format!("{name}: no difference that could be told from chance, {low} to {high} %")
        }
        Some(_) => format!("{name}: {by:.2} % {change}, an improvement of {low} to {high} %"),
    }
}

/// The cells with the lowest and the highest improvement.
fn range(metric: Metric, cells: &[Cell]) -> String {
    let of = |cell: &Cell| {
        cell.improvement_percent
            .get(&metric)
            .map(|interval| interval.mean)
    };
    let known = || cells.iter().filter_map(|cell| Some((of(cell)?, cell)));
    let low = known().min_by(|one, other| one.0.total_cmp(&other.0));
    let high = known().max_by(|one, other| one.0.total_cmp(&other.0));
    match low.zip(high) {
        Some(((low, worst), (high, best))) if cells.len() > 1 => {
            let (worst, best) = (&worst.name, &best.name);
            let [low, high] = [low, high].map(percent);
            format!("; by cell {low} % ({worst}) to {high} % ({best})")
        }
        _ => String::new(),
    }
}

/// How often reactive control ran, and what that took of the processor.
fn effort(findings: &Findings) -> Markup {
    let reactive = Role::Reactive.to_string();
    let mean = |values: Vec<f64>| Interval::of(&values).map(|interval| interval.mean);
    let means = findings.means.iter().filter(|one| one.role == reactive);
    let rate = mean(means.filter_map(|one| Some(one.rate_hz?.mean)).collect());
    let loads = || findings.loads.iter();
    let busy = mean(loads().map(|load| 100.0 * load.busy).collect());
    let equal = mean(loads().map(|load| load.equal_time_hz).collect());
    html! {
        @if let Some(rate) = rate {
            p {
                "Reactive control ran " (format!("{rate:.0}")) " times a second on average"
                @if let Some((busy, equal)) = busy.zip(equal) {
                    " and, with its decisions, kept the processor busy for " (format!("{busy:.1}"))
                    " % of the time: as long as periodic control at " (format!("{equal:.0}")) " Hz does"
                }
                "."
            }
        }
    }
}

fn crashes(findings: &Findings) -> Markup {
    /// Most crashes that are listed one by one.
    const MOST_LISTED: usize = 50;
    let count = findings.crashes.len();
    html! {
        @if count == 0 {
            p { "No flight crashed." }
        } @else {
            p class="warning" {
                strong { (count) " flights crashed. " }
                "They have no error and no flight time, and their pairs are in no mean: the tables count them."
            }
            details {
                summary { "Which" }
                ul {
                    @for line in findings.crashes.iter().take(MOST_LISTED) { li { (line) } }
                    @if count > MOST_LISTED { li { "and " (count - MOST_LISTED) " more, in flights.parquet" } }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval(mean: f64, half_width: Option<f64>) -> Interval {
        Interval {
            mean,
            half_width,
            count: 5,
        }
    }

    #[test]
    fn words_follow_from_sign_and_interval() {
        for (metric, mean, half, expected) in [
            (
                Metric::Pitch,
                3.0,
                Some(1.0),
                "pitch error: 3.00 % less, an improvement of +2.00 to +4.00 %",
            ),
            (
                Metric::Pitch,
                -3.0,
                Some(1.0),
                "pitch error: 3.00 % more, an improvement of -4.00 to -2.00 %",
            ),
            (
                Metric::FlightTime,
                3.0,
                Some(1.0),
                "flight time: 3.00 % more, an improvement of +2.00 to +4.00 %",
            ),
            (
                Metric::FlightTime,
                -0.5,
                Some(1.0),
                "flight time: no difference that could be told from chance, -1.50 to +0.50 %",
            ),
            (
                Metric::Roll,
                2.0,
                None,
                "roll error: 2.00 % less, by too few seeds for an interval",
            ),
        ] {
            assert_eq!(sentence(metric, &interval(mean, half)), expected);
        }
    }
}
