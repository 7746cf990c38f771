//! What the confirmed repairs of a depot say in a diagnosis: how often each part fails, how often a part that was named
//! was the right one, and how the runs looked that a repair of the part has settled.

use std::collections::{BTreeMap, BTreeSet};

use diagnosis::{Dictionary, Known, ModeName, Observation, Settings};
use fault_db::{RepairsOf, Store};
use protocol::LruId;
use protocol::lru::from_stored;

use super::history::OwnHistory;
use super::stored_run::observed;
use crate::failure::Failure;

/// A diagnosis holds a run against so many confirmed cases at most, the last ones: each has to be read.
const MOST_CASES: u32 = 20;

/// Takes what was confirmed in other units into a unit's history and, for one diagnosis, into the dictionary: the depot's
/// own cases stand there beside the simulated ones, as a mode of their own for each part.
///
/// So many cases weigh like so many observations beside those that `repairs_like_prior` stands for: the more there are, the
/// nearer such a mode comes to a usual mode of the dictionary, and never above it. Repairs of the part that did not help
/// count against it.
///
/// # Errors
/// The database cannot be read.
pub(super) fn take_confirmed(
    (history, dictionary): (&mut OwnHistory, &mut Dictionary),
    store: &Store,
    of: RepairsOf<'_>,
    settings: &Settings,
) -> Result<(), Failure> {
    let repairs = store.confirmed_repairs(of)?;
    if repairs.is_empty() {
        return Ok(());
    }
    history.take_repairs(&repairs, dictionary, settings);
    for (part, counts) in repairs.iter().filter(|(_, counts)| counts.named > 0) {
        if let Some(part) = from_stored(part) {
            let (right, named) = (counts.right, counts.named);
            history.add_for(&part, Known::WasRight { right, named });
        }
    }
    let mut cases: BTreeMap<LruId, Cases> = BTreeMap::new();
    for case in store.confirmed_cases(of, MOST_CASES)? {
        let Some(part) = from_stored(&case.part).filter(|part| dictionary.lrus().contains(&part))
        else {
            continue;
        };
        let (run, seen) = observed(store, case.run, dictionary)?;
        if run.run.unit_config_sha256 == dictionary.basis.unit_config_sha256 && seen.shows_a_fault()
        {
            let of_part = cases.entry(part).or_default();
            of_part.runs.push(seen);
            of_part.units.insert(case.unit);
        }
    }
    let weights: f64 = dictionary.modes.iter().map(|mode| mode.name.weight).sum();
    let usual = weights / dictionary.modes.len().max(1) as f64;
    for (part, Cases { runs, units }) in cases {
        let in_vain = repairs.get(part.as_str()).map_or(0, |of| of.in_vain);
        let (helped, in_vain) = (runs.len() as f64, f64::from(in_vain));
        let units: Vec<_> = units.into_iter().collect();
        let name = ModeName {
            id: format!("{part}.{}", ModeName::CONFIRMED),
            text: units.join(", "),
            lru: part,
            kind: ModeName::CONFIRMED.into(),
            unsafe_: false,
            weight: usual * helped / (helped + in_vain + settings.repairs_like_prior),
        };
        dictionary.add_cases(&name, &runs);
    }
    Ok(())
}

/// The confirmed cases of a part.
#[derive(Default)]
struct Cases {
    runs: Vec<Observation>,
    units: BTreeSet<String>,
}
