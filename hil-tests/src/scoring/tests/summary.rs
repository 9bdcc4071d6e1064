//! The text that a person reads, letter by letter.

use super::super::{Report, summary};
use super::report::{flight_of, run_report};
use super::*;
use reflex::settings::Policy;
use reflex::time::micros;

fn text(change: impl FnOnce(&mut Report)) -> String {
    let flight = flight_of(2_000_000);
    let rules = Rules {
        failsafe_us: 60_000_000,
        periodic_hz: 0.01..=1000.0,
        ..rules()
    };
    let mut report = Report {
        run: run_report(&flight),
        score: score(&flight, &rules, |rate_hz| fly(&flight, rate_hz)),
    };
    change(&mut report);
    summary(&report)
}

fn last_line(text: &str) -> &str {
    text.lines().last().unwrap()
}

const EXPECTED: &str = "\
flight.ulg: 18.0 s, of these 2.0 s warm-up, then 8 hyperperiods
policy reactive, P_run 0.6, reference last-run, failsafe 0.1 s, quantum 0.25000 of full scale, seed 1
setpoint from the log's own attitude and rates, low-passed, rotation none, noise datasheet, motors oneshot125
gaps in the log: 1, 0.013 s together

sensor         samples  interrupts  triggers   model     threshold      b1      b2
mpu6050_gyro         9           9         2     fit  0.0421 rad/s  -3.210  86.100
lsm303agr_mag        9           9         0  absent             -       -       -

runs                    per second  latency p50 us  p99 us  max us
trigger              2         0.1           481.5   512.2   512.2
failsafe             1         0.1           700.0   700.0   700.0
setpoint             1         0.1               -       -       -
exploration          1         0.1               -       -       -
all                  5         0.3
all but exploration  4         0.2

runs that the gyro asked for  p50 us  p99 us  max us
burst                          405.0   406.0   406.0

hyperperiods     run asked for  not asked for
command changed              1              2
unchanged                    1              1
hyperperiods that a miss stayed open 1, without a model's decision 2; failsafe runs that changed the command 1

held commands                 runs  stale %  RMS quanta
reactive                         5    37.50       0.612
  with the reference's state     5    37.50       0.612
periodic, equal runs             5     0.00       0.177
  with the reference's state     5    37.50       0.612
oracle, equal runs               5     0.00       0.000
oracle, one quantum              4     0.00       0.177

from s  length s  runs/s  stale %  RMS quanta  saturated %
2.0         10.0     0.3    20.00       0.447          0.0
12.0         6.0     0.2    66.67       0.816          0.0

processor 12.1 % busy, 4711 instructions a run
flash 61234 bytes, RAM 8120 bytes and 1804 bytes of stack
motor writes e3b0

verdict: reactive strayed 0.612 quanta; at equal runs: 3.46 times periodic control (worse), the oracle strayed nowhere
";

#[test]
fn a_report_reads_like_this() {
    let text = text(|_| {});
    assert_eq!(text, EXPECTED, "{text}");
}

#[test]
fn nothing_trails_and_no_line_is_wider_than_a_screen() {
    for line in text(|_| {}).lines() {
        assert_eq!(line, line.trim_end());
        assert!(line.chars().count() <= 120, "{line}");
    }
}

#[test]
fn a_periodic_flight_names_its_rate() {
    let text = text(|report| {
        report.run.policy = "periodic".to_owned();
        report.run.options.settings.policy = Policy::Periodic;
        report.run.options.settings.period = micros(4000);
    });
    assert!(text.contains("policy periodic at 250 Hz, reference last-run"));
    assert!(last_line(&text).starts_with("verdict: periodic strayed"));
}

#[test]
fn a_saturated_flight_is_not_judged() {
    let text = text(|report| {
        report.score.scored = false;
        report.score.section.actuators.saturated_fraction = Some(0.634);
    });
    assert_eq!(
        last_line(&text),
        "verdict: not scored, some command sat at a limit in 63.4 % of hyperperiods (at most 20 % may)"
    );
}

#[test]
fn a_flight_that_never_leaves_warm_up_says_so() {
    let mut short = Flight::new(0, all(0.0));
    end(&mut short, 0.5, run(Reason::WarmUp, 0.5));
    let text = text(|report| report.score = scored(&short));
    assert!(text.contains("of these 0.0 s unfinished warm-up, then 0 hyperperiods"));
    assert_eq!(
        last_line(&text),
        "verdict: not scored, no hyperperiod came after warm-up"
    );
}

#[test]
fn a_yardstick_that_never_strays_is_not_divided_by() {
    let text = text(|report| {
        report.score.oracle_equal.rms_deviation_quanta = Some(0.0);
        report.score.periodic_equal.rms_deviation_quanta = None;
    });
    let end = "at equal runs: periodic control is unknown, the oracle strayed nowhere";
    assert!(last_line(&text).ends_with(end));
}

#[test]
fn a_yardstick_within_half_a_percent_is_the_same() {
    let text = text(|report| {
        let actuators = &mut report.score.section.actuators;
        actuators.rms_deviation_quanta = Some(1.0);
        report.score.oracle_equal.rms_deviation_quanta = Some(0.8);
        report.score.periodic_equal.rms_deviation_quanta = Some(1.001);
    });
    let end = "1.00 times periodic control (the same), 1.25 times the oracle (worse)";
    assert!(last_line(&text).ends_with(end));
}
