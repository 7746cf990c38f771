//! Campaigns of many runs, each decided by its name alone: kept in a file, continued after a stop, divided among
//! machines (shards), and merged.
//!
//! * [`Head`]: all that decides a run beside its name, the plan of all runs, and the shard;
//! * [`Keep`]: where the runs are kept, and which of them are to be made here;
//! * [`make`]: makes the runs that are not kept yet;
//! * [`merge`] and [`missing`]: merge shards, and list the runs that they lack.

mod file;
mod merge;
mod plan;
mod record;
mod shard;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Serialize;
use serde::de::DeserializeOwned;

use file::RunsFile;
pub use merge::{Merged, Missing, ShardMissing, merge, missing};
pub use plan::{Head, Plan};
pub use shard::Shard;

use crate::failure::Failure;
use crate::pool;
use crate::stop::Stop;

/// Where runs are kept, and which are made here.
#[derive(Clone, Debug, Default)]
pub struct Keep {
    /// File that keeps the runs; runs in it are not made again.
    pub file: Option<PathBuf>,
    /// The part of all runs that is made here; none = all.
    pub shard: Option<Shard>,
}

impl Keep {
    /// Numbers of the runs that are made here, of `runs` in all.
    pub fn ours(&self, runs: usize) -> impl Iterator<Item = usize> + '_ {
        (0..runs).filter(|run| self.shard.is_none_or(|shard| shard.has(*run)))
    }
}

pub enum BatchResult<R> {
    /// All runs, in the plan's order.
    All(Vec<R>),
    /// Number of runs of the shard, made now or before.
    Part(usize),
    /// Stopped: the runs made so far, in the plan's order.
    Stopped(Vec<Option<R>>),
}

/// Makes the runs of a plan that are not kept yet; `run` makes the one of this number, or none after a stop. `tell` hears
/// how many there are.
///
/// # Errors
/// The file cannot be used.
pub fn make<R: Serialize + DeserializeOwned + Send + Sync>(
    keep: &Keep,
    mut head: Head,
    (jobs, stop): (usize, &Stop),
    tell: &mut dyn FnMut(usize),
    run: impl Fn(usize) -> Option<R> + Sync,
) -> Result<BatchResult<R>, Failure> {
    head.shard = keep.shard;
    let (mut known, file) = match &keep.file {
        Some(path) => {
            let (runs, file) = RunsFile::open(path, &head)?;
            (runs, Some(file))
        }
        None => (BTreeMap::new(), None),
    };
    let plan = &head.plan;
    let ours: Vec<usize> = keep.ours(plan.len()).collect();
    let missing: Vec<usize> = ours
        .iter()
        .copied()
        .filter(|i| !known.contains_key(&plan.name(*i)))
        .collect();
    let before = ours.len() - missing.len();
    let run_one = |i: usize| {
        let run = run(missing[i])?;
        if let Some(file) = &file
            && !file.append(&record::of_run(plan.name(missing[i]), &run))
        {
            // The campaign stops if a run could not be kept.
            stop.press();
        }
        Some(run)
    };
    let made = pool::run(
        missing.len(),
        jobs,
        stop,
        &mut |done| tell(before + done),
        run_one,
    );
    if let Some(failure) = file.as_ref().and_then(RunsFile::take_failure) {
        return Err(failure);
    }
    for (i, run) in made {
        if let Some(run) = run {
            known.insert(plan.name(missing[i]), run);
        }
    }
    let is_whole = ours.iter().all(|i| known.contains_key(&plan.name(*i)));
    if is_whole && let Some(file) = &file {
        file.put_in_order(&head)?;
    }
    if is_whole && keep.shard.is_some() {
        return Ok(BatchResult::Part(ours.len()));
    }
    let runs: Vec<Option<R>> = (0..plan.len())
        .map(|i| known.remove(&plan.name(i)))
        .collect();
    if !is_whole {
        return Ok(BatchResult::Stopped(runs));
    }
    Ok(BatchResult::All(runs.into_iter().flatten().collect()))
}
