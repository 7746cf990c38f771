//! Whether a run that passed proves the repairs made before it.

use diagnosis::{Model, Observation, Proof};
use fault_db::{Id, Store};

use super::answer::comparable;
use super::dictionary::choose;
use super::history::OwnHistory;
use super::settings;
use crate::data::ScriptsDirectory;
use crate::failure::Failure;
use crate::process_id;
use crate::run::of_run;

/// What a run that passed says of the repair of a fault.
#[derive(Clone, Debug, PartialEq)]
pub struct RepairProof {
    /// The fault.
    pub fault: Id,
    /// Its name.
    pub code_name: String,
    /// Runs that passed since the repair, this one among them.
    pub passed: usize,
    /// What they say.
    pub says: Proof,
    /// The repair is proven, and the fault verified.
    pub is_proven: bool,
}

/// Holds a run that passed against the repairs that its unit's faults had before, and verifies those that it proves: a unit
/// that still has the fault would pass with a probability of at most `hidden_fault`.
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
    let connection = super::answer::connection_of(&store.run(run, &process_id::is_alive)?);
    let dictionary = choose(Some(store), directory, connection)?.dictionary;
    let history = OwnHistory::default();
    let model = Model::new(&dictionary, &settings, &history.factors);
    let seen = |run: &Id| -> Result<Observation, Failure> {
        let detail = store.run(*run, &process_id::is_alive)?;
        let seen = of_run(&detail, &store.run_occurrences(*run)?);
        Ok(comparable(&detail, seen, &dictionary, &mut Vec::new()))
    };
    let mut proofs = Vec::new();
    let mut proven = Vec::new();
    for repair in repairs {
        let there: Vec<_> = repair.there.iter().map(seen).collect::<Result<_, _>>()?;
        let passed: Vec<_> = repair.passed.iter().map(seen).collect::<Result<_, _>>()?;
        let Some(says) = Proof::of(&model, &there, &passed, settings.hidden_fault) else {
            continue;
        };
        let is_proven = says.more == Some(0);
        if is_proven {
            let note = format!(
                "in run {run}: with the fault still there {} would have passed in {:.1} of 100 cases",
                if passed.len() == 1 {
                    "it".to_owned()
                } else {
                    format!("{} runs", passed.len())
                },
                100.0 * says.hidden
            );
            proven.push((repair.fault, note));
        }
        proofs.push(RepairProof {
            fault: repair.fault,
            code_name: repair.code_name,
            passed: passed.len(),
            says,
            is_proven,
        });
    }
    store.confirm_repairs(run, &proven)?;
    Ok(proofs)
}
