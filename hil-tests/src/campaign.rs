//! Campaigns: hundreds of simulated hours of reactive against periodic control.
//!
//! ```text
//!   plan --> jobs --> crew (a program per airframe) --> journal --> findings --> report, tables
//! ```
//! A *trial* is one airframe with one logic in one environment under one seed, flown reactively
//! and time-triggered in the same wind. Emulated flights measure the processor's load first, and
//! with it the rate at which time-triggered control takes equal processor time. Every flight
//! follows from its job alone, and has a line in the journal: a campaign may be stopped,
//! or flown in parts on many computers, and its report is the same.

mod comparison;
mod crew;
mod findings;
mod journal;
mod known_plans;
mod load;
mod margins;
mod plan;
mod report;
mod role;
mod rule;
mod shard;
mod sortie;
mod sources;
mod table;
#[cfg(test)]
mod tests;
mod tuning;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::progress::Progress;
use crate::refusal::Refusal;

pub use crate::interval::Interval;
pub use comparison::{Cell, Compared, Comparison, Metric};
pub use crew::{Crew, Here};
pub use findings::Findings;
pub use plan::Plan;
pub use report::percent;
pub use shard::Shard;

use crew::Orders;
pub(crate) use journal::Records;
use journal::{Journal, Stamp};
use plan::USUAL_HZ;
use role::{Pace, Role};
use rule::{Contender, Tempo};
use sortie::{AS_CONFIGURED, Job, Sortie, Tier};

/// The options of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct CampaignOptions {
    /// Which flights.
    pub plan: Plan,
    /// The part that is flown; all of it without one.
    pub shard: Option<Shard>,
    /// Where journals, tables and report are.
    pub folder: PathBuf,
    /// Nothing is flown: the report is of what there is.
    pub report_only: bool,
}

/// Flies what is not yet flown, then reports everything that the folder holds.
///
/// `date` is written into the report, and nowhere else.
///
/// # Errors
/// A journal that does not belong to this campaign, a folder that cannot be written to (both
/// refusals), a flight that fails, firmware that contradicts the host.
pub fn campaign(
    options: &CampaignOptions,
    crew: &mut dyn Crew,
    date: &str,
    progress: &mut dyn Progress,
) -> Result<Findings> {
    let (plan, folder) = (&options.plan, &options.folder);
    let records = if options.report_only {
        let records = Records::read(folder, None)?;
        if records.flights.is_empty() {
            let folder = folder.display();
            let line = format!("--report-only: {folder} holds no journal with a flight");
            return Err(Refusal::new(line).into());
        }
        check_plan(&records, plan, folder)?;
        records
    } else {
        let stamp = Stamp::new(&plan.name, sources::fingerprint()?);
        let journal = Journal::open(folder, options.shard, &stamp)?;
        let mut flying = Flying {
            plan,
            stamp,
            journal,
        };
        flying.all(options.shard, crew, progress)?;
        flying.journal.records
    };
    progress.stage("Writing the report");
    let findings = Findings::of(plan, &records);
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        fs::write(&path, bytes).with_context(|| format!("{} cannot be written", path.display()))
    };
    write("flights.parquet", &table::parquet(&records)?)?;
    let report = report::report(plan, &records, &findings, date)?;
    write("report.html", report.page.as_bytes())?;
    for figure in &report.figures {
        write(&format!("{}.svg", figure.file), figure.svg.as_bytes())?;
    }
    Ok(findings)
}

fn check_plan(records: &Records, plan: &Plan, folder: &Path) -> Result<(), Refusal> {
    match &records.stamp {
        Some(stamp) if stamp.plan != plan.name => Err(Refusal::new(format!(
            "{}: its journals are of plan {}, not of {}",
            folder.display(),
            stamp.plan,
            plan.name
        ))),
        _ => Ok(()),
    }
}

/// A campaign in the air.
struct Flying<'p> {
    plan: &'p Plan,
    stamp: Stamp,
    journal: Journal,
}

impl Flying<'_> {
    /// A part, wave by wave: load, then reactive control, then what it decides.
    fn all(
        &mut self,
        shard: Option<Shard>,
        crew: &mut dyn Crew,
        progress: &mut dyn Progress,
    ) -> Result<()> {
        let part = self.plan.part(shard);
        let is_emulated = |sortie: &Sortie| sortie.tier == Tier::Emulated;
        if part.iter().any(is_emulated) && self.journal.records.ways.is_empty() {
            let line = journal::ways_line(&self.stamp, crew.ways(progress)?)?;
            self.journal.write(&line)?;
        }
        let wave = |sortie: &Sortie| (sortie.tier, sortie.role.wave());
        for next in part.iter().map(wave).collect::<BTreeSet<_>>() {
            let sorties = part.iter().filter(|sortie| wave(sortie) == next);
            self.wave(next.0, sorties, crew, progress)?;
        }
        Ok(())
    }

    fn wave<'s>(
        &mut self,
        tier: Tier,
        sorties: impl Iterator<Item = &'s Sortie>,
        crew: &mut dyn Crew,
        progress: &mut dyn Progress,
    ) -> Result<()> {
        let records = &self.journal.records;
        let left = sorties.filter(|sortie| !records.flights.contains_key(sortie));
        let mut jobs: Vec<Job> = left.filter_map(|sortie| self.job(sortie)).collect();
        if jobs.is_empty() {
            return Ok(());
        }
        // The longest first, so that no core is left alone with it.
        jobs.sort_by_key(|job| std::cmp::Reverse(job.sortie.duration_s));
        let orders = Orders { tier, jobs };
        let (mut done, of) = (0, orders.jobs.len());
        let (journal, stamp) = (&mut self.journal, &self.stamp);
        crew.fly(&orders, progress, &mut |landed, progress| {
            journal.write(&journal::flight_line(stamp, landed)?)?;
            done += 1;
            progress.done(f64::from(done), of as f64);
            Ok(())
        })
    }

    /// The job of a flight; none where the flight that decides it crashed or is missing.
    fn job(&self, sortie: &Sortie) -> Option<Job> {
        let records = &self.journal.records;
        let period_us = match sortie.role {
            Role::Periodic(hz) | Role::Traded(_, Pace::Rate(hz)) => {
                Some(load::period_us(f64::from(hz)))
            }
            Role::EqualTime => {
                let load = load::measured(self.plan, records, sortie)?;
                Some(load.period_us())
            }
            Role::Margin(Tempo::Usual, ..)
            | Role::Tuned(_, Contender::Usual)
            | Role::Hovering(Contender::Usual)
            | Role::Observing(Contender::Usual) => Some(load::period_us(f64::from(USUAL_HZ))),
            Role::Margin(Tempo::EqualRuns(rule), ..) => {
                let rate_hz = tuning::reactive_rate_hz(self.plan, records, sortie, rule)?;
                Some(load::period_us(rate_hz))
            }
            role => match role.decided_by() {
                Some(reactive) => {
                    let report = &records.flights.get(&sortie.with(reactive))?.report;
                    Some(load::period_us(report.control.rate_hz?))
                }
                None => None,
            },
        };
        let bandwidth = match sortie.role {
            Role::Margin(_, percent, _) | Role::Traded(percent, _) => percent,
            Role::Tuned(rule, of) => tuning::fastest(records, sortie, rule, of)?,
            _ => AS_CONFIGURED,
        };
        Some(Job {
            sortie: sortie.clone(),
            period_us,
            bandwidth,
        })
    }
}
