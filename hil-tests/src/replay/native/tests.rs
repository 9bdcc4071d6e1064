//! Native flights: repeatable, reactive, and like the emulated ones.

use std::fmt::Write;

use rayon::prelude::*;
use reflex::app::{Call, ChipAction, ChipOrder, Fault};
use reflex::sensors::{Input, Inputs};
use reflex::settings::{Policy, Settings};
use reflex::time::micros;

use super::*;
use crate::closed_loop::tests::alarms::ALARMS;
use crate::logics::LogicName;
use crate::native::DieWire;
use crate::scoring::Tier;
use recorded_flights::recordings::{self, recording};
use recorded_flights::{Rotate, Rotation};

/// The log of a flight in gusts that come and go, of `seconds` at 500 Hz, by formula.
pub(crate) fn log_of_gusts(seconds: u64) -> String {
    let mut text = String::from("t_us,gx,gy,gz,ax,ay,az,mx,my,mz\n");
    for step in 0..seconds * 500 {
        let t = step as f64 / 500.0;
        let gust = (0.5 - 0.5 * (1.3 * t).cos()).powi(2) * t.min(1.0);
        let [gx, gy, gz] = [
            gust * (0.5 * (5.1 * t).sin() + 0.2 * (31.0 * t).sin()),
            gust * (0.4 * (6.3 * t).sin() + 0.2 * (27.0 * t).cos()),
            gust * 0.2 * (2.2 * t).sin(),
        ];
        let [ax, ay, az] = [
            gust * (3.7 * t).sin(),
            gust * (4.3 * t).cos(),
            -9.8 + gust * (9.0 * t).sin(),
        ];
        let [mx, my] = [0.2 + 0.02 * gust * t.sin(), 0.02 * gust * (1.7 * t).sin()];
        writeln!(
            text,
            "{},{gx},{gy},{gz},{ax},{ay},{az},{mx},{my},0.4",
            step * 2000
        )
        .expect("a string takes everything");
    }
    text
}

/// That flight.
fn gusts(seconds: u64) -> Flight {
    let rotate = Rotate::Named(Rotation::NONE);
    Flight::of_bytes("gusts.csv".into(), log_of_gusts(seconds).as_bytes(), rotate)
        .unwrap_or_else(|fault| panic!("{fault:?}"))
}

fn scored(flight: &Flight, options: &ReplayOptions) -> Score {
    fly_and_score(flight, options).unwrap_or_else(|error| panic!("{error:#}"))
}

#[test]
fn without_the_leading_input_sensors_alone_trigger() {
    let flight = gusts(20);
    let of = |settings: Settings| {
        let options = ReplayOptions {
            settings,
            ..ReplayOptions::default()
        };
        without_leading(&flight, &options).unwrap_or_else(|error| panic!("{error:#}"))
    };
    let found = of(reflex::config::SETTINGS).expect("the command triggers by default");
    assert!(found.triggers.contains(&"gyro".to_owned()));
    assert!(!found.triggers.contains(&"command".to_owned()));
    // As a flight with these triggers is scored.
    let by_gyro = Settings {
        triggers: Inputs::NONE.with(Input::Gyro).with(Input::Command),
        ..reflex::config::SETTINGS
    };
    let gyro = Inputs::NONE.with(Input::Gyro);
    let alone = Settings {
        triggers: gyro,
        ..by_gyro
    };
    let options = ReplayOptions {
        settings: alone,
        ..ReplayOptions::default()
    };
    let expected = WithoutLeading::of(gyro, &scored(&flight, &options));
    assert_eq!(of(by_gyro), Some(expected));
    // Nothing is left out where nothing leads.
    assert_eq!(of(alone), None);
    let periodic = Settings {
        policy: Policy::Periodic,
        ..reflex::config::SETTINGS
    };
    assert_eq!(of(periodic), None);
}

fn check_that_runs_are_spared(score: &Score) {
    assert!(score.warm_up.ended, "reactive control was never reached");
    let control = &score.section.control;
    assert!(control.by_reason.trigger > 0, "{control:?}");
    assert!(
        control.runs < score.hyperperiods * 2 / 3,
        "{} runs in {} hyperperiods",
        control.runs,
        score.hyperperiods
    );
}

#[test]
fn the_same_options_give_the_same_calls_twice() {
    let flight = gusts(5);
    let options = ReplayOptions::default();
    let [first, second] = [(); 2].map(|()| fly(&flight, &options).expect("a flight"));
    assert!(first.len() > 10_000, "{} calls", first.len());
    assert_eq!(first, second);
    let settings = Settings {
        seed: 2,
        ..reflex::config::SETTINGS
    };
    let other = ReplayOptions {
        settings,
        ..options
    };
    assert_ne!(first, fly(&flight, &other).expect("a flight"));
}

#[test]
fn a_short_flight_reaches_reactive_control_and_spares_runs() {
    check_that_runs_are_spared(&scored(&gusts(20), &ReplayOptions::default()));
}

#[test]
fn a_recorded_flight_reaches_reactive_control_and_spares_runs() {
    let Some(log) = recording("csv/px4_v6c_quad_calm.csv") else {
        return;
    };
    let flight = Flight::read(&log, Rotate::Auto).expect("a flight");
    check_that_runs_are_spared(&scored(&flight, &ReplayOptions::default()));
}

#[test]
fn periodic_control_runs_at_its_rate() {
    let settings = Settings {
        policy: Policy::Periodic,
        period: micros(4_000),
        ..reflex::config::SETTINGS
    };
    let options = ReplayOptions {
        settings,
        ..ReplayOptions::default()
    };
    let control = scored(&gusts(5), &options).section.control;
    let rate = control.by_reason.periodic as f64 / 5.0;
    assert!((rate - 250.0).abs() < 3.0, "{rate} Hz");
}

#[test]
fn flights_go_on_side_by_side_in_threads_of_the_caller() {
    let flight = gusts(5);
    let seeds = [1, 2].map(|seed| ReplayOptions {
        settings: Settings {
            seed,
            ..reflex::config::SETTINGS
        },
        ..ReplayOptions::default()
    });
    let alone: Vec<_> = (seeds.iter())
        .map(|options| fly(&flight, options).ok())
        .collect();
    let together: Vec<_> = std::thread::scope(|scope| {
        let flights: Vec<_> = (seeds.iter())
            .map(|options| scope.spawn(|| fly(&flight, options).ok()))
            .collect();
        (flights.into_iter())
            .map(|flight| flight.join().expect("no panic"))
            .collect()
    });
    assert!(alone == together && alone.iter().all(Option::is_some));
}

/// A board in the middle of a flight.
fn in_flight(flight: &Flight, seconds: u64, settings: Settings) -> NativeBoard {
    let setpoints = Setpoints::of(flight);
    let options = ReplayOptions {
        settings,
        ..ReplayOptions::default()
    };
    let (mut board, _) = boot(flight, &setpoints, &options).expect("booted");
    board.run_until(seconds * 1_000_000_000);
    board
}

fn accel(board: &NativeBoard) -> &DieWire {
    let place = |input| Input::OF_CHIPS.iter().position(|chip| *chip == input);
    &board.dies[place(Input::ChipAccel).expect("of a chip")]
}

/// The accelerometer's supply dips now: its registers are lost, it samples no more, and its pin
/// stays low, which is also what a steady sensor behind a threshold looks like.
fn check_that_a_dip_is_noticed(board: &mut NativeBoard) {
    let dip_ns = board.now_ns;
    let dip_us = clock(dip_ns).ticks();
    board.take_calls();
    accel(board).with(|wired| wired.chip.brown_out(dip_ns));
    assert_eq!(accel(board).with(|wired| wired.chip.rate_hz()), None);
    board.run_until(dip_ns + 3_000_000_000);

    let calls = board.take_calls();
    let after_ms = |of: &dyn Fn(&Call) -> bool| {
        let stamped = calls.iter().find(|stamped| of(&stamped.call))?;
        Some((stamped.at.ticks() - dip_us) as f64 * 1e-3)
    };
    let is_accel = |order: &ChipOrder| order.input == Input::ChipAccel;
    let noticed =
        after_ms(&|call| matches!(call, Call::OrderDone(order, Err(_)) if is_accel(order)));
    let again = after_ms(&|call| {
        let keeps = [ChipAction::Rearm, ChipAction::Read, ChipAction::Heartbeat];
        matches!(call, Call::OrderDone(order, Ok(_))
            if is_accel(order) && !keeps.contains(&order.action))
    });
    println!("noticed after {noticed:?} ms, programmed again after {again:?} ms");
    let two_failsafe_periods_ms = reflex::config::SETTINGS.failsafe.ticks() as f64 * 2e-3;
    assert!(noticed.is_some_and(|after| after < two_failsafe_periods_ms));
    assert!(again.is_some_and(|after| after < two_failsafe_periods_ms));
    let rate = accel(board).with(|wired| wired.chip.rate_hz());
    assert_eq!(rate, Some(f64::from(reflex::config::CHIP_ACCEL_RATE)));
}

#[test]
fn a_supply_dip_of_an_accelerometer_that_tells_every_sample_is_noticed() {
    let mut board = in_flight(&gusts(30), 15, reflex::config::SETTINGS);
    check_that_a_dip_is_noticed(&mut board);
}

#[test]
fn a_supply_dip_of_an_accelerometer_that_compares_is_noticed() {
    let Some(log) = recording("csv/ap33_solo_loiter_mpu6000_lsm303d.csv") else {
        return;
    };
    let flight = Flight::read(&log, Rotate::Auto).expect("a flight");
    // Where the gyroscope reports first, the chip has nothing to say; and what calls for a run with
    // less certainty is finer than one of its codes.
    let settings = Settings {
        triggers: Inputs::NONE.with(Input::ChipAccel).with(Input::Turned),
        p_run: 0.9,
        ..reflex::config::SETTINGS
    };
    let mut board = in_flight(&flight, 10, settings);
    let compares = |board: &NativeBoard| accel(board).with(|wired| wired.chip.pin_threshold());
    while compares(&board).is_none() {
        assert!(
            board.now_ns < 60_000_000_000,
            "no threshold reached the chip"
        );
        board.run_until(board.now_ns + 100_000_000);
    }
    let wanted = compares(&board);
    check_that_a_dip_is_noticed(&mut board);
    println!("threshold {wanted:?} before, {:?} after", compares(&board));
    assert!(compares(&board).is_some());
}

/// That flight, pushed forward for a while at an instant, by 6 m/s2.
fn pushed(seconds: u64, from_us: u64) -> Flight {
    let pushed = |line: &str| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let at_us = cells[0].parse::<u64>().unwrap_or_default();
        if let (true, Ok(ax)) = (at_us >= from_us, cells[4].parse::<f64>()) {
            cells[4] = (ax + 6.0).to_string();
        }
        cells.join(",")
    };
    let log: Vec<String> = log_of_gusts(seconds).lines().map(pushed).collect();
    let rotate = Rotate::Named(Rotation::NONE);
    Flight::of_bytes(
        "pushed.csv".into(),
        (log.join("\n") + "\n").as_bytes(),
        rotate,
    )
    .unwrap_or_else(|fault| panic!("{fault:?}"))
}

/// What is asked of a run by the chip's accelerometer alone within 15 ms of a push, with an inertial
/// sensor that went wrong just before.
fn runs_of_the_chip(goes_wrong: impl Fn(&NativeBoard)) -> usize {
    let push_us = 15_000_000;
    let flight = pushed(20, push_us);
    let standstill_ns = recorded_flights::Standstill::default().length_ns();
    let push_ns = standstill_ns + push_us * 1000;
    let mut board = in_flight(&flight, 10, reflex::config::SETTINGS);
    // Past 1 m/s2 a run is as likely changed as it must be.
    board.run_until(push_ns - 200_000_000);
    let settings = reflex::config::SETTINGS;
    let odds = settings.p_run / (1.0 - settings.p_run);
    let model = reflex::reactive::Logistic {
        b1: odds.ln() - 10.0,
        b2: 10.0,
    };
    let refit = reflex::reactive::Refit {
        input: Input::ChipAccel,
        fit: reflex::reactive::Fit::Model(model),
    };
    board.pilot.on_refit(clock(board.now_ns), refit);
    board.run_until(push_ns - 2_000_000);
    goes_wrong(&board);
    board.take_calls();
    board.run_until(push_ns + 15_000_000);
    let calls = board.take_calls();
    let runs = calls.iter().filter(|stamped| {
        matches!(stamped.call, Call::Ran(ran) if ran.asked.sole() == Some(Input::ChipAccel))
    });
    runs.count()
}

#[test]
fn when_the_inertial_sensor_falls_silent_a_push_crosses_the_chips_threshold_and_control_runs() {
    let silent = |board: &NativeBoard| {
        let now_ns = board.now_ns;
        board.imu.with(|wired| wired.chip.brown_out(now_ns));
    };
    assert!(runs_of_the_chip(silent) > 0);
}

#[test]
fn when_the_inertial_sensor_slows_to_a_tenth_a_push_crosses_the_chips_threshold_and_control_runs() {
    const SAMPLE_RATE_DIVIDER: u8 = 0x19;
    let slow = |board: &NativeBoard| {
        let now_ns = board.now_ns;
        (board.imu).with(|wired| wired.chip.corrupt(now_ns, SAMPLE_RATE_DIVIDER, 9));
    };
    assert!(runs_of_the_chip(slow) > 0);
}

#[test]
fn a_supply_dip_of_the_gyro_is_repaired_within_the_failsafe() {
    let mut board = in_flight(&gusts(30), 10, reflex::config::SETTINGS);
    let before = board.imu.with(|wired| wired.rises.len());
    board.imu.with(|wired| wired.chip.brown_out(10_000_000_000));
    board.run_until(11_000_000_000);
    let samples = board.imu.with(|wired| wired.rises.len()) - before;
    println!("{samples} samples in the second behind the dip");
    assert!(samples > 700, "{samples} samples");
}

/// The longest time between two runs, in us.
fn longest_gap_us(flight: &Flight) -> u64 {
    let calls = fly(flight, &ReplayOptions::default()).expect("a flight");
    let runs = calls
        .iter()
        .filter(|stamped| matches!(stamped.call, Call::Ran(_)));
    let at: Vec<u64> = runs.map(|stamped| stamped.at.ticks()).collect();
    let gaps = at.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.max().expect("runs")
}

#[test]
fn no_recorded_flight_leaves_control_waiting_longer_than_the_failsafe_and_a_hyperperiod() {
    let bound = (reflex::config::SETTINGS.failsafe + reflex::config::HYPERPERIOD).ticks();
    for name in [
        "csv/ansfl_phantom4_h11.csv",
        "csv/ap33_solo_acro_crash_mpu6000_lsm303d.csv",
        "csv/ap33_solo_loiter_mpu6000_lsm303d.csv",
        "csv/bf42_gecko_cruise.csv",
        "csv/bf42_kakutef7_ar8_hover.csv",
        "csv/bf45_speedybee_freestyle.csv",
        "csv/bf45_speedybee_freestyle_unfilt.csv",
        "csv/px4_v5_hexa_vib.csv",
        "csv/px4_v6c_quad_calm.csv",
    ] {
        let Some(log) = recording(name) else {
            continue;
        };
        let flight = Flight::read(&log, Rotate::Auto).expect("a flight");
        let longest = longest_gap_us(&flight);
        println!("{name}: {longest} us");
        assert!(longest <= bound, "{name}: {longest} us");
    }
}

/// Flights whose field is told to be bent, and how often at most.
///
/// That of the hexacopter is: its motors' currents make it 0.2 to 1.7 gauss strong, where 0.37 is
/// Earth's. That of the other two is Earth's all the time, 0.4 to 0.6 gauss; in fast turns and
/// flips its direction jumps against the gyroscope's, as it is sampled at 50 Hz and a moment late.
/// The heading is then the gyroscope's for as long.
const FIELDS: [(&str, u32); 3] = [
    ("px4_v5_hexa_vib", 2),
    ("ap33_solo_loiter_mpu6000_lsm303d", 1),
    ("ap33_solo_acro_crash_mpu6000_lsm303d", 5),
];

/// In a recorded flight the body does not answer the commands, and all sensors are well.
#[test]
fn no_recorded_flight_raises_an_alarm() {
    let flights = recordings::flights();
    let logics = [LogicName::configured(), LogicName::ArduCopter];
    let flown = flights
        .par_iter()
        .flat_map_iter(|flight| logics.map(|logic| (flight, logic)));
    let raised: Vec<String> = flown
        .flat_map_iter(|(flight, logic)| {
            let options = ReplayOptions {
                gains: logic.into(),
                ..ReplayOptions::default()
            };
            let (mut board, end_ns) =
                boot(flight, &Setpoints::of(flight), &options).expect("booted");
            board.run_until(end_ns);
            let bent = FIELDS.iter().find(|(name, _)| flight.name.contains(name));
            let fields = [(Fault::FieldBent, bent.map_or(0, |(_, times)| *times))];
            let expected = ALARMS.map(|alarm| (alarm, 0)).into_iter().chain(fields);
            let more = expected.filter(|(alarm, times)| board.pilot.faults(*alarm) > *times);
            more.map(|(alarm, _)| format!("{} {logic:?}: {alarm:?}", flight.name))
                .collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(raised, Vec::<String>::new());
}

/// Runs within 10 %, RMS within 15 %: the tiers' samples differ by microseconds, and with them
/// every label; they must not differ in what control decides.
fn check_that_the_tiers_agree(name: &str) {
    let Some(log) = recording(name) else {
        return;
    };
    let options = ReplayOptions {
        log: Some(log),
        duration_s: Some(60.0),
        ..ReplayOptions::default()
    };
    let native = replay(&options, &mut crate::progress::Silent).expect("a native replay");
    let emulated =
        crate::replay::emulated::replay(&options, &mut crate::progress::Silent).expect("a replay");
    assert_eq!(
        (native.run.tier, emulated.run.tier),
        (Tier::Native, Tier::Emulated)
    );
    assert!(native.run.cpu.is_none() && native.run.firmware.is_none());
    let within = |what: &str, native: f64, emulated: f64, most: f64| {
        println!("{name}: {what} {native:.3} natively, {emulated:.3} emulated");
        let off = (native / emulated - 1.0).abs();
        assert!(
            off <= most,
            "{name}: {what} {native} natively, {emulated} emulated"
        );
    };
    let runs = |report: &Report| report.score.section.control.runs as f64;
    within("runs", runs(&native), runs(&emulated), 0.10);
    let rms = |report: &Report| {
        let rms = report
            .score
            .section
            .actuators
            .deviation
            .rms_deviation_quanta;
        rms.expect("something was scored")
    };
    within("RMS", rms(&native), rms(&emulated), 0.15);
    for sensor in 0..native.run.sensors.len() {
        let samples = |report: &Report| report.run.sensors[sensor].samples as f64;
        within("samples", samples(&native), samples(&emulated), 0.05);
    }
}

#[test]
fn the_tiers_agree_on_a_calm_hover() {
    check_that_the_tiers_agree("csv/px4_v6c_quad_calm.csv");
}

#[test]
fn the_tiers_agree_on_a_loiter() {
    check_that_the_tiers_agree("csv/ap33_solo_loiter_mpu6000_lsm303d.csv");
}

/// A replay of those gusts under a script.
fn broken_by(text: &str) -> anyhow::Result<Vec<Stamped>> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("faults.toml");
    std::fs::write(&file, text).unwrap();
    let options = ReplayOptions {
        faults: Some(file),
        ..ReplayOptions::default()
    };
    fly(&gusts(10), &options)
}

#[test]
fn a_script_breaks_things_in_a_replay_from_its_instant_on() {
    let script = "[[fault]]\nwhat = 'no_acknowledge'\nwhere = 'imu_bus'\nat_s = 6\nfor_s = 0.02\n";
    let calls = broken_by(script).unwrap();
    let faults = calls
        .iter()
        .filter(|call| call.call == Call::Fault(Fault::ImuBus));
    let at_s: Vec<f64> = faults.map(|call| call.at.ticks() as f64 * 1e-6).collect();
    assert!(at_s.len() > 5, "{at_s:?}");
    let from_s = Standstill::default().length_ns() as f64 * 1e-9 + 6.0;
    assert!(
        at_s.iter()
            .all(|at_s| (0.0..0.05).contains(&(at_s - from_s))),
        "{at_s:?}"
    );
    let sound = fly(&gusts(10), &ReplayOptions::default()).unwrap();
    let before = calls
        .iter()
        .zip(&sound)
        .take_while(|(one, other)| one == other);
    let last = before.last().expect("the same at first").0.at.ticks() as f64 * 1e-6;
    assert!((last - from_s).abs() < 0.01, "{last}");
}

/// entry | what is said
const SENSELESS: &str = "
what = 'sulk'; where = 'link'; at_s = 1 | 2: fault.0.what: `sulk` is unknown here
what = 'zero'; where = 'nose'; at_s = 1 | 3: fault.0.where: `nose` is unknown here
what = 'bias'; where = 'gyroscope'; at_s = 1; size = 1; unit = 'rad' | 6: fault.0.unit: `rad` is unknown here
what = 'zero'; where = 'gyroscope'; at_s = 11 | 4: fault.0.at_s: 11 is out of range, must be 0 to 9.998 s of the flight
what = 'zero'; where = 'gyroscope'; at_s = 9; for_s = 2 | 5: fault.0.for_s: 2 is out of range
what = 'lost'; where = 'motor1'; at_s = 1 | 2: fault.0.what: `lost` has no place in a replay
what = 'held_low'; where = 'accelerometer_line'; at_s = 1 | 2: fault.0.what: `held_low` needs the emulated board
";

#[test]
fn what_no_replay_can_play_is_refused_with_file_and_line() {
    for row in SENSELESS.trim().lines() {
        let (entry, expected) = row.split_once(" | ").unwrap();
        let script = format!("[[fault]]\n{}\n", entry.replace("; ", "\n"));
        let said = broken_by(&script).unwrap_err();
        assert!(said.is::<reflex_config::ConfigError>(), "{said}");
        let said = said.to_string();
        let (line, expected) = expected.split_once(": ").unwrap();
        let (_, rest) = said
            .split_once(&format!("faults.toml:{line}:"))
            .expect(&said);
        assert!(
            rest.contains(expected.split_once(": ").unwrap().1),
            "{said}"
        );
    }
}
