//! Records one run while it happens.
//!
//! The run's row is on the disk before [`RunWriter::begin`] returns, so that a killed program
//! leaves an interrupted run, not none. A fault is on the disk before [`RunWriter::fault`]
//! returns. Steps wait in memory and go out many at a time, in short transactions: one commit
//! costs milliseconds, and a transaction held open would lock out every other run on the file.

use rusqlite::{Connection, OptionalExtension, params};

use crate::error::StoreError;
use crate::fault_log::{NewEvent, insert_event};
use crate::fault_state::{FaultAction, FaultState};
use crate::id::Id;
use crate::record::{FaultRecord, MeasurementRecord, RunEnd, RunRecord, StepRecord, UnitRecord};
use crate::store::Store;
use crate::trace::TraceData;

/// Steps go out on their own when this many wait.
const FLUSH_AT_STEPS: usize = 256;

/// When writing keeps failing, no more than this many steps are kept for a later try.
const MAX_WAITING_STEPS: usize = 16_384;

/// The writing end of one run. Several may write to one store, and to one file.
///
/// Dropping it writes the waiting steps if it can; without [`finish`](Self::finish) the run then
/// counts as interrupted.
pub struct RunWriter<'a> {
    store: &'a Store,
    id: Id,
    run: i64,
    unit: i64,
    waiting: Vec<StepRecord>,
    last_index: Option<u32>,
    finished: bool,
}

/// What became of a fault that was handed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultStored {
    /// The fault it belongs to.
    pub fault: Id,
    /// This occurrence of it.
    pub occurrence: Id,
    /// It is the first of its fault.
    pub is_new: bool,
    /// The fault was thought repaired, and is open again.
    pub reopened: bool,
}

impl<'a> RunWriter<'a> {
    /// Begins a run and commits it.
    pub fn begin(store: &'a Store, record: &RunRecord) -> Result<Self, StoreError> {
        const DOING: &str = "beginning a run";
        let id = store.mint()?;
        let (run, unit) = store.write(DOING, |conn| {
            insert_run(conn, id, record).map_err(|error| store.failed(DOING, error))
        })?;
        let waiting = Vec::with_capacity(FLUSH_AT_STEPS);
        Ok(Self {
            store,
            id,
            run,
            unit,
            waiting,
            last_index: None,
            finished: false,
        })
    }

    /// The run's id.
    pub fn id(&self) -> Id {
        self.id
    }

    /// Steps recorded but not yet in the file.
    pub fn waiting_steps(&self) -> usize {
        self.waiting.len()
    }

    /// Records a step that is over. It reaches the file with the next flush, fault or finish.
    ///
    /// After an error from writing the step still waits, and goes out when writing works again.
    pub fn step(&mut self, step: StepRecord) -> Result<(), StoreError> {
        self.check_unfinished()?;
        if let Some(last) = self.last_index.filter(|last| step.index <= *last) {
            return Err(StoreError::StepOrder {
                index: step.index,
                last,
            });
        }
        if self.waiting.len() >= MAX_WAITING_STEPS {
            let path = self.store.path().to_path_buf();
            return Err(StoreError::StepsWaiting {
                path,
                waiting: self.waiting.len(),
            });
        }
        self.last_index = Some(step.index);
        self.waiting.push(step);
        if self.waiting.len() >= FLUSH_AT_STEPS {
            self.flush()
        } else {
            Ok(())
        }
    }

    /// Commits the waiting steps.
    pub fn flush(&mut self) -> Result<(), StoreError> {
        const DOING: &str = "storing steps";
        if self.waiting.is_empty() {
            return Ok(());
        }
        let (store, run, waiting) = (self.store, self.run, &self.waiting);
        store.write(DOING, |conn| {
            insert_steps(conn, run, waiting).map_err(|error| store.failed(DOING, error))
        })?;
        self.waiting.clear();
        Ok(())
    }

    /// Commits an occurrence of a fault, with its freeze frame, and the waiting steps.
    ///
    /// It joins the fault of the same unit, code and part that is not closed; if there is none, it
    /// begins one. A fault that was repaired or verified is open again.
    pub fn fault(&mut self, record: &FaultRecord) -> Result<FaultStored, StoreError> {
        const DOING: &str = "storing a fault";
        self.check_unfinished()?;
        let (store, run, unit, waiting) = (self.store, self.run, self.unit, &self.waiting);
        let ids = FaultIds {
            fault: store.mint()?,
            occurrence: store.mint()?,
            event: store.mint()?,
        };
        let stored = store.write(DOING, |conn| {
            let work = || {
                insert_steps(conn, run, waiting)?;
                insert_fault(conn, run, unit, ids, record)
            };
            work().map_err(|error| store.failed(DOING, error))
        })?;
        self.waiting.clear();
        Ok(stored)
    }

    /// Commits a trace and hangs it on occurrences of this store; none is allowed too.
    pub fn trace(&mut self, occurrences: &[Id], trace: &TraceData) -> Result<Id, StoreError> {
        self.check_unfinished()?;
        self.store.insert_trace(self.run, occurrences, trace)
    }

    /// Commits the waiting steps and the verdict. After an error it may be tried again.
    pub fn finish(&mut self, end: &RunEnd) -> Result<(), StoreError> {
        const DOING: &str = "finishing a run";
        const SQL: &str = "UPDATE run SET verdict = ?2, finished_at_us = ?3, bench_time_us = ?4,
            wall_time_us = ?5 WHERE seq = ?1";
        self.check_unfinished()?;
        let (store, run, waiting) = (self.store, self.run, &self.waiting);
        store.write(DOING, |conn| {
            let work = || {
                insert_steps(conn, run, waiting)?;
                let RunEnd {
                    verdict,
                    finished_at_us,
                    bench_time_us,
                    wall_time_us,
                } = end;
                let values = params![run, verdict, finished_at_us, bench_time_us, wall_time_us];
                conn.prepare_cached(SQL)?.execute(values)
            };
            work().map_err(|error| store.failed(DOING, error))
        })?;
        self.waiting.clear();
        self.finished = true;
        Ok(())
    }

    fn check_unfinished(&self) -> Result<(), StoreError> {
        if self.finished {
            Err(StoreError::RunFinished { run: self.id })
        } else {
            Ok(())
        }
    }
}

impl Drop for RunWriter<'_> {
    fn drop(&mut self) {
        // The caller is already on its way out with an error of its own, which says more.
        let _ = self.flush();
    }
}

fn insert_run(conn: &Connection, id: Id, record: &RunRecord) -> rusqlite::Result<(i64, i64)> {
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

fn insert_steps(conn: &Connection, run: i64, steps: &[StepRecord]) -> rusqlite::Result<()> {
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
struct FaultIds {
    fault: Id,
    occurrence: Id,
    event: Id,
}

fn insert_fault(
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
    let after = before.map_or(FaultState::Open, |state| {
        state.next(FaultAction::Occur).unwrap_or(FaultState::Open)
    });
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
