//! Many pieces of work on every core, in an order that does not depend on threads.

use std::sync::mpsc;

use anyhow::{Context, Result};

use crate::progress::Progress;

/// What work makes of each job, in the order of the jobs; as many threads as cores where `threads` is 0.
///
/// # Errors
/// No thread can be started.
pub fn map<J: Sync, T: Send>(
    jobs: &[J],
    threads: usize,
    work: impl Fn(&J) -> T + Sync,
    progress: &mut dyn Progress,
) -> Result<Vec<T>> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .context("threads cannot be started")?;
    let (sender, receiver) = mpsc::channel();
    // Only here is the caller's progress touched: the threads report to this one.
    let mut done: Vec<(usize, T)> = pool.in_place_scope_fifo(|scope| {
        for (place, job) in jobs.iter().enumerate() {
            let (sender, work) = (sender.clone(), &work);
            // The receiver is gone only where another thread has panicked.
            scope.spawn_fifo(move |_| {
                let _ = sender.send((place, work(job)));
            });
        }
        drop(sender);
        (receiver.iter().enumerate())
            .map(|(before, result)| {
                progress.done((before + 1) as f64, jobs.len() as f64);
                result
            })
            .collect()
    });
    done.sort_by_key(|(place, _)| *place);
    Ok(done.into_iter().map(|(_, result)| result).collect())
}
