//! What of another file is not taken: rows that hold what no history holds, runs that do not fit their seals,
//! and what hangs on either. All else of the file is read as if they were not there: views of the same names
//! stand before its tables.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::Connection;

use crate::base::{Base, Field, Row, SqlError, SqlResult, values};
use crate::domain::{PACKED_BYTES, Refusals, check, check_body, shown_id};
use crate::seal::run_digest;

/// A table that is read of another file, and no other is.
struct Source {
    table: &'static str,
    /// Names a row, of this kind.
    key: &'static str,
    of: Key,
}

enum Key {
    /// The row itself.
    Row(&'static str),
    /// Its run, which is refused as a whole: it is sealed.
    Run(&'static str),
}

const SOURCES: [Source; 14] = [
    source("unit", "seq", Key::Row("serial")),
    source("run", "seq", Key::Row("id")),
    source("run_script", "run", Key::Run("path")),
    source("step", "run", Key::Run("step_index")),
    source("measurement", "run", Key::Run("step_index")),
    source("fault_occurrence", "run", Key::Run("id")),
    source("recording", "run", Key::Row("ordinal")),
    source("channel_set", "seq", Key::Row("sha256")),
    source("trace", "seq", Key::Row("id")),
    source("fault", "seq", Key::Row("id")),
    source("fault_alias", "fault", Key::Row("id")),
    source("fault_event", "seq", Key::Row("id")),
    source("run_note", "seq", Key::Row("id")),
    source("seal", "ordinal", Key::Row("origin")),
];

const fn source(table: &'static str, key: &'static str, of: Key) -> Source {
    Source { table, key, of }
}

/// Where a row belongs: table, column, the table it is in.
const PARENTS: [(&str, &str, &str); 13] = [
    ("run", "unit", "unit"),
    ("run_script", "run", "run"),
    ("step", "run", "run"),
    ("measurement", "run", "run"),
    ("recording", "run", "run"),
    ("trace", "run", "run"),
    ("trace", "channel_set", "channel_set"),
    ("fault", "unit", "unit"),
    ("fault_alias", "fault", "fault"),
    ("fault_occurrence", "run", "run"),
    ("fault_occurrence", "fault", "fault"),
    ("fault_event", "fault", "fault"),
    ("run_note", "run", "run"),
];

/// What is left of each table: parents before children, which look for theirs among what is left.
const LEFT: [(&str, &str); 14] = [
    ("unit", "seq NOT IN (SELECT key FROM refused WHERE what = 'unit')"),
    (
        "run",
        "seq NOT IN (SELECT key FROM refused WHERE what = 'run') AND unit IN (SELECT seq FROM unit)
            AND seq NOT IN (SELECT run FROM main.fault_occurrence
                WHERE fault IN (SELECT key FROM refused WHERE what = 'fault'))",
    ),
    ("run_script", "run IN (SELECT seq FROM run)"),
    ("step", "run IN (SELECT seq FROM run)"),
    ("measurement", "run IN (SELECT seq FROM run)"),
    (
        "recording",
        "run IN (SELECT seq FROM run)
            AND (run, ordinal) NOT IN (SELECT key, more FROM refused WHERE what = 'recording')",
    ),
    ("channel_set", "seq NOT IN (SELECT key FROM refused WHERE what = 'channel_set')"),
    (
        "trace",
        "seq NOT IN (SELECT key FROM refused WHERE what = 'trace') AND run IN (SELECT seq FROM run)
            AND channel_set IN (SELECT seq FROM channel_set)",
    ),
    // One that was seen in nothing but runs that are refused was not seen.
    (
        "fault",
        "seq NOT IN (SELECT key FROM refused WHERE what = 'fault') AND unit IN (SELECT seq FROM unit)
            AND (seq NOT IN (SELECT fault FROM main.fault_occurrence)
                OR seq IN (SELECT fault FROM main.fault_occurrence WHERE run IN (SELECT seq FROM run)))",
    ),
    (
        "fault_alias",
        "fault IN (SELECT seq FROM fault)
            AND (fault, id) NOT IN (SELECT key, more FROM refused WHERE what = 'fault_alias')",
    ),
    ("fault_occurrence", "run IN (SELECT seq FROM run) AND fault IN (SELECT seq FROM fault)"),
    (
        "fault_event",
        "seq NOT IN (SELECT key FROM refused WHERE what = 'fault_event')
            AND fault IN (SELECT seq FROM fault)",
    ),
    (
        "run_note",
        "seq NOT IN (SELECT key FROM refused WHERE what = 'run_note') AND run IN (SELECT seq FROM run)",
    ),
    (
        "seal",
        "NOT EXISTS (SELECT 1 FROM parted p WHERE p.origin = seal.origin AND p.ordinal <= seal.ordinal)",
    ),
];

/// From the first seal on that is not taken, or whose run, event or note is not, the next would fit nothing here:
/// what comes is then sealed as it is found.
const PARTED: &str = "
    CREATE TEMP TABLE parted AS SELECT origin, min(ordinal) AS ordinal FROM main.seal
    WHERE (ordinal, origin) IN (SELECT key, more FROM refused WHERE what = 'seal')
        OR (what = 'run' AND id IN (SELECT id FROM main.run WHERE seq NOT IN (SELECT seq FROM run)))
        OR (what = 'event' AND id IN
            (SELECT id FROM main.fault_event WHERE seq NOT IN (SELECT seq FROM fault_event)))
        OR (what = 'note' AND id IN
            (SELECT id FROM main.run_note WHERE seq NOT IN (SELECT seq FROM run_note)))
    GROUP BY origin";

/// What was found.
#[derive(Default)]
struct Found {
    refusals: Refusals,
    /// Table, key, and what else names the row.
    rows: BTreeSet<(&'static str, i64, More)>,
    runs: BTreeMap<i64, String>,
}

/// The second half of a key, if it has one.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
enum More {
    None,
    Number(i64),
    Bytes(Vec<u8>),
}

/// Looks at every row of another file, and puts those aside that are not to be taken; runs in a transaction, so
/// that nothing comes after it was looked at. [`take_away`] ends it.
pub(super) fn put_aside(
    theirs: &Connection,
    their_base: &Base,
    ours: &Base,
) -> SqlResult<Refusals> {
    let mut found = Found::default();
    for source in &SOURCES {
        found.rows_of(theirs, source)?;
    }
    found.orphans(their_base)?;
    found.seals(their_base, ours)?;
    found.name_runs(their_base)?;
    if !found.refusals.is_empty() {
        found.stand_before(theirs)?;
    }
    Ok(found.refusals)
}

/// Ends what [`put_aside`] began.
pub(super) fn take_away(theirs: &Connection) -> SqlResult<()> {
    for (table, _) in LEFT.iter().rev() {
        theirs.execute_batch(&format!("DROP VIEW IF EXISTS temp.{table}"))?;
    }
    let drop = "DROP TABLE IF EXISTS temp.parted; DROP TABLE IF EXISTS temp.refused";
    Ok(theirs.execute_batch(drop)?)
}

impl Found {
    /// Holds each row of a table to its columns' domain.
    fn rows_of(&mut self, theirs: &Connection, source: &Source) -> SqlResult<()> {
        let Source { table, key, of } = source;
        let name = match of {
            Key::Row(name) | Key::Run(name) => name,
        };
        let columns: Vec<String> = {
            let all = theirs.prepare(&format!("SELECT * FROM main.{table}"))?;
            all.column_names().into_iter().map(str::to_owned).collect()
        };
        // A value that is too large is not even read.
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

    /// Names a row by its key and its name, in these columns.
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
                (shown_id(id), More::Bytes(id.to_vec()))
            }
            Ok(Field::Bytes(id)) => (shown_id(id), More::None),
            Ok(Field::Integer(number)) if source.table == "recording" => {
                (number.to_string(), More::Number(number))
            }
            Ok(Field::Integer(number)) => (number.to_string(), More::None),
            Ok(Field::Text(text)) => (text.chars().take(40).collect(), More::None),
            _ => ("without a name".to_owned(), More::None),
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

    /// Rows that belong to nothing.
    fn orphans(&mut self, theirs: &Base) -> SqlResult<()> {
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
        // What is sealed is refused as a whole.
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

    /// Runs against their seals, but for those that are over here: these are compared.
    fn seals(&mut self, theirs: &Base, ours: &Base) -> SqlResult<()> {
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
            if known == Some(true) || (known.is_some() && is_rest(theirs, run)?) {
                continue;
            }
            if let Some(reason) = misfit(theirs, run, is_over)? {
                self.runs.insert(run, reason);
            }
        }
        Ok(())
    }

    /// Each refused run once, by its id.
    fn name_runs(&mut self, theirs: &Base) -> SqlResult<()> {
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

    fn stand_before(&self, theirs: &Connection) -> SqlResult<()> {
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
                More::None => insert.execute(rusqlite::params![table, key, None::<i64>])?,
                More::Number(more) => insert.execute(rusqlite::params![table, key, more])?,
                More::Bytes(more) => insert.execute(rusqlite::params![table, key, more])?,
            };
        }
        for (table, left) in LEFT {
            if table == "seal" {
                theirs.execute_batch(PARTED)?;
            }
            let all = theirs.prepare(&format!("SELECT * FROM main.{table}"))?;
            let columns: Vec<_> = (all.column_names().into_iter())
                .map(|column| match (table, column) {
                    // Of a trace that is not taken the occurrence says nothing.
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

/// Each field of a row against its column's domain.
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

/// What has a checksum has to fit it.
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

/// Whether it is what a file that was busy for too long did not take of a run: it ended without a seal, and not
/// by passing. The run is sealed where it was begun, as one that was found.
fn is_rest(theirs: &Base, run: i64) -> SqlResult<bool> {
    let rest =
        "SELECT 1 FROM run r WHERE r.seq = ?1 AND r.verdict IN ('error', 'failed', 'aborted')
         AND NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = r.id AND s.what = 'run')";
    Ok(theirs.first(rest, &values![run], |_| Ok(()))?.is_some())
}

/// Why a run does not fit its seals.
fn misfit(theirs: &Base, run: i64, is_over: bool) -> SqlResult<Option<String>> {
    let sealed = theirs.select(
        "SELECT s.covers, s.says, s.digest FROM run r JOIN seal s ON s.id = r.id AND s.what = 'run'
         WHERE r.seq = ?1",
        &values![run],
        |row| {
            let (covers, says, digest) = (row.get(0)?, row.get(1)?, row.get(2)?);
            Ok::<(i64, String, Vec<u8>), _>((covers, says, digest))
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
            for (covers, says, digest) in sealed {
                fits &= run_digest(theirs, run, covers, &says)? == digest[..];
            }
            (!fits).then(|| "it was changed after it was sealed".to_owned())
        }
    })
}
