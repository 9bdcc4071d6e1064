//! Every number against cases worked out by hand, and rules for all flights.

mod actuators;
mod decisions;
mod deviation;
mod digest;
mod flights;
mod latency;
mod load;
mod oracle;
mod periodic;
mod properties;
mod report;
mod summary;
mod windows;

use super::{Clock, Command, FlightSteps, Held, Rules, Run, Score, score};
use reflex::app::Reason;
use reflex::config::GEOMETRY;

/// The same command on every motor.
fn all(share: f32) -> Command {
    Command::all(share, GEOMETRY.count())
}

/// A command with one motor apart from the others.
fn first(share: f32, others: f32) -> Command {
    let mut command = all(others);
    command[0] = share;
    command
}

fn run(reason: Reason, share: f32) -> Option<Run> {
    Some(Run {
        reason,
        asked: reason == Reason::Trigger,
        expected: None,
        repaid: None,
        command: all(share),
    })
}

/// A quarter of full scale: exact in binary, so that cases sit right on the boundary.
const QUANTUM: f32 = 0.25;

fn rules() -> Rules {
    Rules {
        quantum: QUANTUM,
        failsafe_us: 100_000,
        limits: 0.0..=1.0,
        ..Rules::default()
    }
}

/// A flight from 0 us whose warm-up is one hyperperiod that ran and held `start`.
fn after_warm_up(start: f32) -> FlightSteps {
    let mut flight = FlightSteps::new(0, all(0.0));
    flight.end_hyperperiod(1000, all(start), run(Reason::WarmUp, start));
    flight.end_warm_up(1000);
    flight
}

/// Ends the next hyperperiod, 1 ms after the last.
fn end(flight: &mut FlightSteps, reference: f32, run: Option<Run>) {
    flight.end_hyperperiod(flight.last_us() + 1000, all(reference), run);
}

/// Holds the reference at the hyperperiods that a periodic policy with this clock would reach.
fn fly(flight: &FlightSteps, clock: Clock) -> Vec<Held> {
    let period_us = 1e6 / clock.rate_hz;
    let mut held = all(0.0);
    let mut due_us = clock.phase * period_us - period_us;
    let steps = flight.steps().iter();
    steps
        .map(|step| {
            let runs = u32::from(step.at_us as f64 >= due_us);
            if runs == 1 {
                held = step.reference;
                due_us = f64::max(due_us + period_us, step.at_us as f64);
            }
            Held {
                command: held,
                runs,
            }
        })
        .collect()
}

fn scored(flight: &FlightSteps) -> Score {
    score(flight, &rules(), |clock| fly(flight, clock))
}
