//! The report's spelling, its numbers for one short flight, and its nulls.

use super::super::report::*;
use super::super::{LatencySample, Quantiles, Report, latencies};
use super::*;
use crate::json::to_json;
use reflex::config::SETTINGS;
use reflex::sensors::{Input, Inputs};
use reflex::settings::Settings;
use serde_json::{Value, json};

/// A short flight in which everything happens at least once.
pub(super) fn flight_of(hyperperiod_us: u64) -> FlightSteps {
    let mut flight = FlightSteps::new(0, all(0.0));
    let mut end = |reference, early, run| {
        if let Some(early) = early {
            flight.run_early(early);
        }
        let at_us = flight.last_us() + hyperperiod_us;
        flight.end_hyperperiod(at_us, all(reference), run);
        flight.end_warm_up(hyperperiod_us);
    };
    end(0.25, None, run(Reason::WarmUp, 0.25));
    end(0.5, None, run(Reason::Trigger, 0.5));
    end(0.5, None, run(Reason::Trigger, 0.5));
    end(0.75, None, None);
    end(0.75, run(Reason::Failsafe, 0.75), None);
    end(0.625, None, run(Reason::Exploration, 0.625));
    end(0.375, None, run(Reason::Setpoint, 0.375));
    end(0.125, None, None);
    end(0.125, None, None);
    flight
}

fn flight() -> FlightSteps {
    flight_of(1000)
}

fn sensor(name: &str, state: ModelState) -> Sensor {
    let fitted = state == ModelState::Fit;
    Sensor {
        name: name.to_owned(),
        present: state != ModelState::Absent,
        samples: 9,
        interrupts: 9,
        spared: 0,
        orders: 3,
        triggers: if fitted { 2 } else { 0 },
        first: u64::from(fitted),
        alone: u64::from(fitted),
        rightly: 0,
        state,
        threshold: fitted.then_some(0.0421),
        unit: "rad/s".to_owned(),
        chip_threshold: None,
        chip_thresholds_set: 0,
        chip_crossings: 0,
        b1: fitted.then_some(-3.21),
        b2: fitted.then_some(86.1),
    }
}

fn options() -> Options {
    Options {
        logic: "cascade".into(),
        gains: None,
        settings: Settings {
            triggers: Inputs::NONE.with(Input::Gyro),
            quantum: 0.25,
            ..SETTINGS
        },
        rotate: "none".to_owned(),
        noise: "datasheet".to_owned(),
        duration_s: None,
    }
}

pub(super) fn run_report(flight: &FlightSteps) -> RunReport {
    let latency = |reason, micros| LatencySample {
        at_us: flight.last_us(),
        reason,
        micros,
    };
    let samples = [
        latency(Reason::Trigger, 481.5),
        latency(Reason::Trigger, 512.25),
        latency(Reason::Failsafe, 700.0),
    ];
    RunReport {
        log: "flight.ulg".to_owned(),
        tier: Tier::Emulated,
        policy: "reactive".to_owned(),
        seed: 1,
        options: options(),
        part: FlightPart {
            from_s: 4.0,
            to_s: 22.0,
            reason: "the longest airborne part".to_owned(),
        },
        notes: Vec::new(),
        setpoint: SetpointSource::LowPassed,
        disarmed_s: None,
        gaps: vec![Gap {
            start_s: 0.001,
            length_s: 0.0125,
        }],
        firmware: Some(Firmware {
            flash_bytes: 61_234,
            ram_bytes: 8120,
            stack_bytes: 1804,
        }),
        sensors: vec![
            sensor("mpu6050_gyro", ModelState::Fit),
            sensor("lsm303agr_mag", ModelState::Absent),
        ],
        latency_us: latencies(flight, &samples),
        latency_parts_us: vec![LatencyPart {
            part: "burst".to_owned(),
            micros: Quantiles::of([405.0, 406.0]),
            exceptions_us: 0.43,
        }],
        cpu: Some(Cpu {
            busy_fraction: Some(0.1214),
            exceptions_per_second: Some(6_200.0),
            busy_with_exceptions: Some(0.1222),
            instructions_per_run: Some(4711.4),
        }),
        board: Some(BoardTime {
            virtual_s: 0.25,
            start_up_s: 0.125,
        }),
        counters: [("link_malformed".to_owned(), 0)].into(),
        digest: "e3b0".to_owned(),
    }
}

fn report(flight: &FlightSteps) -> Report {
    Report {
        run: run_report(flight),
        score: scored(flight),
        without_leading: None,
    }
}

fn json_of(flight: &FlightSteps) -> Value {
    serde_json::from_str(&to_json(&report(flight)).unwrap()).unwrap()
}

#[test]
fn every_field_that_others_rely_on_is_spelled_as_they_spell_it() {
    let json = json_of(&flight());
    for pointer in [
        "/log /tier /duration_s /warm_up_s /hyperperiods /policy /seed /scored /digest",
        "/firmware/flash_bytes /firmware/ram_bytes /firmware/stack_bytes",
        "/sensors/0/name /sensors/0/present /sensors/0/samples /sensors/0/interrupts",
        "/sensors/0/first /sensors/0/alone /sensors/0/rightly /sensors/0/spared /sensors/0/orders",
        "/sensors/0/triggers /sensors/0/state /sensors/0/threshold /sensors/0/b1 /sensors/0/b2",
        "/control/runs /control/rate_hz /control/by_reason/warm_up /control/by_reason/trigger",
        "/control/by_reason/failsafe /control/by_reason/setpoint /control/by_reason/exploration",
        "/decisions/true_positive /decisions/false_positive /decisions/false_negative",
        "/decisions/true_negative /decisions/failsafe_changed",
        "/actuators/stale_fraction /actuators/stale_from_trigger",
        "/actuators/rms_deviation_quanta /actuators/saturated_fraction",
        "/actuators/largest_deviation_quanta /actuators/rms_felt_quanta",
        "/actuators/largest_felt_quanta /oracle_impulse/runs /oracle_impulse_equal/rms_felt_quanta",
        "/oracle/runs /oracle_equal/rms_deviation_quanta",
        "/periodic_equal/rms_deviation_quanta /periodic_equal/stale_fraction",
        "/latency_us/trigger/p50 /latency_us/trigger/p99 /latency_us/trigger/max",
        "/cpu/busy_fraction /cpu/instructions_per_run",
        "/windows/0/control/runs /windows/0/decisions/true_positive",
        "/windows/0/actuators/stale_fraction /windows/0/start_s /windows/0/length_s",
        "/part/from_s /part/to_s /part/reason",
        "/options/reference /setpoint /gaps/0/start_s /board/virtual_s /counters/link_malformed",
    ]
    .iter()
    .flat_map(|line| line.split(' '))
    {
        let found = json.pointer(pointer);
        assert!(found.is_some_and(|value| !value.is_null()), "{pointer}");
    }
}

#[test]
fn the_short_flights_numbers_are_those_worked_out_by_hand() {
    let json = json_of(&flight());
    assert_eq!(json["hyperperiods"], 8);
    let by_reason = json!({
        "warm_up": 0, "trigger": 2, "failsafe": 1, "setpoint": 1,
        "exploration": 1, "periodic": 0, "fallback": 0, "ground": 0,
    });
    // Four of the five runs in 8 ms: exploration is outside the rate.
    let control = json!({ "runs": 5, "rate_hz": 500.0, "by_reason": by_reason });
    assert_eq!(json["control"], control);
    let decisions = json!({
        "true_positive": 1, "false_positive": 1, "false_negative": 2, "true_negative": 1,
        "still_missed": 1, "outside": 2, "failsafe_changed": 1,
    });
    assert_eq!(json["decisions"], decisions);
    assert_eq!(json["actuators"]["stale_fraction"], 3.0 / 8.0);
    // Changes of a quantum from 0.25: to 0.5, 0.75, 0.375 and 0.125.
    assert_eq!(json["oracle"]["runs"], 4);
}

#[test]
fn what_has_no_value_is_null_and_nothing_is_infinite() {
    let mut flight = FlightSteps::new(0, all(0.0));
    end(&mut flight, f32::NAN, run(Reason::WarmUp, f32::INFINITY));
    let json = json_of(&flight);
    for pointer in [
        "/control/rate_hz",
        "/actuators/stale_fraction",
        "/oracle_equal/rms_deviation_quanta",
        "/periodic_equal/rms_deviation_quanta",
        "/latency_us/trigger",
    ] {
        assert_eq!(json.pointer(pointer), Some(&Value::Null), "{pointer}");
    }
    flight.end_warm_up(1000);
    end(&mut flight, f32::INFINITY, run(Reason::Trigger, f32::NAN));
    let mut odd = report(&flight);
    odd.run.cpu = Some(Cpu {
        busy_fraction: Some(f64::NAN),
        exceptions_per_second: None,
        busy_with_exceptions: None,
        instructions_per_run: None,
    });
    let text = to_json(&odd).unwrap();
    assert!(text.contains("\"busy_fraction\": null"));
    assert!(!text.contains("NaN") && !text.contains("inf"));
}

#[test]
fn the_report_is_one_object_and_one_line_end() {
    let text = to_json(&report(&flight())).unwrap();
    assert!(text.starts_with('{') && text.ends_with("}\n"));
}
