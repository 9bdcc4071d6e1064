//! A processor that control shares: its commands come later than they could.
//!
//! Commands keep their order: what waits holds back what follows. Steady latency is a delay of
//! the plant, see [`Stress`](super::Stress).

use clap::ValueEnum;
use rand_distr::{Distribution, StandardUniform};
use random_streams::{Generator, generator};

/// Keeps this chance apart from others of the same seed.
const STREAM: u64 = 0x4255_5359;
/// What control itself takes, ns.
const RUN_NS: u64 = 20_000;

/// How control shares the processor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contention {
    /// Most that each run waits, s; any wait up to it is as likely.
    pub jitter_s: f64,
    /// Share of runs that wait longer.
    pub late_share: f64,
    /// Most that these wait beside it, s.
    pub late_s: f64,
    /// What other tasks do.
    pub scheduler: Scheduler,
}

/// Whether other tasks give way to control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Scheduler {
    /// At once, as RTIC's tasks of a lower priority do.
    #[default]
    Preemptive,
    /// Once they have ended: ArduPilot's, with the tasks of Copter 3.2.
    Cooperative,
}

/// Runs per second and length in us of tasks beside control, in the order of their priority.
///
/// `ArduCopter.pde` of Copter 3.2, `scheduler_tasks` for fast processors, 40 us and more, each as long as
/// that table allows: receiving and sending take most. Together an eighth of the processor.
const TASKS: [[u64; 2]; 12] = [
    [50, 45],  // throttle_loop
    [50, 90],  // update_GPS
    [10, 72],  // update_batt_compass
    [10, 100], // update_altitude
    [50, 80],  // run_nav_updates
    [50, 42],  // compass_accumulate
    [1, 42],   // one_hz_loop
    [50, 550], // gcs_check_input
    [1, 150],  // gcs_send_heartbeat
    [50, 720], // gcs_send_deferred
    [50, 950], // gcs_data_stream_send
    [50, 45],  // update_mount
];

/// A processor under way.
pub(super) struct Processor {
    contention: Contention,
    chance: Generator,
    others: Option<Others>,
    newest_ns: u64,
}

impl Processor {
    pub(super) fn new(contention: Contention, seed: u64) -> Self {
        let mut chance = generator(seed, STREAM);
        let cooperates = contention.scheduler == Scheduler::Cooperative;
        Self {
            others: cooperates.then(|| Others::since(uniform(&mut chance))),
            contention,
            chance,
            newest_ns: 0,
        }
    }

    /// When a command applies that would at an instant, ns.
    pub(super) fn applies_ns(&mut self, at_ns: u64) -> u64 {
        let waits_ns = self
            .others
            .as_mut()
            .map_or(0, |others| others.wait_ns(at_ns));
        let late_ns = (self.lateness_s() * 1e9) as u64;
        self.newest_ns = self.newest_ns.max(at_ns + waits_ns + late_ns);
        self.newest_ns
    }

    fn lateness_s(&mut self) -> f64 {
        let Contention {
            jitter_s,
            late_share,
            late_s,
            ..
        } = self.contention;
        let mut up_to = |most_s: f64| most_s * uniform(&mut self.chance);
        let jitter_s = up_to(jitter_s);
        if up_to(1.0) < late_share {
            jitter_s + up_to(late_s)
        } else {
            jitter_s
        }
    }
}

/// A share of a whole, by chance.
fn uniform(chance: &mut Generator) -> f64 {
    StandardUniform.sample(chance)
}

/// Tasks that run while control does not, the first in the table of those that are due.
struct Others {
    due_ns: [u64; TASKS.len()],
    free_ns: u64,
}

impl Others {
    /// All are due at once, as ArduPilot counts them; that falls somewhere in 20 ms of control.
    fn since(phase: f64) -> Self {
        Self {
            due_ns: [(phase * 2e7) as u64; TASKS.len()],
            free_ns: 0,
        }
    }

    /// How long control waits that would run at an instant: until the task under way has ended.
    fn wait_ns(&mut self, at_ns: u64) -> u64 {
        while let Some((place, start_ns)) = self.next() {
            if start_ns >= at_ns {
                break;
            }
            let [hz, length_us] = TASKS[place];
            self.due_ns[place] += 1_000_000_000 / hz;
            self.free_ns = start_ns + 1000 * length_us;
        }
        let wait_ns = self.free_ns.saturating_sub(at_ns);
        self.free_ns = at_ns + wait_ns + RUN_NS;
        wait_ns
    }

    /// The task that runs next, and when.
    fn next(&self) -> Option<(usize, u64)> {
        let soonest_ns = self.due_ns.iter().min()?;
        let start_ns = self.free_ns.max(*soonest_ns);
        let place = self.due_ns.iter().position(|due_ns| *due_ns <= start_ns)?;
        Some((place, start_ns))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What 400 Hz waits in ten seconds, us.
    fn waits(contention: Contention, seed: u64) -> Vec<f64> {
        let mut processor = Processor::new(contention, seed);
        let wait =
            |run: u64| (processor.applies_ns(run * 2_500_000) - run * 2_500_000) as f64 / 1e3;
        (1..=4000).map(wait).collect()
    }

    fn share(waits: &[f64], above_us: f64) -> f64 {
        waits.iter().filter(|wait| **wait > above_us).count() as f64 / waits.len() as f64
    }

    #[test]
    fn who_has_the_processor_alone_never_waits() {
        assert!(
            waits(Contention::default(), 1)
                .iter()
                .all(|wait| *wait == 0.0)
        );
    }

    #[test]
    fn jitter_and_late_runs_are_as_frequent_and_as_late_as_asked() {
        let contention = Contention {
            jitter_s: 0.001,
            late_share: 0.2,
            late_s: 0.02,
            ..Contention::default()
        };
        let waits = waits(contention, 1);
        // Later than jitter alone: 19 of 20 late ones, and those that they hold back.
        assert!((0.19..0.9).contains(&share(&waits, 1_000.0)));
        assert!(waits.iter().all(|wait| *wait <= 21_000.0));
        assert_eq!(waits, super::tests::waits(contention, 1));
        assert_ne!(waits, super::tests::waits(contention, 2));
    }

    #[test]
    fn commands_keep_their_order() {
        let late = Contention {
            late_share: 0.5,
            late_s: 0.02,
            ..Contention::default()
        };
        let mut processor = Processor::new(late, 3);
        let instants: Vec<u64> = (1..1000)
            .map(|run| processor.applies_ns(run * 1_000_000))
            .collect();
        assert!(instants.is_sorted());
    }

    #[test]
    fn cooperative_tasks_delay_control_by_the_rest_of_one_at_most() {
        let contention = Contention {
            scheduler: Scheduler::Cooperative,
            ..Contention::default()
        };
        for seed in 1..20 {
            let waits = waits(contention, seed);
            assert!(waits.iter().all(|wait| *wait <= 950.0));
            let delayed = share(&waits, 0.0);
            assert!((0.05..0.25).contains(&delayed), "{delayed}");
        }
    }
}
