//! Who flies a campaign's jobs: this program, on every core.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

use anyhow::{Context, Result};

use super::journal::{Landed, Ways};
use super::sortie::{Job, Sortie, Tier};
use crate::closed_loop::{self, Core, Flyer, Scene};
use crate::costs;
use crate::firmware::Firmware;
use crate::progress::{Progress, Silent};
use recorded_flights::{Flight, Rotate, sample_flight};

/// Takes a finished flight, and says how far the campaign is.
pub type Take<'t> = &'t mut dyn FnMut(Landed, &mut dyn Progress) -> Result<()>;

/// Who flies a campaign's jobs. Each flight follows from its job alone.
pub trait Crew {
    /// Flies jobs; they land in any order.
    ///
    /// # Errors
    /// A flight that cannot be flown, firmware that contradicts the host, a flight not taken.
    fn fly(&mut self, orders: &Orders, progress: &mut dyn Progress, take: Take<'_>) -> Result<()>;

    /// Measures what a run of each control logic costs.
    ///
    /// # Errors
    /// A program that cannot be built, a fault of the board.
    fn ways(&mut self, progress: &mut dyn Progress) -> Result<Vec<Ways>> {
        let log = sample_flight()?;
        let flight = Flight::read(&log, Rotate::Auto)?;
        let costs = costs::measure_logics(&[flight], progress)?;
        let ways = costs.into_iter().map(|cost| {
            let mean = cost
                .flights
                .first()
                .map_or(cost.everything, |flight| flight.mean);
            Ways {
                logic: cost.name,
                ours: mean.reactive,
                callbacks: mean.callbacks,
                pointer_vector: mean.pointer_vector,
            }
        });
        Ok(ways.collect())
    }
}

/// Flights that wait for no other of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Orders {
    /// What all of them fly on.
    pub tier: Tier,
    /// The flights.
    pub jobs: Vec<Job>,
}

impl Orders {
    /// The stage that they are.
    fn stage(&self) -> String {
        let how = match self.tier {
            Tier::Emulated => "on the emulated board",
            Tier::Native => "natively",
        };
        format!("Flying {how}: {} flights", self.jobs.len())
    }
}

/// Flies in this process, on every core.
#[derive(Clone, Copy, Debug, Default)]
pub struct Here;

impl Crew for Here {
    fn fly(&mut self, orders: &Orders, progress: &mut dyn Progress, take: Take<'_>) -> Result<()> {
        let firmware = firmware(&orders.jobs, progress)?;
        let scenes = scenes(&orders.jobs)?;
        progress.stage(&orders.stage());
        let stop = AtomicBool::new(false);
        let (sender, landed) = mpsc::channel();
        rayon::in_place_scope_fifo(|scope| {
            for job in &orders.jobs {
                let (sender, scenes, firmware, stop) = (sender.clone(), &scenes, &firmware, &stop);
                scope.spawn_fifo(move |_| {
                    if !stop.load(Ordering::Relaxed) {
                        // Nobody listens any more only where it stopped.
                        let _ = sender.send(fly(job, scenes, firmware));
                    }
                });
            }
            drop(sender);
            let mut landed = landed.iter();
            let result = landed.try_for_each(|landed| take(landed?, progress));
            stop.store(true, Ordering::Relaxed);
            result
        })
    }
}

/// Drones and surroundings by the names of environment and airframe.
type Scenes<'j> = BTreeMap<[&'j str; 2], Scene>;

/// Where a flight is flown, and by what airframe.
fn place(sortie: &Sortie) -> [&str; 2] {
    [&sortie.environment, &sortie.airframe]
}

fn scenes(jobs: &[Job]) -> Result<Scenes<'_>> {
    let mut scenes = BTreeMap::new();
    for job in jobs {
        if let Entry::Vacant(place) = scenes.entry(place(&job.sortie)) {
            let [environment, airframe] = *place.key();
            place.insert(Scene::load(environment, airframe, None)?);
        }
    }
    Ok(scenes)
}

/// Each logic's firmware.
type Built = BTreeMap<usize, Firmware>;

/// Builds firmware one by one in the same place.
fn firmware(jobs: &[Job], progress: &mut dyn Progress) -> Result<Built> {
    let mut built = Built::new();
    let emulated = jobs.iter().filter(|job| job.sortie.tier == Tier::Emulated);
    for job in emulated {
        let (logic, _) = job.sortie.flies_with()?;
        if let Entry::Vacant(place) = built.entry(logic.place()) {
            place.insert(Firmware::build(logic, progress)?);
        }
    }
    Ok(built)
}

fn fly(job: &Job, scenes: &Scenes<'_>, firmware: &Built) -> Result<Landed> {
    let sortie = &job.sortie;
    let flyer = match sortie.tier {
        Tier::Native => Flyer::Native,
        Tier::Emulated => {
            let firmware = firmware.get(&sortie.flies_with()?.0.place());
            Flyer::Emulated(Core::of(firmware.context("no firmware was built")?))
        }
    };
    let scene = scenes.get(&place(sortie));
    let scene = scene.context("no scene was loaded")?;
    let flown = closed_loop::fly(scene, &job.options()?, flyer, &mut Silent)
        .with_context(|| sortie.to_string())?;
    Ok(Landed {
        job: job.clone(),
        report: flown.report,
    })
}
