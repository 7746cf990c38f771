//! Signs what a transaction has sealed, before it is committed.

use super::Signer;
use super::places::Places;
use super::signed::Signed;
use super::statement::{About, SIGNATURE, Statement};
use crate::backend::{Backend, SqlResult, from_row, values};
use crate::id::Id;
use crate::seal::{self, hex};
use crate::values::step_counts::{COUNTS_OF_RUN, counts_of_text};

/// A new entry of the file's own chain.
struct Entry {
    ordinal: i64,
    what: String,
    id: Id,
    payload: String,
    digest: Vec<u8>,
    hash: Vec<u8>,
}

/// Signs the entries of the file's own chain after number `known` that seal a run, event, note or instrument. An entry
/// sealed as found is left out: who imports it does not vouch for it.
pub(crate) fn sign_new_entries(backend: &Backend, signer: &Signer, known: i64) -> SqlResult<()> {
    let Some(file) = seal::own_file_id(backend)? else {
        return Ok(());
    };
    let new = backend.select(
        "SELECT ordinal, what, id, says, digest, hash FROM seal
         WHERE origin = ?1 AND ordinal > ?2 AND what IN ('run', 'event', 'note', 'instrument') ORDER BY ordinal",
        &values![file, known],
        |row| {
            Ok(from_row!(row => Entry: ordinal, what, id, payload, digest, hash))
        },
    )?;
    for entry in new {
        if is_found(&entry.payload) {
            continue;
        }
        let mut statement = Statement {
            version: 1,
            what: entry.what.clone(),
            id: entry.id.to_string(),
            file: file.to_string(),
            entry: entry.ordinal,
            digest: hex(&entry.digest),
            seal: hex(&entry.hash),
            ..Statement::default()
        };
        let group = complete(backend, &entry, &mut statement)?;
        let signed = Signed::new(signer, &statement).text();
        let digest = seal::statement_digest(SIGNATURE, group, &signed);
        seal::append(backend, SIGNATURE, group, &signed, &digest)?;
    }
    Ok(())
}

fn is_found(payload: &str) -> bool {
    let parsed = serde_json::from_str::<serde_json::Value>(payload);
    parsed.is_ok_and(|payload| payload.get("found").is_some_and(|found| !found.is_null()))
}

/// Adds the time, and of a run the summary, to a statement; returns the id under which the signature is stored.
fn complete(backend: &Backend, entry: &Entry, statement: &mut Statement) -> SqlResult<Id> {
    let id = values![entry.id];
    let time_and_group = match &entry.what[..] {
        "run" => {
            about(backend, entry.id, statement)?;
            return Ok(entry.id);
        }
        "event" => {
            "SELECT e.at_us, f.id FROM fault_event e JOIN fault f ON f.seq = e.fault WHERE e.id = ?1"
        }
        "note" => {
            "SELECT n.at_us, r.id FROM run_note n JOIN run r ON r.seq = n.run WHERE n.id = ?1"
        }
        _ => {
            let parsed = serde_json::from_str::<serde_json::Value>(&entry.payload);
            statement.at_us = parsed
                .map(|said| said["at_us"].as_i64().unwrap_or(0))
                .unwrap_or(0);
            return Ok(entry.id);
        }
    };
    let found = backend.first(time_and_group, &id, |row| Ok((row.get(0)?, row.get(1)?)))?;
    let (at_us, group) = found.unwrap_or((0, entry.id));
    statement.at_us = at_us;
    Ok(group)
}

fn about(backend: &Backend, id: Id, statement: &mut Statement) -> SqlResult<()> {
    let select = format!(
        "SELECT r.seq, r.finished_at_us, u.serial, r.verdict, r.operator, r.source, r.line, r.train, r.started_at_us,
            r.app_version, r.injected, ({COUNTS_OF_RUN}), (SELECT count(*) FROM measurement m WHERE m.run = r.seq)
         FROM run r JOIN unit u ON u.seq = r.unit WHERE r.id = ?1"
    );
    let found = backend.first(&select, &values![id], |row| {
        let about = from_row!(row => About:
            _, _, unit, verdict, operator, source, line, train, started_at_us, app_version,
            injected, _, measurements;
            steps: counts_of_text(row.get(11)?).run().into()
        );
        Ok((row.get::<i64>(0)?, row.get::<i64>(1)?, about))
    })?;
    if let Some((run, at_us, about)) = found {
        statement.at_us = at_us;
        statement.about = Some(about);
        statement.places = Some(Places::of(backend, run)?);
    }
    Ok(())
}
