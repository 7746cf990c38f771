//! Runs: the list, and one with its steps, measurements and faults.

use std::collections::BTreeMap;

use serde::Serialize;

use super::faults::json;
use super::filter::{Conditions, limit};
use crate::backend::{Row, SqlResult, from_row, values};
use crate::error::StoreError;
use crate::history::run_notes::RunNote;
use crate::history::verify::{SETTLED, SettledFault, made_by};
use crate::id::Id;
use crate::seal::{RunSealed, sealed_as};
use crate::signature::{Statement, signatures_of};
use crate::store::Store;
use crate::values::fault_state::FaultState;
use crate::values::record::{MeasurementRecord, ScriptRecord, StepRecord, Verdict};
use crate::values::step_counts::{COUNTS_OF_RUN, StepCounts, counts_of_text};
use crate::values::text_enum::text_enum;

text_enum! {
    /// Whether a run is finished.
    RunState {
        /// The writer of the run is alive.
        Running = "running",
        /// The writer of the run died before the verdict.
        Interrupted = "interrupted",
        /// The run has a verdict.
        Finished = "finished",
    }
}

/// Selects runs; `None` does not restrict.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunFilter {
    /// Serial number of the unit.
    pub unit: Option<String>,
    /// Name of the line.
    pub line: Option<String>,
    /// Verdict.
    pub verdict: Option<Verdict>,
    /// Name of the tester.
    pub operator: Option<String>,
    /// Started at this time or later, µs since 1970.
    pub since_us: Option<i64>,
    /// Started before this time, µs since 1970.
    pub until_us: Option<i64>,
    /// Greatest number of runs in a list.
    pub limit: Option<u32>,
}

/// A run in a list.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunSummary {
    /// The run.
    pub id: Id,
    /// Serial number of its unit.
    pub unit_serial: String,
    /// Kind of the unit.
    pub unit_kind: String,
    /// Name of the unit's configuration, as last seen.
    pub unit_config_name: String,
    /// Line data used.
    pub line: String,
    /// The train the unit was in; empty if not given.
    pub train: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Name of the tester.
    pub operator: String,
    /// Place of the unit: `sim`, `serial:…`, `tcp:…`.
    pub source: String,
    /// When it began.
    pub started_at_us: i64,
    /// When it ended.
    pub finished_at_us: Option<i64>,
    /// Verdict; `None` before the end of the run.
    pub verdict: Option<Verdict>,
    /// Whether the run is finished.
    pub state: RunState,
    /// Duration on the bench's clock.
    pub bench_time_us: Option<i64>,
    /// Duration on the wall clock.
    pub wall_time_us: Option<i64>,
    /// Version of the program that ran it.
    pub app_version: String,
    /// SHA-256 over the run's scripts, in hex.
    pub scripts_sha256: String,
    /// SHA-256 of the unit configuration.
    pub unit_config_sha256: String,
    /// Faults injected on purpose.
    pub injected: Option<String>,
    /// The earlier run whose unfinished procedures this run ran.
    pub continues: Option<Id>,
    /// Connection to the unit: `harness`, or `ptu` for the maintenance port alone; `None` if no tester led the run.
    pub connection: Option<String>,
    /// Symptom reported with the unit: a name of `symptoms.toml`.
    pub symptom: Option<String>,
    /// What the bench, its clock and its instruments were: JSON that the caller defines.
    pub evidence: Option<String>,
    /// Counts of the steps with a result in this run; how many were due, `evidence` may say.
    pub recorded: StepCounts,
    /// Number of distinct faults seen.
    pub faults: u32,
}

/// A run with its steps, faults and notes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunDetail {
    /// The run.
    pub run: RunSummary,
    /// The procedure files it used.
    pub scripts: Vec<ScriptRecord>,
    /// Steps in order.
    pub steps: Vec<StepRecord>,
    /// The faults seen in it, in order of their first occurrence.
    pub faults: Vec<RunFault>,
    /// The faults whose repair the run has proved.
    pub settled: Vec<SettledFault>,
    /// Notes on it, oldest first.
    pub notes: Vec<RunNote>,
    /// Seal of the run; `None` before its end.
    pub seal: Option<RunSealed>,
    /// Signature of the run, if valid; whether the key can be trusted is not checked.
    pub signature: Option<Statement>,
}

/// A fault as seen by one run: counts and times are those of the run alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunFault {
    /// The fault.
    pub id: Id,
    /// Code of the fault.
    pub code: i64,
    /// Name of the code.
    pub code_name: String,
    /// The part that the fault points at.
    pub lru: String,
    /// The part that the fault comes from, if a diagnosis or a person has attributed it.
    pub cause: Option<String>,
    /// Severity.
    pub severity: String,
    /// Present state of the fault.
    pub state: FaultState,
    /// First seen in this run.
    pub first_at_us: i64,
    /// Last seen in this run.
    pub last_at_us: i64,
    /// First seen in this run, on the bench's clock.
    pub first_bench_us: i64,
    /// Occurrences in this run.
    pub occurrences: u32,
    /// First trace of the fault in this run.
    pub trace_id: Option<Id>,
}

impl Store {
    /// Lists runs, newest first.
    pub fn runs(&self, filter: &RunFilter) -> Result<Vec<RunSummary>, StoreError> {
        let mut conditions = Conditions::default();
        conditions.add("u.serial = ?", filter.unit.clone());
        conditions.add("r.line = ?", filter.line.clone());
        conditions.add("r.verdict = ?", filter.verdict);
        conditions.add("r.operator = ?", filter.operator.clone());
        conditions.add("r.started_at_us >= ?", filter.since_us);
        conditions.add("r.started_at_us < ?", filter.until_us);
        let order = "ORDER BY r.started_at_us DESC, r.seq DESC";
        let limit = limit(filter.limit);
        let sql = format!("{} {} {order} {limit}", select_runs(), conditions.sql());
        self.select("listing runs", &sql, conditions.values(), |row| {
            self.summary(row)
        })
    }

    /// One run with its steps, measurements, faults and notes.
    pub fn run(&self, id: Id) -> Result<RunDetail, StoreError> {
        const DOING: &str = "reading a run";
        let select = format!("{} WHERE r.id = ?1", select_runs());
        let row = |row: Row<'_>| Ok((self.summary(row)?, row.get::<i64>(19)?));
        let found = self.first(DOING, &select, &values![id], row)?;
        let (run, seq) = found.ok_or_else(|| StoreError::not_found("run", id))?;
        self.ask(DOING, |backend| {
            let signed = signatures_of(backend, id)?;
            let mut notes = self.run_notes(seq)?;
            for note in &mut notes {
                let of_note = signed.iter().find(|(_, of)| of.is_about("note", note.id));
                note.signed_by = of_note.map(|(_, of)| of.who.clone());
            }
            Ok(RunDetail {
                run,
                scripts: self.scripts(seq)?,
                steps: self.steps(seq)?,
                faults: self.run_faults(seq)?,
                settled: self.settled_by(id)?,
                notes,
                seal: sealed_as(backend, id)?,
                signature: (signed.into_iter())
                    .find_map(|(_, of)| of.is_about("run", id).then_some(of)),
            })
        })
    }

    fn settled_by(&self, run: Id) -> SqlResult<Vec<SettledFault>> {
        self.backend
            .select(SETTLED, &values![run, made_by(run)], |row| {
                let has_repair = row.get::<Option<&str>>(4)?.is_some();
                Ok(from_row!(row => SettledFault:
                    id, code, code_name, lru;
                    repair: has_repair.then(|| json(row, 4)).transpose()?
                ))
            })
    }

    fn scripts(&self, run: i64) -> SqlResult<Vec<ScriptRecord>> {
        let sql = "SELECT path, sha256 FROM run_script WHERE run = ?1 ORDER BY path";
        self.backend.select(sql, &values![run], |row| {
            Ok(from_row!(row => ScriptRecord: path, sha256))
        })
    }

    fn steps(&self, run: i64) -> SqlResult<Vec<StepRecord>> {
        let mut measurements = self.measurements(run)?;
        self.backend.select(
            "SELECT step_index, procedure, kind, place, name, turn, turns, verdict, started_bench_us,
                bench_time_us, message, findings, script_line, limit_source FROM step WHERE run = ?1 ORDER BY step_index",
            &values![run],
            |row| {
                let index = row.get(0)?;
                Ok(from_row!(row => StepRecord:
                    _, procedure, kind, place, name, turn, turns, verdict, started_bench_us,
                    bench_time_us, message, findings, script_line, limit_source;
                    index,
                    measurements: measurements.remove(&index).unwrap_or_default()
                ))
            },
        )
    }

    fn measurements(&self, run: i64) -> SqlResult<BTreeMap<u32, Vec<MeasurementRecord>>> {
        let mut by_step = BTreeMap::<u32, Vec<MeasurementRecord>>::new();
        self.backend.each(
            "SELECT step_index, name, value, unit, low, high, verdict, limit_source FROM measurement
             WHERE run = ?1 ORDER BY step_index, ordinal",
            &values![run],
            |row| {
                by_step
                    .entry(row.get(0)?)
                    .or_default()
                    .push(from_row!(row => MeasurementRecord:
                        _, name, value, unit, low, high, verdict, limit_source
                    ));
                Ok(())
            },
        )?;
        Ok(by_step)
    }

    fn run_faults(&self, run: i64) -> SqlResult<Vec<RunFault>> {
        self.backend.select(
            "SELECT f.id, f.code, f.code_name, f.lru, f.severity, f.state, min(o.at_us),
                max(o.at_us), min(o.bench_us), count(*),
                (SELECT t.id FROM fault_occurrence p JOIN trace t ON t.seq = p.trace
                 WHERE p.run = ?1 AND p.fault = f.seq ORDER BY p.seq LIMIT 1),
                f.cause
             FROM fault_occurrence o JOIN fault f ON f.seq = o.fault
             WHERE o.run = ?1 GROUP BY f.seq ORDER BY min(o.bench_us), min(o.seq)",
            &values![run],
            |row| {
                Ok(from_row!(row => RunFault:
                    id, code, code_name, lru, severity, state, first_at_us, last_at_us,
                    first_bench_us, occurrences, trace_id, cause
                ))
            },
        )
    }

    fn summary(&self, row: Row<'_>) -> SqlResult<RunSummary> {
        let verdict: Option<Verdict> = row.get(10)?;
        let state = match verdict {
            Some(_) => RunState::Finished,
            None if self.is_under_way(row.get(0)?) => RunState::Running,
            None => RunState::Interrupted,
        };
        Ok(from_row!(row => RunSummary:
            id, unit_serial, unit_kind, unit_config_name, line, _, operator, source,
            started_at_us, finished_at_us, _, _, bench_time_us, wall_time_us, app_version,
            scripts_sha256, unit_config_sha256, injected, _, _, faults, train, continues,
            connection, symptom, evidence;
            seed: row.get::<i64>(5)?.cast_unsigned(),
            verdict,
            state,
            recorded: counts_of_text(row.get(18)?)
        ))
    }
}

/// The SQL that selects the columns which [`Store::summary`] reads.
fn select_runs() -> String {
    format!(
        "SELECT r.id, u.serial, u.kind, u.config_name, r.line, r.seed, r.operator, r.source,
            r.started_at_us, r.finished_at_us, r.verdict, r.owner, r.bench_time_us, r.wall_time_us,
            r.app_version, r.scripts_sha256, r.unit_config_sha256, r.injected,
            ({COUNTS_OF_RUN}), r.seq,
            (SELECT count(DISTINCT o.fault) FROM fault_occurrence o WHERE o.run = r.seq),
            r.train, r.continues, r.connection, r.symptom, r.evidence
        FROM run r JOIN unit u ON u.seq = r.unit"
    )
}
