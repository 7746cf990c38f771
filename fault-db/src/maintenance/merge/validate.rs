//! Validates a file before it is merged: rows outside their columns' domain, runs that do not match their
//! seals, and the rows that depend on either are excluded. Temporary views with the names of the tables
//! hide them from the merge.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::Connection;

use super::valid_rows::{FIRST_INVALID_SEAL, Key, PARENTS, SOURCES, Source, VALID_ROWS};
use crate::backend::{Backend, Field, Row, SqlError, SqlResult, values};
use crate::domain::{PACKED_BYTES, Refusals, check, check_body, shown_id};
use crate::seal::run_digest;

/// Findings.
#[derive(Default)]
struct Examination {
    refusals: Refusals,
    /// Table, key, and the second part of the key.
    rows: BTreeSet<(&'static str, i64, SecondKey)>,
    runs: BTreeMap<i64, String>,
}

/// The second part of a key, if it has one.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
enum SecondKey {
    None,
    Number(i64),
    Bytes(Vec<u8>),
}

/// Checks every row of the other file and hides the invalid ones; runs in a transaction, so that no row is
/// added after it was checked. [`show_all_rows`] undoes it.
pub(super) fn hide_invalid_rows(
    theirs: &Connection,
    their_backend: &Backend,
    ours: &Backend,
) -> SqlResult<Refusals> {
    let mut found = Examination::default();
    for source in &SOURCES {
        found.rows_of(theirs, source)?;
    }
    found.orphans(their_backend)?;
    found.seals(their_backend, ours)?;
    found.name_runs(their_backend)?;
    if !found.refusals.is_empty() {
        found.create_views(theirs)?;
    }
    Ok(found.refusals)
}

/// Undoes [`hide_invalid_rows`].
pub(super) fn show_all_rows(theirs: &Connection) -> SqlResult<()> {
    for (table, _) in VALID_ROWS.iter().rev() {
        theirs.execute_batch(&format!("DROP VIEW IF EXISTS temp.{table}"))?;
    }
    let drop = "DROP TABLE IF EXISTS temp.parted; DROP TABLE IF EXISTS temp.refused";
    Ok(theirs.execute_batch(drop)?)
}

impl Examination {
    /// Checks each row of a table against its columns' domain.
    fn rows_of(&mut self, theirs: &Connection, source: &Source) -> SqlResult<()> {
        let Source { table, key, of } = source;
        let name = match of {
            Key::Row(name) | Key::Run(name) => name,
        };
        let columns: Vec<String> = {
            let all = theirs.prepare(&format!("SELECT * FROM main.{table}"))?;
            all.column_names().into_iter().map(str::to_owned).collect()
        };
        // Oversized values are not even read.
        let is_large: Vec<_> = (columns.iter())
            .map(|column| format!("coalesce(octet_length({column}), 0) > {PACKED_BYTES}"))
            .collect();
        let is_large = is_large.join(" OR ");
        let mut large = theirs.prepare(&format!(
            "SELECT {key}, {name} FROM main.{table} WHERE {is_large}"
        ))?;
        let mut rows = large.query([])?;
        while let Some(row) = rows.next()? {
            let reason = format!("a value has more than {PACKED_BYTES} bytes");
            self.refuse(source, Row::File(row), [0, 1], reason)?;
        }
        let place = |wanted: &str| columns.iter().position(|column| column == wanted);
        let (key, name) = (place(key).unwrap_or(0), place(name).unwrap_or(0));
        let mut all = theirs.prepare(&format!(
            "SELECT * FROM main.{table} WHERE NOT ({is_large})"
        ))?;
        let mut rows = all.query([])?;
        while let Some(row) = rows.next()? {
            let row = Row::File(row);
            let checked = check_row(&columns, row).and_then(|()| match *table {
                "trace" | "channel_set" => check_digest(&columns, row),
                "fault_event" => check_event(&columns, row),
                _ => Ok(()),
            });
            if let Err(reason) = checked {
                self.refuse(source, row, [key, name], reason)?;
            }
        }
        Ok(())
    }

    /// Refuses a row, identified by these columns.
    fn refuse(
        &mut self,
        source: &Source,
        row: Row<'_>,
        [key, name]: [usize; 2],
        reason: String,
    ) -> SqlResult<()> {
        let key = match row.field(key) {
            Ok(Field::Integer(key)) => key,
            _ => -1,
        };
        let (shown, more) = match row.field(name) {
            Ok(Field::Bytes(id)) if matches!(source.table, "fault_alias" | "seal") => {
                (shown_id(id), SecondKey::Bytes(id.to_vec()))
            }
            Ok(Field::Bytes(id)) => (shown_id(id), SecondKey::None),
            Ok(Field::Integer(number)) if source.table == "recording" => {
                (number.to_string(), SecondKey::Number(number))
            }
            Ok(Field::Integer(number)) => (number.to_string(), SecondKey::None),
            Ok(Field::Text(text)) => (text.chars().take(40).collect(), SecondKey::None),
            _ => ("without a name".to_owned(), SecondKey::None),
        };
        let table = source.table;
        match source.of {
            Key::Run(_) => {
                let reason = format!("{} {shown}: {reason}", table.replace('_', " "));
                self.runs.entry(key).or_insert(reason);
            }
            Key::Row(_) if table == "run" => {
                self.runs.insert(key, reason);
            }
            Key::Row(_) => {
                self.rows.insert((table, key, more));
                self.refusals
                    .add(format!("{} {shown}", table.replace('_', " ")), reason);
            }
        }
        Ok(())
    }

    /// Rows whose parent does not exist.
    fn orphans(&mut self, theirs: &Backend) -> SqlResult<()> {
        for (table, column, parent) in PARENTS {
            let sql = format!(
                "SELECT count(*) FROM {table} WHERE {column} NOT IN (SELECT seq FROM {parent})"
            );
            let count = theirs
                .first(&sql, &[], |row| row.get::<i64>(0))?
                .unwrap_or(0);
            if count > 0 {
                let what = format!("{count} rows of {}", table.replace('_', " "));
                self.refusals
                    .add(what, format!("the {parent} they are of is not there"));
            }
        }
        // A sealed run is refused as a whole.
        for sql in [
            "SELECT DISTINCT run FROM measurement m WHERE NOT EXISTS
                (SELECT 1 FROM step s WHERE s.run = m.run AND s.step_index = m.step_index)",
            "SELECT DISTINCT run FROM fault_occurrence WHERE fault NOT IN (SELECT seq FROM fault)",
        ] {
            for run in theirs.select(sql, &[], |row| row.get::<i64>(0))? {
                let reason = "a step or fault it speaks of is not there".to_owned();
                self.runs.entry(run).or_insert(reason);
            }
        }
        Ok(())
    }

    /// Checks runs against their seals, except those finished here, which are compared later.
    fn seals(&mut self, theirs: &Backend, ours: &Backend) -> SqlResult<()> {
        let all = theirs.select("SELECT seq, id, verdict IS NOT NULL FROM run", &[], |row| {
            Ok((
                row.get::<i64>(0)?,
                row.get::<Vec<u8>>(1)?,
                row.get::<i64>(2)? != 0,
            ))
        })?;
        for (run, id, is_over) in all {
            if self.runs.contains_key(&run) {
                continue;
            }
            let known = "SELECT verdict IS NOT NULL FROM run WHERE id = ?1";
            let known = ours.first(known, &values![&id[..]], |row| Ok(row.get::<i64>(0)? != 0))?;
            if known == Some(true) || (known.is_some() && is_unwritten_remainder(theirs, run)?) {
                continue;
            }
            if let Some(reason) = seal_mismatch(theirs, run, is_over)? {
                self.runs.insert(run, reason);
            }
        }
        Ok(())
    }

    /// Lists each refused run once, by its id.
    fn name_runs(&mut self, theirs: &Backend) -> SqlResult<()> {
        for (run, reason) in &self.runs {
            let id = "SELECT id FROM run WHERE seq = ?1";
            let id = theirs.first(id, &values![*run], |row| row.get::<Vec<u8>>(0));
            let shown = match id {
                Ok(Some(id)) => shown_id(&id),
                Ok(None) | Err(SqlError::Value { .. }) => "that is not there".to_owned(),
                Err(error) => return Err(error),
            };
            self.refusals.add(format!("run {shown}"), reason.clone());
        }
        Ok(())
    }

    fn create_views(&self, theirs: &Connection) -> SqlResult<()> {
        theirs.execute_batch(
            "CREATE TEMP TABLE refused(what TEXT NOT NULL, key INTEGER NOT NULL, more ANY);
             CREATE INDEX temp.refused_by_key ON refused(what, key)",
        )?;
        let mut insert = theirs.prepare("INSERT INTO temp.refused VALUES (?1, ?2, ?3)")?;
        for run in self.runs.keys() {
            insert.execute(rusqlite::params!["run", run, None::<i64>])?;
        }
        for (table, key, more) in &self.rows {
            match more {
                SecondKey::None => insert.execute(rusqlite::params![table, key, None::<i64>])?,
                SecondKey::Number(more) => insert.execute(rusqlite::params![table, key, more])?,
                SecondKey::Bytes(more) => insert.execute(rusqlite::params![table, key, more])?,
            };
        }
        for (table, left) in VALID_ROWS {
            if table == "seal" {
                theirs.execute_batch(FIRST_INVALID_SEAL)?;
            }
            let all = theirs.prepare(&format!("SELECT * FROM main.{table}"))?;
            let columns: Vec<_> = (all.column_names().into_iter())
                .map(|column| match (table, column) {
                    // An occurrence does not refer to a refused trace.
                    ("fault_occurrence", "trace") => {
                        "CASE WHEN trace IN (SELECT seq FROM trace) THEN trace END AS trace"
                    }
                    _ => column,
                })
                .collect();
            let columns = columns.join(", ");
            theirs.execute_batch(&format!(
                "CREATE TEMP VIEW {table} AS SELECT {columns} FROM main.{table} AS {table} WHERE {left}"
            ))?;
        }
        Ok(())
    }
}

/// Checks each field of a row against its column's domain.
fn check_row(columns: &[String], row: Row<'_>) -> Result<(), String> {
    for (place, column) in columns.iter().enumerate() {
        match row.field(place) {
            Ok(field) => check(column, field)?,
            Err(SqlError::Value { reason, .. }) => return Err(format!("{column}: {reason}")),
            Err(_) => return Err(format!("{column} cannot be read")),
        }
    }
    Ok(())
}

/// Checks content against its checksum.
fn check_digest(columns: &[String], row: Row<'_>) -> Result<(), String> {
    use sha2::{Digest as _, Sha256};
    let field = |wanted: &str| {
        let place = columns.iter().position(|column| column == wanted);
        place.and_then(|place| row.field(place).ok())
    };
    let content = match (field("data"), field("json")) {
        (Some(Field::Bytes(data)), _) => data,
        (_, Some(Field::Text(json))) => json.as_bytes(),
        _ => return Ok(()),
    };
    match field("sha256") {
        Some(Field::Bytes(sha256)) if Sha256::digest(content)[..] == *sha256 => Ok(()),
        _ => Err("it does not match its checksum".to_owned()),
    }
}

fn check_event(columns: &[String], row: Row<'_>) -> Result<(), String> {
    let text = |wanted: &str| {
        let place = columns.iter().position(|column| column == wanted);
        match place.and_then(|place| row.field(place).ok()) {
            Some(Field::Text(text)) => text,
            _ => "",
        }
    };
    check_body(text("kind"), text("body"))
}

/// Whether a run is only the remainder that a busy file could not take: ended without a seal, and not passed.
/// Such a run is sealed as found in the file where it began.
fn is_unwritten_remainder(theirs: &Backend, run: i64) -> SqlResult<bool> {
    let rest =
        "SELECT 1 FROM run r WHERE r.seq = ?1 AND r.verdict IN ('error', 'failed', 'aborted')
         AND NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = r.id AND s.what = 'run')";
    Ok(theirs.first(rest, &values![run], |_| Ok(()))?.is_some())
}

/// How a run differs from its seals, if it does.
fn seal_mismatch(theirs: &Backend, run: i64, is_over: bool) -> SqlResult<Option<String>> {
    let sealed = theirs.select(
        "SELECT s.covers, s.says, s.digest FROM run r JOIN seal s ON s.id = r.id AND s.what = 'run'
         WHERE r.seq = ?1",
        &values![run],
        |row| {
            let (covers, payload, digest) = (row.get(0)?, row.get(1)?, row.get(2)?);
            Ok::<(i64, String, Vec<u8>), _>((covers, payload, digest))
        },
    )?;
    Ok(match (is_over, sealed.is_empty()) {
        (false, true) => None,
        (false, false) => {
            Some("it has a seal and no verdict: the verdict was taken away".to_owned())
        }
        (true, true) => Some("it has a verdict and no seal: the seal was taken away".to_owned()),
        (true, false) => {
            let mut fits = true;
            for (covers, payload, digest) in sealed {
                fits &= run_digest(theirs, run, covers, &payload)? == digest[..];
            }
            (!fits).then(|| "it was changed after it was sealed".to_owned())
        }
    })
}
