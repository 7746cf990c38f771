//! Values of the program as columns of the database, and back. `fault-db` names no other crate, so that its
//! verdict is a type of its own; parts and severities are text there, since a database may hold those of another
//! program.

use btu_rig::procedure::plan::Connection;
use btu_rig::procedure::{
    Findings, Measurement, Outside, OutsideStep, Procedure, ResultKind, StepResult, Verdict,
};
use fault_db::{FaultRecord, MeasurementRecord, RunRecord, StepKind, StepRecord, UnitRecord};
use protocol::lru;

use crate::platform;
use crate::run::FaultSeen;

/// Folder of the departure tests.
pub const DEPARTURE: &str = "departure/";

/// Record of a run that this process makes of a unit with this configuration, begun at `started_at_us`, µs UTC;
/// `source` says where the unit is, or what was read or repeated in its place.
pub(crate) fn new_run(
    serial: String,
    config_name: String,
    source: String,
    started_at_us: i64,
) -> RunRecord {
    RunRecord {
        unit: UnitRecord {
            serial,
            kind: "atc".into(),
            config_name,
            ..UnitRecord::default()
        },
        source,
        started_at_us,
        app_version: env!("CARGO_PKG_VERSION").into(),
        owner: platform::this_process(),
        line: String::new(),
        train: String::new(),
        seed: 0,
        operator: String::new(),
        connection: None,
        symptom: None,
        evidence: None,
        scripts_sha256: String::new(),
        unit_config_sha256: String::new(),
        injected: None,
        scripts: Vec::new(),
        continues: None,
    }
}

/// A verdict as the database stores it.
pub fn stored(verdict: Verdict) -> fault_db::Verdict {
    match verdict {
        Verdict::Passed => fault_db::Verdict::Passed,
        Verdict::Failed => fault_db::Verdict::Failed,
        Verdict::Error => fault_db::Verdict::Error,
        Verdict::Skipped => fault_db::Verdict::Skipped,
        Verdict::Inconclusive => fault_db::Verdict::Inconclusive,
        Verdict::Aborted => fault_db::Verdict::Aborted,
    }
}

/// A verdict that the database stores.
pub fn from_stored(verdict: fault_db::Verdict) -> Verdict {
    match verdict {
        fault_db::Verdict::Passed => Verdict::Passed,
        fault_db::Verdict::Failed => Verdict::Failed,
        fault_db::Verdict::Error => Verdict::Error,
        fault_db::Verdict::Skipped => Verdict::Skipped,
        fault_db::Verdict::Inconclusive => Verdict::Inconclusive,
        fault_db::Verdict::Aborted => Verdict::Aborted,
    }
}

/// A step of a procedure as the database stores it, begun at `started_bench_us` on the bench's clock. The caller sets
/// its index in the run.
pub fn step_record(procedure: &str, result: StepResult, started_bench_us: i64) -> StepRecord {
    StepRecord {
        index: 0,
        procedure: procedure.to_owned(),
        kind: kind(result.kind),
        place: Some(result.index as u32),
        name: result.name,
        turn: result.turn,
        turns: result.turns,
        verdict: stored(result.verdict),
        started_bench_us,
        bench_time_us: result.bench_time.as_us() as i64,
        message: result.findings.to_string(),
        findings: result.findings.to_json(),
        script_line: Some(result.line),
        limit_source: result.limit_source,
        measurements: result.measurements.into_iter().flat_map(records).collect(),
    }
}

/// A measurement as it is stored: the uncertainty, if there is one, is stored as another measurement.
fn records(measured: Measurement) -> impl Iterator<Item = MeasurementRecord> {
    let verdict = stored(measured.verdict);
    let unit = String::from(measured.unit);
    let uncertainty = measured.uncertainty.map(|uncertainty| MeasurementRecord {
        name: uncertainty_of(&measured.name),
        value: Some(uncertainty),
        unit: unit.clone(),
        low: None,
        high: None,
        limit_source: None,
        verdict: stored(Verdict::Passed),
    });
    let value = MeasurementRecord {
        name: measured.name,
        value: measured.value,
        unit,
        low: measured.low,
        high: measured.high,
        limit_source: measured.limit_source,
        verdict,
    };
    std::iter::once(value).chain(uncertainty)
}

/// Name under which the uncertainty of a measurement is stored.
pub fn uncertainty_of(name: &str) -> String {
    format!("{name}, uncertainty")
}

/// An occurrence of a fault as the database stores it, dated `at_us` (UTC), at `bench_us` on the bench's clock.
pub fn fault_record(
    fault: FaultSeen,
    at_us: i64,
    bench_us: i64,
    step_index: Option<u32>,
) -> FaultRecord {
    FaultRecord {
        code: i64::from(fault.code),
        code_name: fault.name,
        lru: lru::stored(fault.lru.as_ref()).into(),
        severity: fault.severity.label().into(),
        at_us,
        bench_us,
        step_index,
        message: fault.finding.to_string(),
        findings: Findings::from(fault.finding).to_json(),
        freeze: fault.freeze,
    }
}

/// Findings of a stored column; empty where the column is empty or of another version.
pub fn findings(stored: &Option<String>) -> Findings {
    let read = stored.as_deref().and_then(Findings::from_json);
    read.unwrap_or_default()
}

/// Id of the procedure in entries about the run as a whole.
pub const WHOLE_RUN: &str = "run";

/// Stand-in for the run as a whole among its procedures: it has no steps.
pub fn whole_run() -> Procedure {
    Procedure {
        id: WHOLE_RUN.to_owned(),
        title: String::new(),
        title_ko: None,
        needs: Connection::Ptu,
        on_request: false,
        lacks: None,
        suspect: None,
        path: String::new(),
        sha256: String::new(),
        setup: Vec::new(),
        cleanup: Vec::new(),
        steps: Vec::new(),
        slots: 0,
    }
}

/// Kind of a record among the steps of a run, in a word: `step`, `attempt`, or the place of a failure outside
/// steps.
pub fn kind_of(step: &StepRecord) -> &'static str {
    outside_of(step).map_or(step.kind.as_str(), Outside::name)
}

/// Record of a failure outside the steps of a procedure. It is stored among the steps, without a line of a script,
/// so that their readers find it.
pub fn outside_record(procedure: &str, entry: &OutsideStep, bench_us: i64) -> StepRecord {
    StepRecord {
        kind: StepKind::Outside,
        place: None,
        verdict: stored(entry.verdict),
        started_bench_us: bench_us,
        message: entry.finding.to_string(),
        findings: Findings::from(entry.finding.clone()).to_json(),
        ..StepRecord::passed(0, procedure, entry.place.name())
    }
}

/// Stored form of a result's kind.
pub fn kind(kind: ResultKind) -> StepKind {
    match kind {
        ResultKind::Step => StepKind::Step,
        ResultKind::Attempt => StepKind::Attempt,
        ResultKind::Again => StepKind::Again,
    }
}

/// Place of a failure outside steps; `None` for the record of a step.
pub fn outside_of(step: &StepRecord) -> Option<Outside> {
    let is_outside = step.kind == StepKind::Outside;
    is_outside.then(|| Outside::from_name(&step.name).unwrap_or(Outside::Whole))
}

/// The verdict of a procedure by its records, in a run with the verdict `run`. If the run is an error, an error of the
/// procedure counts before a failure; in any other run a check that failed counts before one that could not be made.
pub fn of_procedure<'a>(
    records: impl Iterator<Item = &'a StepRecord> + Clone,
    run: Option<fault_db::Verdict>,
) -> fault_db::Verdict {
    use fault_db::Verdict::{Aborted, Error, Failed, Passed, Skipped};
    let order = match run {
        Some(Error) => [Aborted, Error, Failed, Passed],
        _ => [Aborted, Failed, Error, Passed],
    };
    let is_there = |verdict: &fault_db::Verdict| records.clone().any(|r| r.verdict == *verdict);
    order.into_iter().find(is_there).unwrap_or(Skipped)
}

/// Records by procedure, in the order in which each was run first: an adaptive run does one more than once.
pub fn by_procedure(steps: &[StepRecord]) -> Vec<(&str, Vec<&StepRecord>)> {
    let mut all: Vec<(&str, Vec<&StepRecord>)> = Vec::new();
    for step in steps {
        match all
            .iter_mut()
            .find(|(procedure, _)| *procedure == step.procedure)
        {
            Some((_, records)) => records.push(step),
            None => all.push((&step.procedure, vec![step])),
        }
    }
    all
}

/// Results of steps that count: without attempts that were made again.
pub fn standing(steps: &[StepRecord]) -> impl Iterator<Item = &StepRecord> {
    steps.iter().filter(|step| step.kind != StepKind::Attempt)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_verdict_is_stored_and_read_back_by_the_same_word() {
        for verdict in Verdict::ALL {
            assert_eq!(from_stored(stored(verdict)), verdict);
            assert_eq!(stored(verdict).as_str(), verdict.label());
        }
        for verdict in fault_db::Verdict::ALL {
            assert_eq!(stored(from_stored(*verdict)), *verdict);
        }
    }
}
