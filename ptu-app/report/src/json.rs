//! The JSON shapes of runs and faults.

use std::borrow::Cow;
use std::fmt::Write as _;

use fault_db::{
    FaultSummary, MeasurementRecord, RunDetail, RunFault, RunSummary, Statement, StepRecord,
};
use protocol::display_text;
use serde::Serialize;
use serde_json::{Value, json};

use crate::departure::Departure;
use crate::trace_notes::note_json;
use ptu_runs::clock::rfc3339;
use ptu_runs::coverage::{Coverage, counts_of};
use ptu_runs::failure::{Failure, FileTrouble, Why};
use ptu_runs::run::Evidence;
use ptu_runs::stored::{findings, kind_of};

/// A run with its steps, faults, notes and seal.
pub fn run_json(run: &RunDetail) -> Value {
    let evidence = run.run.evidence.as_deref().and_then(Evidence::of);
    json!({
        "run": run_summary_json(&run.run),
        "coverage": coverage_json(&Coverage::of_run(run)),
        "scripts": run.scripts.iter().map(|script| json!({
            "path": script.path, "sha256": script.sha256,
        })).collect::<Vec<_>>(),
        "steps": run.steps.iter().map(|step| step_json(step, evidence.as_ref())).collect::<Vec<_>>(),
        "faults": run.faults.iter().map(run_fault_json).collect::<Vec<_>>(),
        "settles": run.settled.iter().map(|fault| json!({
            "id": fault.id.to_string(), "code": fault.code, "name": fault.code_name, "part": fault.lru,
            "repair": fault.repair,
        })).collect::<Vec<_>>(),
        "notes": run.notes.iter().map(note_json).collect::<Vec<_>>(),
        "departure": Departure::of(run).map(|departure| departure.json()),
        "seal": run.seal,
        "signature": run.signature.as_ref().map(signature_json),
        "evidence": evidence.as_ref().map(evidence_json),
    })
}

/// Signature of a run: who signed, with which key and when.
pub fn signature_json(signed: &Statement) -> Value {
    json!({
        "who": signed.who, "kind": signed.kind, "key": signed.key, "at": rfc3339(signed.at_us),
        "digest": signed.digest,
    })
}

fn evidence_json(evidence: &Evidence) -> Value {
    let Evidence { bench, clock, .. } = evidence;
    let clock = match (clock.synchronised, clock.uncertainty_ms) {
        (Some(true), Some(ms)) => format!("synchronised, within {ms} ms"),
        (Some(true), None) => "synchronised".to_owned(),
        (Some(false), _) => "not synchronised".to_owned(),
        (None, _) => "not known".to_owned(),
    };
    json!({
        "clock": clock, "line_sha256": bench.line.sha256, "train_sha256": bench.train.sha256,
        "settings": bench.unit_config.settings, "guard_banded": evidence.guard_banded,
        "instruments": evidence.instruments.iter().map(|used| json!({
            "kind": used.of.kind, "serial_no": used.of.serial_no, "calibrated": used.of.calibrated, "by": used.of.by,
            "due": used.of.due, "is_calibrated": used.is_calibrated, "uncertainty": used.of.uncertainty,
        })).collect::<Vec<_>>(),
    })
}

fn coverage_json(coverage: &Coverage) -> Value {
    json!({
        "steps": coverage.steps.planned, "run": coverage.steps.run(), "passed": coverage.steps.passed,
        "need_bench": coverage.need_bench, "on_bench": coverage.on_bench,
    })
}

/// A run in a list.
pub fn run_summary_json(run: &RunSummary) -> Value {
    let counts = counts_of(run);
    json!({
        "id": run.id.to_string(),
        "verdict": run.verdict.map(|verdict| verdict.as_str()),
        "state": run.state.as_str(),
        "unit_serial": run.unit_serial,
        "unit_config": run.unit_config_name,
        "line": run.line,
        "train": run.train,
        "seed": run.seed,
        "source": run.source,
        "connection": run.connection,
        "symptom": run.symptom,
        "operator": run.operator,
        "started_at": rfc3339(run.started_at_us),
        "finished_at": run.finished_at_us.map(rfc3339),
        "bench_time_s": run.bench_time_us.map(seconds),
        "wall_time_s": run.wall_time_us.map(seconds),
        "injected": run.injected,
        "continues": run.continues.map(|earlier| earlier.to_string()),
        "app_version": run.app_version,
        "scripts_sha256": run.scripts_sha256,
        "unit_config_sha256": run.unit_config_sha256,
        "step_count": counts.planned,
        "steps_run": counts.run(),
        "steps_passed": counts.passed,
        "steps_failed": counts.failed,
        "steps_error": counts.error,
        "steps_not_passed": counts.not_passed(),
        "steps_not_run": counts.not_run(),
        "step_attempts": counts.attempts,
        "outside_steps": counts.outside,
        "fault_count": run.faults,
    })
}

fn step_json(step: &StepRecord, evidence: Option<&Evidence>) -> Value {
    json!({
        "procedure": step.procedure,
        "name": step.name,
        "kind": kind_of(step),
        "turn": step.turn,
        "turns": step.turns,
        "verdict": step.verdict.as_str(),
        "bench_time_s": seconds(step.bench_time_us),
        "measurements": step.measurements.iter().map(|one| measurement_json(one, evidence)).collect::<Vec<_>>(),
        "message": step.message,
        "findings": findings(&step.findings),
        "script_line": step.script_line,
        "limit_source": step.limit_source,
    })
}

fn measurement_json(measurement: &MeasurementRecord, evidence: Option<&Evidence>) -> Value {
    let instrument = evidence.and_then(|evidence| evidence.instrument_for(&measurement.unit));
    json!({
        "name": measurement.name,
        "value": measurement.value,
        "unit": measurement.unit,
        "low": measurement.low,
        "high": measurement.high,
        "limit_source": measurement.limit_source,
        "verdict": measurement.verdict.as_str(),
        "instrument": instrument.map(|used| &used.of.serial_no),
    })
}

/// A measured value with its limits and its verdict.
pub(crate) fn value_json(measured: &MeasurementRecord) -> Value {
    json!({
        "value": measured.value, "low": measured.low, "high": measured.high,
        "verdict": measured.verdict.as_str(),
    })
}

fn run_fault_json(fault: &RunFault) -> Value {
    json!({
        "id": fault.id.to_string(),
        "code": fault.code,
        "name": fault.code_name,
        "part": fault.lru,
        "cause": fault.cause.as_ref().unwrap_or(&fault.lru),
        "severity": fault.severity,
        "first_at": rfc3339(fault.first_at_us),
        "last_at": rfc3339(fault.last_at_us),
        "occurrences": fault.occurrences,
        "state": fault.state.as_str(),
        "trace_id": fault.trace_id.map(|id| id.to_string()),
    })
}

/// Keys of a fault in a list, in their order.
pub const FAULT_KEYS: [&str; 12] = [
    "id",
    "unit_serial",
    "code",
    "name",
    "part",
    "cause",
    "severity",
    "state",
    "first_at",
    "last_at",
    "occurrences",
    "trace_id",
];

pub fn fault_json(fault: &FaultSummary) -> Value {
    json!({
        "id": fault.id.to_string(),
        "unit_serial": fault.unit_serial,
        "code": fault.code,
        "name": fault.code_name,
        "part": fault.lru,
        "cause": fault.cause(),
        "severity": fault.severity,
        "state": fault.state.as_str(),
        "first_at": rfc3339(fault.first_at_us),
        "last_at": rfc3339(fault.last_at_us),
        "occurrences": fault.occurrences,
        "trace_id": fault.trace_id.map(|id| id.to_string()),
    })
}

/// A value as one document, indented.
///
/// # Errors
/// JSON cannot express the value.
pub fn json_text(value: &impl Serialize) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::bench(FileTrouble::NotPrinted("JSON", Why::of(error))))?;
    Ok(json_safe(&text).into_owned())
}

/// A JSON document in which every letter that acts on a terminal, or hides, is spelled `\u202e`: whoever
/// reads it has each letter as it was.
pub fn json_safe(text: &str) -> Cow<'_, str> {
    // JSON spells control characters below U+007F already, or they stand between values.
    let is_spelled = |letter: char| letter >= '\u{7f}' && display_text::is_unseen(letter);
    if !text.contains(is_spelled) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len() + 16);
    for letter in text.chars() {
        if is_spelled(letter) {
            for unit in letter.encode_utf16(&mut [0; 2]) {
                // Writing to a text cannot fail.
                let _ = write!(safe, "\\u{unit:04x}");
            }
        } else {
            safe.push(letter);
        }
    }
    Cow::Owned(safe)
}

/// Microseconds as seconds.
fn seconds(us: i64) -> f64 {
    us as f64 / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_in_a_document_are_escaped_reversibly() {
        let text = "\x1b]0;x\x07 \x7f \u{9b}31m \u{202e} \u{e0041} \u{feff} 한 é \"\\ \n";
        let written = json_text(&json!({ text: [text] })).expect("JSON");
        let acts = |letter: char| display_text::is_unseen(letter) && letter != '\n';
        assert!(!written.contains(acts), "{written:?}");
        let read: Value = serde_json::from_str(&written).expect("JSON");
        assert_eq!(read, json!({ text: [text] }));
    }
}
