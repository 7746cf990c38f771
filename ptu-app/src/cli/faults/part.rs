//! Names of parts that a person types: a misspelt name would be counted as another part.

use fault_db::Store;

use crate::cli::ScriptsOption;
use ptu_report::words::{Words, fill};
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::{Asked, Failure, did_you_mean};
use ptu_runs::stdio;

/// The part with the name `asked`, in the spelling of the catalogue.
///
/// # Errors
/// Neither the catalogue of the scripts nor a fault in this history has the part.
pub fn named(store: &Store, scripts: &ScriptsOption, asked: &str) -> Result<String, Failure> {
    let known = known(store, scripts)?;
    spelling(&known, asked).ok_or_else(|| {
        let hint = did_you_mean(asked, known.iter().map(String::as_str));
        Failure::usage(Asked::NoPartHere(asked.to_string(), hint))
    })
}

/// Name of a part that the catalogue lacks, as typed; if the catalogue has the name, the part in the catalogue's
/// spelling. A name close to a part of the catalogue is accepted, with a note.
///
/// # Errors
/// The name is blank, or the database cannot be read.
pub fn other(store: &Store, scripts: &ScriptsOption, asked: &str) -> Result<String, Failure> {
    if asked.trim().is_empty() {
        return Err(Failure::usage(Asked::OtherPartUnnamed));
    }
    let known = known(store, scripts)?;
    if let Some(part) = spelling(&known, asked) {
        return Ok(part);
    }
    let hint = did_you_mean(asked, known.iter().map(String::as_str));
    if hint.0.is_some() {
        let of = [("part", &asked as _), ("near", &hint as _)];
        stdio::note(&fill(Words::shown().terminal.other_part, &of));
    }
    Ok(asked.trim().to_owned())
}

/// The parts of the catalogue, and the parts named by faults of this history.
fn known(store: &Store, scripts: &ScriptsOption) -> Result<Vec<String>, Failure> {
    // If the scripts cannot be read, only the history's faults name parts.
    let catalogue = scripts.find().and_then(|directory| parts_of(&directory));
    let mut known = catalogue.unwrap_or_default();
    for part in store.known_lrus()? {
        if spelling(&known, &part).is_none() {
            known.push(part);
        }
    }
    Ok(known)
}

fn parts_of(directory: &ScriptsDirectory) -> Result<Vec<String>, Failure> {
    let parts = directory.faults()?.lrus;
    Ok(parts.iter().map(|lru| lru.id.to_string()).collect())
}

fn spelling(known: &[String], asked: &str) -> Option<String> {
    let asked = asked.trim().to_lowercase();
    let found = known.iter().find(|part| part.to_lowercase() == asked);
    found.cloned()
}
