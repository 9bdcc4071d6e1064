//! The example of `docs/porting.md`: a loop, its port, and what goes wrong between.
//!
//! Every snippet of the guide is checked to be code of this repository.

use reflex::dataflow::graph;
use reflex::math::limited;

/// Desired rate per rad of error, 1/s.
const ANGLE_P: f32 = 2.5;
/// Share of full authority per rad/s, per rad, per rad/s2.
const RATE_P: f32 = 0.086;
const RATE_I: f32 = 0.086;
const RATE_D: f32 = 0.000_57;
/// Most that the integral holds, as a share of full authority.
const INTEGRAL_LIMIT: f32 = 0.15;

/// What the loop is built for, in s.
const PERIOD: f32 = 0.002;

/// Roll as a time-triggered program flies it.
#[derive(Default)]
struct RollLoop {
    roll: f32,
    integral: f32,
    before: f32,
    slope: f32,
}

impl RollLoop {
    /// Every 2 ms: torque of a rate (rad/s) and a desired angle (rad).
    fn update(&mut self, rate: f32, target: f32) -> f32 {
        self.roll += rate * PERIOD;
        let error = ANGLE_P * (target - self.roll) - rate;
        self.integral += RATE_I * error * PERIOD;
        self.integral = limited(self.integral, INTEGRAL_LIMIT);
        self.slope += 0.2 * ((rate - self.before) / PERIOD - self.slope);
        self.before = rate;
        RATE_P * error + self.integral - RATE_D * self.slope
    }
}

/// What every sample since the last run sums up to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Turn {
    /// Angle turned, in rad.
    angle: f32,
    /// That angle integrated over the time, in rad s.
    swept: f32,
    /// Time, in s.
    dt: f32,
}

/// The newest rate (rad/s) and its derivative (rad/s2), filtered at every sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Spin {
    rate: f32,
    acceleration: f32,
}

graph! {
    /// Roll, as a graph.
    struct Roll;

    /// Sums since the last run.
    input turn: Turn, at 1000 Hz, gates, triggers;
    /// The newest rate.
    input spin: Spin, at 1000 Hz, gates, triggers;
    /// The desired angle, in rad.
    input target: f32, at 50 Hz, joins;

    /// The angle, in rad.
    state roll: f32 = turned(roll, &turn), clocked by turn;
    /// The desired rate, in rad/s.
    node wanted: f32 = angle_loop(roll, target);
    /// The integral term, as a share of full authority.
    state integral: f32 = integrated(integral, &turn, last wanted), clocked by turn;
    /// The torque, as a share of full authority.
    output torque: f32 = rate_loop(integral, wanted, &spin);
}

fn turned(roll: f32, turn: &Turn) -> f32 {
    roll + turn.angle
}

fn angle_loop(roll: f32, target: f32) -> f32 {
    ANGLE_P * (target - roll)
}

/// The desired rate fell with the angle turned, from what it was after the last run.
fn integrated(integral: f32, turn: &Turn, wanted: f32) -> f32 {
    let asked = wanted * turn.dt - ANGLE_P * turn.swept;
    let grown = integral + RATE_I * (asked - turn.angle);
    limited(grown, INTEGRAL_LIMIT)
}

fn rate_loop(integral: f32, wanted: f32, spin: &Spin) -> f32 {
    RATE_P * (wanted - spin.rate) + integral - RATE_D * spin.acceleration
}

const SAMPLE: f32 = 0.001;

/// The graph after these rates, a sample each, with a run where `asked` says so.
fn flown(rates: &[f32], mut asked: impl FnMut(usize) -> bool) -> Roll {
    let mut graph = Roll::new();
    graph.set_target(0.1);
    graph.propagate();
    let mut turn = Turn::default();
    for (place, &rate) in rates.iter().enumerate() {
        turn.swept += (turn.angle + 0.5 * rate * SAMPLE) * SAMPLE;
        turn.angle += rate * SAMPLE;
        turn.dt += SAMPLE;
        if asked(place) {
            graph.set_turn(std::mem::take(&mut turn));
            graph.set_spin(Spin {
                rate,
                acceleration: 0.0,
            });
            graph.propagate();
        }
    }
    graph
}

/// A second of rolling to and fro (rad/s) at 1 kHz.
fn swinging() -> Vec<f32> {
    (0..1000).map(|ms| (ms as f32 * 0.02).sin()).collect()
}

#[test]
fn each_input_reaches_its_slice() {
    let mut graph = flown(&swinging(), |_| true);
    graph.set_target(0.2);
    let changed = graph.propagate();
    assert!(changed.all(Roll::TARGET.or(Roll::WANTED).or(Roll::TORQUE)));
    assert!(
        !changed.any(Roll::ROLL.or(Roll::INTEGRAL)),
        "no time passed"
    );
}

#[test]
fn rare_runs_of_the_graph_come_to_what_frequent_ones_do() {
    let often = flown(&swinging(), |_| true);
    for every in [2, 10, 50, 100] {
        let rarely = flown(&swinging(), |place| (place + 1) % every == 0);
        let roll = (rarely.roll() - often.roll()).abs();
        let torque = (rarely.torque() - often.torque()).abs();
        assert!(roll < 1e-5 && torque < 1e-5, "{every}: {roll} {torque}");
    }
}

#[test]
fn a_nominal_period_loses_what_is_turned_between_rare_runs() {
    let rates = vec![1.0; 1000];
    let rolled = |every: usize| {
        let mut control = RollLoop::default();
        for rate in rates.iter().step_by(every) {
            control.update(*rate, 0.1);
        }
        control.roll
    };
    assert!((rolled(2) - 1.0).abs() < 1e-3, "as it was built");
    assert!((rolled(50) - 0.04).abs() < 1e-3, "a 25th of it");
}

#[test]
fn the_newest_rate_times_dt_is_biased_where_its_change_asked_for_the_run() {
    // A jerk of 10 ms in every 100: its begin and its end ask for a run.
    let rates: Vec<f32> = (0..1000)
        .map(|ms| if ms % 100 < 90 { 0.0 } else { 1.0 })
        .collect();
    let (mut taken, mut dt, mut at_last_run) = (0.0, 0.0, 0.0);
    let graph = flown(&rates, |place| {
        let rate = rates[place];
        dt += SAMPLE;
        let asked = rate != at_last_run;
        if asked {
            taken += rate * dt;
            (at_last_run, dt) = (rate, 0.0);
        }
        asked
    });
    assert!((taken - 0.9).abs() < 0.02, "{taken} rad as it seems");
    assert!((graph.roll() - 0.1).abs() < 0.02, "{}", graph.roll());
}

/// A block of the guide: the file that it quotes, and its lines.
fn snippets(guide: &str) -> Vec<(&str, Vec<&str>)> {
    let mut blocks = Vec::new();
    let mut lines = guide.lines();
    while let Some(line) = lines.next() {
        let Some(fence) = line.strip_prefix("```") else {
            continue;
        };
        let file = fence.split_once(' ').map_or("", |(_, file)| file);
        let block = lines.by_ref().take_while(|line| *line != "```");
        blocks.push((file, block.collect()));
    }
    blocks.retain(|(file, _)| !file.is_empty());
    blocks
}

/// Whether the lines stand in the file, in order and together but for `...` between.
fn quoted(block: &[&str], file: &str) -> bool {
    let trimmed: Vec<&str> = file.lines().map(str::trim).collect();
    let mut from = 0;
    block.split(|line| line.trim() == "// ...").all(|part| {
        let part: Vec<&str> = part.iter().map(|line| line.trim()).collect();
        let rest = trimmed.get(from..).unwrap_or_default();
        let found = rest.windows(part.len()).position(|lines| lines == part);
        from += found.unwrap_or(0) + part.len();
        found.is_some()
    })
}

#[test]
fn every_snippet_of_the_guide_is_what_its_file_says() {
    let guide = include_str!("../docs/porting.md");
    let blocks = snippets(guide);
    assert!(blocks.len() > 5, "{}", blocks.len());
    for (name, block) in blocks {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        let file = std::fs::read_to_string(&path).expect(name);
        assert!(
            quoted(&block, &file),
            "{name} has no such lines: {block:#?}"
        );
    }
}

#[test]
fn every_message_of_the_guide_is_one_of_the_compiler() {
    let guide = include_str!("../docs/porting.md");
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/graph_errors");
    let mut found = 0;
    for line in guide.lines() {
        let cells: Vec<&str> = line.split(" | ").collect();
        let [_, name, message] = cells.as_slice() else {
            continue;
        };
        let file = folder.join(format!("{}.stderr", name.trim_matches('`')));
        if let Ok(said) = std::fs::read_to_string(file) {
            let message = message.trim_end_matches(" |");
            assert!(said.contains(message), "{name}: {message}");
            found += 1;
        }
    }
    assert!(found > 5, "{found}");
}
