//! What the confirmed repairs of a depot say in a diagnosis: how often each part fails, how often it was the one when it was
//! named, and how the runs looked that a repair of it has settled.

use std::collections::BTreeMap;

use diagnosis::{Dictionary, ModeName, Observation, Settings};
use fault_db::{ConfirmedRepairs, Store};
use protocol::LruId;
use protocol::lru::from_stored;

use super::answer::comparable;
use super::history::OwnHistory;
use crate::failure::Failure;
use crate::run::of_run;

/// A diagnosis holds a run against so many confirmed cases at most, the last ones: each has to be read.
const MOST_CASES: u32 = 20;
/// Word for what confirmed cases of a part look like, in place of a mode's.
const CONFIRMED: &str = "confirmed";

/// Takes what was confirmed in units of one type before a time into a unit's history and, for one diagnosis, into the
/// dictionary: the depot's own cases stand there beside the simulated ones, as a mode of their own.
///
/// # Errors
/// The database cannot be read.
pub(super) fn take_confirmed(
    (history, dictionary): (&mut OwnHistory, &mut Dictionary),
    store: &Store,
    (before_us, unit_type): (i64, &str),
    settings: &Settings,
) -> Result<(), Failure> {
    let repairs = store.confirmed_repairs(before_us, unit_type)?;
    if repairs.is_empty() {
        return Ok(());
    }
    history.take_repairs(&repairs, dictionary, settings);
    for (part, counts) in repairs.iter().filter(|(_, counts)| counts.named > 0) {
        if let Some(part) = from_stored(part) {
            history.add_for(&part, was_right(*counts));
        }
    }
    let mut cases: BTreeMap<LruId, Vec<Observation>> = BTreeMap::new();
    for (part, run) in store.confirmed_cases(before_us, unit_type, MOST_CASES)? {
        let Some(part) = from_stored(&part).filter(|part| dictionary.lrus().contains(&part)) else {
            continue;
        };
        let run = store.run(run, &crate::process_id::is_alive)?;
        let seen = of_run(&run, &store.run_occurrences(run.run.id)?);
        let seen = comparable(&run, seen, dictionary, &mut Vec::new());
        if run.run.unit_config_sha256 == dictionary.basis.unit_config_sha256 && seen.shows_a_fault()
        {
            cases.entry(part).or_default().push(seen);
        }
    }
    let of_all: f64 = dictionary.modes.iter().map(|mode| mode.name.weight).sum();
    for (part, runs) in cases {
        let name = ModeName {
            id: format!("{part}.{CONFIRMED}"),
            text: match runs.len() {
                1 => "as in 1 confirmed case".into(),
                n => format!("as in {n} confirmed cases"),
            },
            lru: part,
            kind: CONFIRMED.into(),
            unsafe_: false,
            weight: of_all * runs.len() as f64 / settings.repairs_like_prior,
        };
        dictionary.add_cases(&name, &runs);
    }
    Ok(())
}

fn was_right(of: ConfirmedRepairs) -> String {
    let ConfirmedRepairs { named, right, .. } = of;
    format!("repaired in {right} of the {named} confirmed repairs for which a diagnosis found it")
}
