//! The text that a person reads, letter by letter.

use super::super::{Cost, Deviation, LoadRules, Reach, Report, WithoutLeading, summary};
use super::report::{flight_of, run_report};
use super::*;
use reflex::sensors::{Input, Inputs};
use reflex::settings::Policy;
use reflex::time::micros;

fn text(change: impl FnOnce(&mut Report)) -> String {
    let flight = flight_of(2_000_000);
    let rules = Rules {
        failsafe_us: 60_000_000,
        periodic_hz: 0.01..=1000.0,
        load: Some(LoadRules {
            core_hz: 1000.0,
            policy: Cost {
                sample: 500.0,
                run: 50.0,
            },
            periodic: Cost {
                sample: 300.0,
                run: 600.0,
            },
            foresight: 0.0,
            busy: None,
        }),
        ..rules()
    };
    let score = score(&flight, &rules, |clock| fly(&flight, clock));
    let mut report = Report {
        run: run_report(&flight),
        without_leading: Some(WithoutLeading::of(Inputs::NONE.with(Input::Gyro), &score)),
        score,
    };
    change(&mut report);
    summary(&report)
}

fn verdict(text: &str) -> &str {
    text.find("verdict: ").map_or("", |at| &text[at..])
}

const EXPECTED: &str = "\
flight.ulg: 18.0 s, of these 2.0 s warm-up, then 8 hyperperiods
part of the log 4.0 to 22.0 s, the longest airborne part
policy reactive, P_run 0.8, reference last-run, failsafe 0.1 s, quantum 0.25000 of full scale, seed 1
setpoint from the log's own attitude and rates, low-passed, rotation none, noise datasheet, motors oneshot125
gaps in the log: 1, 0.013 s together

sensor         samples   model     threshold      b1      b2
mpu6050_gyro         9     fit  0.0421 rad/s  -3.210  86.100
lsm303agr_mag        9  absent             -       -       -
a run on a change x is changed with probability 1/(1+exp(-(b1+b2 x))), past the threshold often enough to ask for it
irrelevant: its changes say nothing that the leading input does not; unfit: too few runs tell; terms: docs/glossary.md

asked for runs  runs  first  alone  rightly  interrupts  spared  orders
mpu6050_gyro       2      1      1        0           9       0       3
lsm303agr_mag      0      0      0        0           9       0       3

runs                    per second  latency p50 us  p99 us  max us
trigger              2         0.1           481.5   512.2   512.2
failsafe             1         0.1           700.0   700.0   700.0
setpoint             1         0.1               -       -       -
exploration          1         0.1               -       -       -
all                  5         0.3
all but exploration  4         0.2

runs that the gyro asked for  p50 us  p99 us  max us  exceptions us
burst                          405.0   406.0   406.0         + 0.43

hyperperiods     run asked for  not asked for
command changed              1              2
unchanged                    1              1
hyperperiods that a miss stayed open 1, without a model's decision 2; failsafe runs that changed the command 1

held commands                              runs  stale %  RMS quanta  largest  felt RMS  felt largest
reactive                                      5    37.50       0.612     1.00     0.500          1.00
  with the reference's state                  5    37.50       0.612        -     0.500             -
periodic, equal runs                          6    20.31       0.447     0.94     0.447          0.94
  with the reference's state                  5    18.75       0.429     0.94     0.429          0.94
periodic, equal load                          3    26.56       0.559     1.12     0.529          1.12
dead-band's oracle, equal runs                5     0.00       0.000     0.00     0.000          0.00
  one quantum                                 4     0.00       0.177     0.50     0.177          0.50
impulse's oracle, equal runs                  5     0.00       0.000     0.00     0.000          0.00
  12.5 quantum ms                             5     0.00       0.000     0.00     0.000          0.00
reactive, natively, sensors alone trigger     5    37.50       0.612     1.00     0.500          1.00
  periodic, equal runs                        6    20.31       0.447     0.94     0.447          0.94
felt is behind the motors' lag; periodic is the mean over 8 phases
with the reference's state: holding what reference control would command at those runs
load 26.56 % (by load.toml); periodic 26.25 % at 0.2 Hz (by load.toml)

from s  length s  runs/s  stale %  RMS quanta  felt RMS  saturated %
2.0         10.0     0.3    20.00       0.447     0.447          0.0
12.0         6.0     0.2    66.67       0.816     0.577          0.0

processor 12.14 % busy, 12.22 % with 22 cycles for each of 6200 exceptions a second, 4711 instructions a run
flash 61234 bytes, RAM 8120 bytes and 1804 bytes of stack
motor writes e3b0

verdict: reactive strayed 0.612 quanta RMS from control at every sample, 0.500 as the motors feel it; that is
  1.37 and 1.12 times periodic control at equal runs: worse
  1.10 and 0.95 times periodic control at equal load: better
  - and - times the dead-band's oracle at equal runs: it strayed nowhere
  - and - times the impulse's oracle at equal runs: it strayed nowhere
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
    assert!(verdict(&text).starts_with("verdict: periodic strayed"));
}

#[test]
fn a_saturated_flight_is_not_judged() {
    let text = text(|report| {
        report.score.scored = false;
        report.score.section.actuators.saturated_fraction = Some(0.634);
    });
    assert_eq!(
        verdict(&text),
        "verdict: not scored, some command sat at a limit in 63.4 % of hyperperiods (at most 20 % may)\n"
    );
}

#[test]
fn a_flight_that_never_leaves_warm_up_says_so() {
    let mut short = FlightSteps::new(0, all(0.0));
    end(&mut short, 0.5, run(Reason::WarmUp, 0.5));
    let text = text(|report| report.score = scored(&short));
    assert!(text.contains("of these 0.0 s unfinished warm-up, then 0 hyperperiods"));
    assert_eq!(
        verdict(&text),
        "verdict: not scored, no hyperperiod came after warm-up\n"
    );
}

#[test]
fn a_yardstick_that_never_strays_is_not_divided_by() {
    let text = text(|report| {
        report.score.oracle_equal.deviation.rms_felt_quanta = Some(0.0);
        report.score.oracle_equal.deviation.rms_deviation_quanta = Some(0.0);
        report.score.periodic_equal.deviation = Deviation::default();
    });
    for line in [
        "  - and - times periodic control at equal runs: unknown\n",
        "  - and - times the dead-band's oracle at equal runs: it strayed nowhere\n",
    ] {
        assert!(verdict(&text).contains(line), "{text}");
    }
}

#[test]
fn a_yardstick_within_half_a_percent_is_the_same_by_what_is_felt() {
    let text = text(|report| {
        let own = &mut report.score.section.actuators.deviation;
        (own.rms_deviation_quanta, own.rms_felt_quanta) = (Some(1.0), Some(0.5));
        let oracle = &mut report.score.oracle_equal.deviation;
        (oracle.rms_deviation_quanta, oracle.rms_felt_quanta) = (Some(2.0), Some(0.4));
        let periodic = &mut report.score.periodic_equal.deviation;
        (periodic.rms_deviation_quanta, periodic.rms_felt_quanta) = (Some(2.0), Some(0.501));
    });
    for line in [
        "strayed 1.000 quanta RMS from control at every sample, 0.500 as the motors feel it; that is\n",
        "  0.50 and 1.00 times periodic control at equal runs: the same\n",
        "  0.50 and 1.25 times the dead-band's oracle at equal runs: worse\n",
    ] {
        assert!(verdict(&text).contains(line), "{text}");
    }
}

#[test]
fn a_load_that_periodic_control_does_not_take_is_said() {
    let reached = |reach| {
        text(|report| {
            let load = report.score.periodic_equal_load.as_mut().expect("a load");
            load.reach = reach;
            load.policy_load_measured = Some(0.0123);
        })
    };
    let above = reached(Reach::AboveHighest);
    assert!(above.contains("load 1.23 % (measured)"), "{above}");
    assert!(above.contains("\nperiodic control takes less than that even at its highest rate\n"));
    assert!(above.contains("times periodic control at its highest rate, which takes less:"));
    let below = reached(Reach::BelowLowest);
    assert!(below.contains("times periodic control at its lowest rate, which takes more:"));
    let unknown = text(|report| report.score.periodic_equal_load = None);
    assert!(!unknown.contains("equal load"));
}
