//! The rows a run adds, inside a transaction the caller holds.

use rusqlite::{Connection, OptionalExtension, params};

use crate::fault_log::{NewEvent, insert_event};
use crate::fault_state::{FaultAction, FaultState};
use crate::id::Id;
use crate::record::{FaultRecord, MeasurementRecord, RunRecord, StepRecord, UnitRecord};
use crate::run_writer::FaultStored;

pub(crate) fn insert_run(
    conn: &Connection,
    id: Id,
    record: &RunRecord,
) -> rusqlite::Result<(i64, i64)> {
    let unit = upsert_unit(conn, &record.unit)?;
    conn.prepare_cached(
        "INSERT INTO run(id, unit, line, seed, operator, source, started_at_us, app_version,
            scripts_sha256, unit_config_sha256, injected, owner)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12)",
    )?
    .execute(params![
        id,
        unit,
        record.line,
        record.seed.cast_signed(),
        record.operator,
        record.source,
        record.started_at_us,
        record.app_version,
        record.scripts_sha256,
        record.unit_config_sha256,
        record.injected,
        record.owner,
    ])?;
    let run = conn.last_insert_rowid();
    let mut insert = conn.prepare_cached(
        "INSERT OR REPLACE INTO run_script(run, path, sha256) VALUES (?1, ?2, ?3)",
    )?;
    for script in &record.scripts {
        insert.execute(params![run, script.path, script.sha256])?;
    }
    Ok((run, unit))
}

fn upsert_unit(conn: &Connection, unit: &UnitRecord) -> rusqlite::Result<i64> {
    let versions = json(&unit.sw_versions)?;
    conn.prepare_cached(
        "INSERT INTO unit(serial, kind, config_name, sw_versions) VALUES (?1, ?2, ?3, ?4)
         ON CONFLICT(serial) DO UPDATE SET kind = excluded.kind,
            config_name = excluded.config_name, sw_versions = excluded.sw_versions
         RETURNING seq",
    )?
    .query_row(
        params![unit.serial, unit.kind, unit.config_name, versions],
        |row| row.get(0),
    )
}

pub(crate) fn insert_steps(
    conn: &Connection,
    run: i64,
    steps: &[StepRecord],
) -> rusqlite::Result<()> {
    let mut insert = conn.prepare_cached(
        "INSERT INTO step(run, step_index, procedure, name, verdict, started_bench_us,
            bench_time_us, message, script_line) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)",
    )?;
    for step in steps {
        insert.execute(params![
            run,
            step.index,
            step.procedure,
            step.name,
            step.verdict,
            step.started_bench_us,
            step.bench_time_us,
            step.message,
            step.script_line,
        ])?;
        insert_measurements(conn, run, step.index, &step.measurements)?;
    }
    Ok(())
}

fn insert_measurements(
    conn: &Connection,
    run: i64,
    step_index: u32,
    measurements: &[MeasurementRecord],
) -> rusqlite::Result<()> {
    if measurements.is_empty() {
        return Ok(());
    }
    let mut insert = conn.prepare_cached(
        "INSERT INTO measurement(run, step_index, ordinal, name, value, unit, low, high, verdict)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)",
    )?;
    for (ordinal, m) in measurements.iter().enumerate() {
        let values = params![
            run, step_index, ordinal, m.name, m.value, m.unit, m.low, m.high, m.verdict
        ];
        insert.execute(values)?;
    }
    Ok(())
}

/// Identities for all that one fault may add; those not needed are never seen.
#[derive(Clone, Copy)]
pub(crate) struct FaultIds {
    pub fault: Id,
    pub occurrence: Id,
    pub event: Id,
}

pub(crate) fn insert_fault(
    conn: &Connection,
    run: i64,
    unit: i64,
    ids: FaultIds,
    record: &FaultRecord,
) -> rusqlite::Result<FaultStored> {
    let known = conn
        .prepare_cached(
            "SELECT seq, id, state FROM fault
             WHERE unit = ?1 AND code = ?2 AND lru = ?3 AND state <> 'closed'
             ORDER BY seq DESC LIMIT 1",
        )?
        .query_row(params![unit, record.code, record.lru], |row| {
            Ok((
                row.get::<_, i64>(0)?,
                row.get::<_, Id>(1)?,
                row.get::<_, FaultState>(2)?,
            ))
        })
        .optional()?;
    let (fault, id, before) = match known {
        Some((seq, id, state)) => (seq, id, Some(state)),
        None => (open_fault(conn, unit, ids.fault, record)?, ids.fault, None),
    };
    // Every state but closed has an answer to a new occurrence, and closed was not asked for.
    let after = match before {
        None => FaultState::Open,
        // Out of a log that was read late: what was done since was done about that, too.
        Some(state) if acted_since(conn, fault, record.at_us)? => state,
        Some(state) => state.next(FaultAction::Occur).unwrap_or(FaultState::Open),
    };
    insert_occurrence(conn, fault, run, ids.occurrence, record)?;
    conn.prepare_cached(
        "UPDATE fault SET occurrences = occurrences + 1, state = ?2, severity = ?3,
            code_name = ?4, first_at_us = min(first_at_us, ?5), last_at_us = max(last_at_us, ?5)
         WHERE seq = ?1",
    )?
    .execute(params![
        fault,
        after,
        record.severity,
        record.code_name,
        record.at_us
    ])?;
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
        insert_event(conn, fault, &event)?;
    }
    Ok(FaultStored {
        fault: id,
        occurrence: ids.occurrence,
        is_new: before.is_none(),
        reopened,
    })
}

/// Somebody brought the fault to another state after this time.
fn acted_since(conn: &Connection, fault: i64, at_us: i64) -> rusqlite::Result<bool> {
    conn.prepare_cached(
        "SELECT EXISTS (SELECT 1 FROM fault_event
         WHERE fault = ?1 AND state IS NOT NULL AND at_us > ?2 AND kind NOT IN ('opened', 'recurred'))",
    )?
    .query_row(params![fault, at_us], |row| row.get(0))
}

fn open_fault(conn: &Connection, unit: i64, id: Id, record: &FaultRecord) -> rusqlite::Result<i64> {
    conn.prepare_cached(
        "INSERT INTO fault(id, unit, code, code_name, lru, severity, state, first_at_us,
            last_at_us, occurrences) VALUES (?1, ?2, ?3, ?4, ?5, ?6, 'open', ?7, ?7, 0)",
    )?
    .execute(params![
        id,
        unit,
        record.code,
        record.code_name,
        record.lru,
        record.severity,
        record.at_us
    ])?;
    Ok(conn.last_insert_rowid())
}

fn insert_occurrence(
    conn: &Connection,
    fault: i64,
    run: i64,
    id: Id,
    record: &FaultRecord,
) -> rusqlite::Result<()> {
    conn.prepare_cached(
        "INSERT INTO fault_occurrence(id, fault, run, step_index, at_us, bench_us, message,
            freeze_json) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
    )?
    .execute(params![
        id,
        fault,
        run,
        record.step_index,
        record.at_us,
        record.bench_us,
        record.message,
        json(&record.freeze)?,
    ])?;
    Ok(())
}

fn json(value: &impl serde::Serialize) -> rusqlite::Result<String> {
    serde_json::to_string(value)
        .map_err(|error| rusqlite::Error::ToSqlConversionFailure(Box::new(error)))
}
