//! Whether a run that passed proves the repairs made before it.

use std::collections::BTreeMap;

use diagnosis::{Model, Proof};
use fault_db::{Id, Store};

use super::dictionary::choose;
use super::settings;
use super::stored_run::{connection_of, observed};
use crate::data::ScriptsDirectory;
use crate::failure::Failure;

/// What a run that passed says of the repair of a fault.
#[derive(Clone, Debug, PartialEq)]
pub struct RepairProof {
    pub fault: Id,
    pub code_name: String,
    /// Runs that passed since the repair, this one among them.
    pub passed: usize,
    /// What these runs say; if they prove the repair, its fault is verified.
    pub says: Proof,
}

/// Holds a run that passed against earlier repairs of its unit's faults, and verifies the faults whose repairs it
/// proves: a unit that still has the fault would pass with a probability of at most `hidden_fault`.
///
/// # Errors
/// The database or a dictionary cannot be read or written.
pub fn prove_repairs(
    store: &Store,
    directory: &ScriptsDirectory,
    run: Id,
) -> Result<Vec<RepairProof>, Failure> {
    let repairs = store.repairs_to_prove(run)?;
    if repairs.is_empty() {
        return Ok(Vec::new());
    }
    let settings = settings(directory)?;
    let connection = connection_of(&store.run(run)?);
    let dictionary = choose(Some(store), directory, connection)?.dictionary;
    let no_factors = BTreeMap::new();
    let model = Model::new(&dictionary, &settings, &no_factors);
    let seen = |run: &Id| Ok(observed(store, *run, &dictionary)?.1);
    let all_seen = |runs: &[Id]| runs.iter().map(seen).collect::<Result<Vec<_>, Failure>>();
    // The faults of a case were there in the same runs: these are weighed once.
    let mut known: BTreeMap<(Vec<Id>, Vec<Id>), Proof> = BTreeMap::new();
    let mut proofs = Vec::new();
    let mut proven = Vec::new();
    for repair in repairs {
        let passed = repair.passed.len();
        let runs = (repair.there, repair.passed);
        let says = match known.get(&runs) {
            Some(says) => *says,
            None => {
                let (there, passed) = (all_seen(&runs.0)?, all_seen(&runs.1)?);
                let Some(says) = Proof::of(&model, &there, &passed, settings.hidden_fault) else {
                    continue;
                };
                known.insert(runs, says);
                says
            }
        };
        if says.is_proven() {
            let they = match passed {
                1 => "it".to_owned(),
                n => format!("{n} runs"),
            };
            let share = 100.0 * says.hidden;
            let note = format!(
                "in run {run}: with the fault still there {they} would have passed in {share:.1} of 100 cases"
            );
            proven.push((repair.fault, note));
        }
        proofs.push(RepairProof {
            fault: repair.fault,
            code_name: repair.code_name,
            passed,
            says,
        });
    }
    store.confirm_repairs(run, &proven)?;
    Ok(proofs)
}
