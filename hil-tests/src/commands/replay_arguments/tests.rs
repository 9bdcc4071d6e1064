//! Which arguments make a replay, and which are refused with what.

use clap::Parser;
use proptest::prelude::*;
use reflex::config;
use reflex::graph::CONFIGURED;
use reflex::sensors::{Input, Inputs};
use reflex::settings::{
    Feedback, MotorProtocol, Pairs, Policy, Reference, Settings, Start, WarmUp,
};
use reflex::time::micros;

use super::*;
use crate::logics::LogicName;
use recorded_flights::Rotate;

#[derive(Parser)]
struct Only {
    #[command(flatten)]
    arguments: ReplayArguments,
}

/// arguments | what is said
const SENSELESS: &str = "
--rate 100 | --rate: reactive control has none
--policy reactive --rate 100 | use --policy periodic
--policy periodic --reference last-run | --reference: periodic control has none
--policy periodic --p-run 0.5 | --p-run: periodic control has none
--policy periodic --warm-up auto | --warm-up: periodic control has none
--policy periodic --rate 0 | --rate: 0 is out of range, must be 1 to 1000 Hz
--policy periodic --rate -5 | --rate: -5 is out of range, must be 1 to 1000 Hz
--policy periodic --rate 1000.5 | must be 1 to 1000 Hz
--policy periodic --rate inf | must be a finite number
--policy periodic --rate nan | must be a finite number
--policy periodic --rate 5 | leaves the failsafe, every 100 ms, no room
--policy periodic --rate 10 | leaves the failsafe, every 100 ms, no room
--p-run 0 | --p-run: 0 is out of range, must be above 0 and below 1
--p-run 1 | --p-run:
--p-run -0.1 | --p-run:
--p-run 0.999999999999 | --p-run:
--p-run NaN | must be a finite number
--warm-up -1 | --warm-up: -1 is out of range, must be automatic or 0 to 30 s
--warm-up 31 | --warm-up: 31 is out of range, must be automatic or 0 to 30 s
--warm-up 1e300 | --warm-up:
--failsafe 0.001 | --failsafe: 0.001 is out of range, must be above 2 hyperperiods, 0.002 s
--failsafe 0.002 | --failsafe:
--failsafe 1.5 | --failsafe:
--failsafe -1 | --failsafe:
--quantum 0 | --quantum: 0 is out of range, must be above 0 and at most 0.5
--quantum=-1/255 | --quantum:
--quantum 0.6 | --quantum:
--quantum 1/0 | must be a finite number
--duration 0 | --duration 0: must be above 0 s
--duration -3 | --duration -3: must be above 0 s
--duration inf | must be a finite number
--duration 3 | nothing would be left to measure, the automatic warm-up lasts at least 3 s
--duration 5 --warm-up 5 | nothing would be left to measure, the warm-up lasts 5 s
--rotate sideways | unknown rotation 'sideways'
--noise loud | [possible values: none, datasheet]
--motors dshot | [possible values: oneshot125, pwm]
--reference first | [possible values: previous-sample, last-run]
--seed -1 | must be a whole number, 0 to 4294967295
--seed 4294967296 | must be a whole number, 0 to 4294967295
a.csv b.csv | a.csv and b.csv: one log at a time
--defmt src | --defmt src: is a folder
--native --defmt out.log | --defmt out.log: only the firmware writes a log, leave out --native
--defmt - | --defmt -: must be the name of a file
--defmt nowhere/out.log | --defmt nowhere/out.log: its folder does not exist
--record src | --record src: is a folder
--record flight.bag | --record flight.bag: must end in .mcap or .ulg
--native --record flight | --record flight: must end in .mcap or .ulg
--record nowhere/a.mcap | --record nowhere/a.mcap: its folder does not exist
--sweep p-run=0.2..0.9 --record a.ulg | cannot be used with
--sweep p-run | must be NAME=A..B
--sweep seed=1..9 | `seed` is none of p-run, failsafe, quantum
--sweep p-run=0.9..0.2 | must ascend
--sweep p-run=0..0.9 | '--sweep <NAME=A..B,...>': `p-run=0..0.9`: 0 is out of range, must be above 0 and below 1
--sweep p-run=0.2..0.9 --p-run 0.5 | --p-run: --sweep names p-run too, leave one of them out
--sweep failsafe=0.01..0.3 --failsafe 0.1 | --failsafe: --sweep names failsafe too
--sweep p-run=0.2..0.9 --policy periodic | leave out --rate and --policy periodic
--sweep p-run=0.2..0.9 --rate 100 | leave out --rate and --policy periodic
--sweep p-run=0.2..0.9 --defmt out.log | leave out --sweep, which is native
--sweep p-run=0.2..0.9 --sweep p-run=0.5 | cannot be used multiple times
--sweep p-run=0.2..0.9 --svg src | --svg src: is a folder
--sweep p-run=0.2..0.9 --svg nowhere/a.svg | --svg nowhere/a.svg: its folder does not exist
--sweep p-run=0.2..0.9 --svg - | --svg -: must be the name of a file
--sweep p-run=0.2..0.9 Cargo.toml --svg ./src/../Cargo.toml | is the recorded flight itself
--sweep p-run=0.2..0.9 . --svg Cargo.toml | is the recorded flight itself
--svg a.svg | --svg a.svg: only a sweep is drawn, add --sweep
--native src | src: is a folder, name one log, or add --sweep
Cargo.toml --defmt ./src/../Cargo.toml | is the recorded flight itself
";

/// The options of an argument line, or its error, from clap or from us.
fn parse(line: &str) -> Result<ReplayOptions, String> {
    let words = ["replay"].into_iter().chain(line.split_whitespace());
    let only = Only::try_parse_from(words).map_err(|error| error.to_string())?;
    only.arguments
        .options()
        .map_err(|refusal| refusal.to_string())
}

#[test]
fn without_arguments_the_configured_defaults_hold() {
    assert_eq!(parse("").unwrap(), ReplayOptions::default());
}

#[test]
fn every_option_arrives() {
    let options = parse(
        "a.csv --reference previous-sample --p-run 0.7 --warm-up 2 --warm-up-rate 400 --failsafe 0.2 \
         --quantum 1/128 --motors pwm --duration 20 --rotate roll180 --noise none --seed 9 \
         --triggers gyro,turned --pairs published --feedback published --defmt out.log --record a.ULG",
    )
    .unwrap();
    let settings = Settings {
        policy: Policy::Reactive,
        reference: Reference::PreviousSample,
        p_run: 0.7,
        warm_up: WarmUp::Fixed(micros(2_000_000)),
        warm_up_period: micros(2_500),
        failsafe: micros(200_000),
        quantum: 1.0 / 128.0,
        motors: MotorProtocol::Pwm,
        triggers: Inputs::NONE.with(Input::Gyro).with(Input::Turned),
        pairs: Pairs::Published,
        feedback: Feedback::Published,
        seed: 9,
        ..config::SETTINGS
    };
    let expected = ReplayOptions {
        gains: LogicName::configured().into(),
        log: Some("a.csv".into()),
        settings,
        duration_s: Some(20.0),
        reading: "roll180".parse::<Rotate>().unwrap().into(),
        noise: false,
        defmt: Some("out.log".into()),
        record: Some("a.ULG".into()),
        faults: None,
    };
    assert_eq!(options, expected);
}

#[test]
fn a_sweep_has_the_options_of_a_replay_at_every_point() {
    let words = "replay src --native --sweep p-run=0.2..0.9/3 --quantum 1/128 --seed 9";
    let only = Only::try_parse_from(words.split_whitespace()).expect("parsed");
    let sweep = only.arguments.sweep_options().expect("options");
    let sweep = sweep.expect("a sweep");
    assert_eq!(sweep.replay.log, Some("src".into()));
    assert_eq!(sweep.replay.settings.quantum, 1.0 / 128.0);
    assert_eq!(sweep.replay.settings.seed, 9);
    assert_eq!(sweep.grid.to_string(), "p-run=0.2..0.9/3");
    assert_eq!(only.arguments.sweep.figure(true), None);
    let default = only.arguments.sweep.figure(false).expect("a file");
    assert!(default.ends_with("target/hil/sweep.svg"));
}

#[test]
fn periodic_control_has_the_configured_rate_or_its_own() {
    let configured = config::SETTINGS.period;
    for (line, period) in [
        ("--policy periodic", configured),
        ("--policy periodic --rate 1000", micros(1000)),
        ("--policy periodic --rate 2 --failsafe 1", micros(500_000)),
        ("--policy periodic --duration 1", configured),
    ] {
        let settings = parse(line).unwrap().settings;
        assert_eq!(
            (settings.policy, settings.period),
            (Policy::Periodic, period)
        );
    }
}

#[test]
fn every_senseless_argument_is_refused_with_its_range() {
    for row in SENSELESS.trim().lines() {
        let (line, expected) = row.split_once(" | ").unwrap();
        let error = parse(line).expect_err(line);
        assert!(
            error.contains(expected),
            "{line}: {error:?} does not say {expected:?}"
        );
    }
}

proptest! {
    #[test]
    fn whatever_is_accepted_is_valid_for_the_firmware(
        periodic: bool,
        rate in prop::option::of(any::<f64>()),
        p_run in prop::option::of(any::<f64>()),
        failsafe in prop::option::of(any::<f64>()),
        quantum in prop::option::of(any::<f64>()),
        warm_up in prop::option::of(any::<f64>()),
        duration in prop::option::of(any::<f64>()),
        near in 0.0..2.0f64,
    ) {
        let scaled = |value: Option<f64>| value.map(|value| if value.abs() > 1e6 { near } else { value });
        let mut line = String::new();
        for (option, value) in [
            ("--rate", scaled(rate)), ("--p-run", scaled(p_run)), ("--failsafe", scaled(failsafe)),
            ("--quantum", scaled(quantum)), ("--warm-up", scaled(warm_up)),
            ("--duration", scaled(duration)),
        ] {
            if let Some(value) = value {
                line += &format!(" {option} {value}");
            }
        }
        if periodic {
            line += " --policy periodic";
        }
        match parse(&line) {
            Ok(options) => {
                prop_assert!(options.settings.check(&config::LIMITS).is_ok());
                prop_assert!(options.duration_s.is_none_or(|length| length > 0.0));
                let start = Start { settings: options.settings, ..CONFIGURED };
                prop_assert_eq!(Start::from_bytes(&start.to_bytes(), &config::LIMITS), Ok(start));
            }
            Err(error) => prop_assert!(error.contains("--"), "{}", error),
        }
    }

    #[test]
    fn no_argument_line_panics(line in "(--[a-z-]{1,9}|[0-9a-z./-]{1,6})( (--(rate|p-run|quantum|seed|defmt)|[-0-9.e/]{1,6})){0,4}") {
        let _ = parse(&line);
    }
}
