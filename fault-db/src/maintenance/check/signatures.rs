//! Checks signatures against the seals that they sign, and tells whose they are.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::backend::{Backend, SqlResult, values};
use crate::id::Id;
use crate::seal::hex;
use crate::signature::{Signed, Statement};

/// What one key has signed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct KeyUse {
    /// The public key.
    pub key: String,
    /// Who it says to be.
    pub who: String,
    /// Whose key it is: of a technician or a bench.
    pub kind: String,
    /// Runs that it signed.
    pub runs: u32,
    /// Events of faults, notes and instruments that it signed.
    pub others: u32,
    /// The first time, and the last.
    pub first_at_us: i64,
    /// The last time.
    pub last_at_us: i64,
}

/// Uses by public key and name: the same key under another name is another one.
#[derive(Default)]
pub(super) struct KeyUses(BTreeMap<(String, String), KeyUse>);

impl KeyUses {
    pub fn add(&mut self, statement: &Statement) {
        let Statement { key, who, .. } = statement;
        let at_us = statement.at_us;
        let name = (key.clone(), who.clone());
        let uses = self.0.entry(name).or_insert_with(|| KeyUse {
            key: key.clone(),
            who: who.clone(),
            kind: statement.kind.clone(),
            runs: 0,
            others: 0,
            first_at_us: at_us,
            last_at_us: at_us,
        });
        match statement.what == "run" {
            true => uses.runs += 1,
            false => uses.others += 1,
        }
        uses.first_at_us = uses.first_at_us.min(at_us);
        uses.last_at_us = uses.last_at_us.max(at_us);
    }

    pub fn into_list(self) -> Vec<KeyUse> {
        self.0.into_values().collect()
    }
}

/// Reads a signature, and holds it against the seal that it signs; what is wrong with it.
pub(super) fn read_signature(
    backend: &Backend,
    text: &str,
) -> SqlResult<Result<Statement, String>> {
    let signed = match Signed::read(text) {
        Ok(signed) => signed,
        Err(error) => return Ok(Err(error.to_string())),
    };
    let Some(statement) = Statement::of(&signed) else {
        return Ok(Err("it is no statement about a seal".to_owned()));
    };
    let wrong = seal_mismatch(backend, &statement)?;
    Ok(wrong.map_or(Ok(statement), Err))
}

/// How the seal that a signature names differs from it.
fn seal_mismatch(backend: &Backend, statement: &Statement) -> SqlResult<Option<String>> {
    let (Ok(id), Ok(file)) = (statement.id.parse::<Id>(), statement.file.parse::<Id>()) else {
        return Ok(Some("it names no seal".to_owned()));
    };
    let sql = "SELECT what, id, digest, hash FROM seal WHERE origin = ?1 AND ordinal = ?2";
    let sealed = backend.first(sql, &values![file, statement.entry], |row| {
        let same = row.get::<String>(0)? == statement.what
            && row.get::<Id>(1)? == id
            && hex(row.get(2)?) == statement.digest
            && hex(row.get(3)?) == statement.seal;
        Ok(same)
    })?;
    if sealed == Some(true) {
        return Ok(None);
    }
    // In a copy that was given a name of its own the same content is sealed again.
    let sql = "SELECT digest FROM seal WHERE id = ?1 AND what = ?2";
    let again = backend.select(sql, &values![id, &statement.what], |row| {
        Ok(hex(row.get(0)?))
    })?;
    let (what, entry) = (&statement.what, statement.entry);
    let file = file.short();
    Ok(match (sealed, again.contains(&statement.digest)) {
        (None, true) => None,
        (None, false) if again.is_empty() => Some(format!("the seal of {what} {id} was taken out")),
        _ => Some(format!(
            "the seal of {what} {id}, entry {entry} of file {file}, is not the one that was signed"
        )),
    })
}
