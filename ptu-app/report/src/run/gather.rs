//! Reads the content of a test sheet from the database.

use std::collections::BTreeMap;

use fault_db::{Id, RunDetail, RunOccurrence, Store, Verdict};

use super::plots::drawn_channels;
use super::{Sheet, SheetTrace};
use ptu_bench::data::ScriptsDirectory;
use ptu_bench::failure::Failure;
use ptu_bench::process_id;
use ptu_bench::run_diagnosis::diagnose_run;

impl Sheet {
    /// Reads all a run's sheet says. Without a scripts directory, or without a fault dictionary in it,
    /// there is no diagnosis, and the sheet says why.
    ///
    /// # Errors
    /// There is no such run, or the database cannot be read.
    pub fn gather(
        store: &Store,
        directory: Option<&ScriptsDirectory>,
        id: Id,
    ) -> Result<Self, Failure> {
        let run = store.run(id, &process_id::is_alive)?;
        let occurrences = store.run_occurrences(id)?;
        let all = traces(&run, &occurrences);
        let more_traces = all.len().saturating_sub(Self::MOST_TRACES);
        let read = |(id, steps, faults): Traced| SheetTrace {
            samples: store
                .trace(id)
                .map(drawn_channels)
                .map_err(|error| error.to_string()),
            id,
            steps,
            faults,
        };
        let diagnosis = match directory {
            Some(directory) => {
                diagnose_run(store, directory, id).map_err(|failure| failure.message)
            }
            None => Err("no scripts directory".into()),
        };
        let catalogue = directory.and_then(|directory| directory.faults().ok());
        let parts = catalogue
            .map(|catalogue| catalogue.lrus)
            .unwrap_or_default();
        Ok(Self {
            traces: all.into_iter().take(Self::MOST_TRACES).map(read).collect(),
            more_traces,
            diagnosis,
            parts: parts
                .into_iter()
                .map(|part| (part.id.to_string(), [part.name, part.name_ko]))
                .collect::<BTreeMap<_, _>>(),
            run,
        })
    }
}

/// A trace, the steps it belongs to and the faults it shows.
type Traced = (Id, Vec<u32>, Vec<String>);

/// Every trace of the run once; those of steps that did not pass come first.
fn traces(run: &RunDetail, occurrences: &[RunOccurrence]) -> Vec<Traced> {
    let mut all: Vec<Traced> = Vec::new();
    for seen in occurrences {
        let Some(id) = seen.trace_id else { continue };
        let place = all.iter().position(|known| known.0 == id);
        let place = place.unwrap_or_else(|| {
            all.push((id, Vec::new(), Vec::new()));
            all.len() - 1
        });
        let (_, steps, faults) = &mut all[place];
        steps.extend(seen.step_index.filter(|step| !steps.contains(step)));
        if !faults.contains(&seen.code_name) {
            faults.push(seen.code_name.clone());
        }
    }
    let of_failure = |traced: &Traced| {
        let mut steps = run
            .steps
            .iter()
            .filter(|step| traced.1.contains(&step.index));
        steps.any(|step| !matches!(step.verdict, Verdict::Passed | Verdict::Skipped))
    };
    // A stable sort: otherwise they stay in the order in which they came.
    all.sort_by_key(|traced| !of_failure(traced));
    all
}
