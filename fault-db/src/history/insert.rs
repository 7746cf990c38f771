//! Inserts the rows of a run; the caller holds the transaction.

use std::borrow::Cow;

use crate::backend::{Backend, SqlResult, Value, values};
use crate::history::fault_event::{NewEvent, insert_event};
use crate::history::graph_sql::standing;
use crate::history::limits;
use crate::id::Id;
use crate::seal;
use crate::seal::run::{measurement_fields, step_fields};
use crate::values::fault_state::{FaultAction, FaultState};
use crate::values::record::{FaultRecord, RunRecord, StepRecord};

/// The result of storing a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultStored {
    /// The fault of the occurrence.
    pub fault: Id,
    /// The stored occurrence.
    pub occurrence: Id,
    /// Whether the occurrence is the first of its fault.
    pub is_new: bool,
    /// Whether the occurrence reopened a fault that counted as repaired.
    pub reopened: bool,
}

/// Inserts a run and its scripts; `fields` as [`run_fields`](seal::run::run_fields) gives them. Returns the row numbers
/// of the run and of its unit.
pub(crate) fn insert_run(
    file: &Backend,
    record: &RunRecord,
    fields: &[Value<'_>; 20],
) -> SqlResult<(i64, i64)> {
    let unit = file.insert(
        "INSERT INTO unit(serial, kind, config_name, sw_versions) VALUES (?1, ?2, ?3, ?4)
         ON CONFLICT(serial) DO UPDATE SET kind = excluded.kind,
            config_name = excluded.config_name, sw_versions = excluded.sw_versions
         RETURNING seq",
        &fields[1..5],
    )?;
    let mut fields = fields.clone();
    fields[1] = unit.into();
    let run = file.insert(
        "INSERT INTO run(id, unit, unit_kind, unit_config_name, sw_versions, line, train, seed,
            operator, source, connection, symptom, continues, started_at_us, app_version,
            scripts_sha256, unit_config_sha256, injected, evidence, owner)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18,
            ?19, ?20)
         RETURNING seq",
        &fields,
    )?;
    for script in &record.scripts {
        file.execute(
            "INSERT OR REPLACE INTO run_script(run, path, sha256) VALUES (?1, ?2, ?3)",
            &values![run, &script.path, &script.sha256],
        )?;
    }
    Ok((run, unit))
}

pub(crate) fn insert_steps(file: &Backend, run: i64, steps: &[StepRecord]) -> SqlResult<()> {
    fn of_run<const N: usize>(run: i64, fields: [Value<'_>; N]) -> Vec<Value<'_>> {
        [run.into()].into_iter().chain(fields).collect()
    }
    for step in steps {
        file.execute(
            "INSERT INTO step(run, step_index, procedure, kind, place, name, turn, turns, verdict, started_bench_us,
                bench_time_us, message, findings, script_line, limit_source)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15)",
            &of_run(run, step_fields(step)),
        )?;
        for measurement in measurement_fields(step) {
            file.execute(
                "INSERT INTO measurement(run, step_index, ordinal, name, value, unit, low, high, verdict,
                    limit_source)
                 VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)",
                &of_run(run, measurement),
            )?;
        }
    }
    Ok(())
}

/// Ids for all rows that one fault may add; unused ones are discarded.
#[derive(Clone, Copy)]
pub(crate) struct FaultIds {
    pub fault: Id,
    pub occurrence: Id,
    pub event: Id,
}

/// The run that saw a fault.
pub(crate) struct FaultPlace<'a> {
    pub run: i64,
    pub unit: i64,
    pub line: &'a str,
    /// Whether the run is an imported log, whose faults occurred earlier.
    pub of_log: bool,
    /// Row number of the last event in the file when the run began.
    pub known_events: i64,
}

pub(crate) fn insert_fault(
    backend: &Backend,
    place: &FaultPlace<'_>,
    ids: FaultIds,
    record: &FaultRecord,
) -> SqlResult<(FaultStored, [u8; 32])> {
    let cut;
    let record = match limits::cut(&record.message) {
        Cow::Borrowed(_) => record,
        Cow::Owned(message) => {
            cut = FaultRecord {
                message,
                ..record.clone()
            };
            &cut
        }
    };
    let known = backend.first(
        "SELECT seq, id, state FROM fault
         WHERE unit = ?1 AND code = ?2 AND lru = ?3 AND state <> 'closed'
         ORDER BY seq DESC LIMIT 1",
        &values![place.unit, record.code, &record.lru],
        |row| {
            Ok((
                row.get::<i64>(0)?,
                row.get::<Id>(1)?,
                row.get::<FaultState>(2)?,
            ))
        },
    )?;
    let (fault, id, before) = match known {
        Some((seq, id, state)) => (seq, id, Some(state)),
        None => (
            open_fault(backend, place, ids.fault, record)?,
            ids.fault,
            None,
        ),
    };
    // An occurrence has a transition from every state but closed, and no closed fault was selected.
    let after = match before {
        None => FaultState::Open,
        // The occurrence was read from a log later: the events since then took it into account.
        Some(state) if acted_since(backend, fault, place, record.at_us)? => state,
        Some(state) => state.next(FaultAction::Occur).unwrap_or(FaultState::Open),
    };
    let digest = insert_occurrence(backend, fault, place, ids.occurrence, record)?;
    backend.execute(
        "UPDATE fault SET occurrences = occurrences + 1, state = ?2, severity = ?3,
            code_name = ?4, line = CASE WHEN ?5 < first_at_us THEN ?6 ELSE line END,
            first_at_us = min(first_at_us, ?5), last_at_us = max(last_at_us, ?5)
         WHERE seq = ?1",
        &values![
            fault,
            after,
            &record.severity,
            &record.code_name,
            record.at_us,
            place.line
        ],
    )?;
    let reopened = before.is_some_and(|state| state != after);
    if before.is_none() || reopened {
        let kind = if reopened {
            FaultAction::Occur.event_kind()
        } else {
            "opened"
        };
        let (at_us, body) = (record.at_us, &record.message);
        let event = NewEvent {
            id: ids.event,
            kind,
            at_us,
            who: "",
            body,
            state: Some(after),
        };
        insert_event(backend, fault, &event)?;
    }
    let stored = FaultStored {
        fault: id,
        occurrence: ids.occurrence,
        is_new: before.is_none(),
        reopened,
    };
    Ok((stored, digest))
}

/// Whether an event changed the fault's state after time `at_us`. Events known when a run began precede everything that
/// the run sees, whatever time stamps other laptops gave them.
fn acted_since(
    backend: &Backend,
    fault: i64,
    place: &FaultPlace<'_>,
    at_us: i64,
) -> SqlResult<bool> {
    backend.has(
        concat!(
            "SELECT 1 FROM fault_event e
             WHERE e.fault = ?1 AND e.state IS NOT NULL AND e.at_us > ?2 AND e.kind NOT IN ('opened', 'recurred')
                AND e.seq > ?3",
            standing!("e"),
            " LIMIT 1"
        ),
        &values![fault, at_us, if place.of_log { 0 } else { place.known_events }],
    )
}

fn open_fault(
    backend: &Backend,
    place: &FaultPlace<'_>,
    id: Id,
    record: &FaultRecord,
) -> SqlResult<i64> {
    backend.insert(
        "INSERT INTO fault(id, unit, code, code_name, lru, severity, state, first_at_us,
            last_at_us, occurrences, line)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, 'open', ?7, ?7, 0, ?8)
         RETURNING seq",
        &values![
            id,
            place.unit,
            record.code,
            &record.code_name,
            &record.lru,
            &record.severity,
            record.at_us,
            place.line
        ],
    )
}

fn insert_occurrence(
    backend: &Backend,
    fault: i64,
    place: &FaultPlace<'_>,
    id: Id,
    record: &FaultRecord,
) -> SqlResult<[u8; 32]> {
    // Text and numbers only: cannot fail.
    let freeze = serde_json::to_string(&record.freeze).unwrap_or_default();
    let payload = values![
        id,
        record.step_index,
        record.at_us,
        record.bench_us,
        &record.message,
        record.findings.as_ref(),
        freeze,
        record.code,
        &record.lru,
        place.line,
        &record.code_name,
        &record.severity,
    ];
    let digest = seal::run::occurrence(&payload);
    let mut row = Vec::from(payload);
    row.extend(values![fault, place.run, place.unit]);
    backend.execute(
        "INSERT INTO fault_occurrence(id, step_index, at_us, bench_us, message, findings, freeze_json, code,
            lru, line, code_name, severity, fault, run, unit)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15)",
        &row,
    )?;
    Ok(digest)
}
