//! The stream of a run as JSON lines, for other programs: `docs/commands.md`.
//!
//! `docs/events.schema.json` promises what each line holds. A key is never given another meaning and never left out
//! within a version; new keys and new events may come, and a reader passes over those that it does not know.

use btu_rig::procedure::{
    EventSource, Finding, Findings, Measurement, Procedure, ResultKind, RunEvent, StepResult,
    UnitEvent,
};
use protocol::lru;
use serde_json::{Map, Value, json};

use ptu_runs::run::{Outcome, SessionEvent};

/// Version of the stream.
pub const VERSION: u32 = 1;

/// The schema of a line (JSON Schema 2020-12), as programs find it in `docs/` and in recordings.
pub const SCHEMA: &str = include_str!("../../../docs/events.schema.json");

/// Turns events into lines.
#[derive(Debug, Default)]
pub struct EventLines {
    seq: u64,
}

impl EventLines {
    pub fn started(&mut self) -> String {
        self.line(
            None,
            "stream_started",
            json!({ "version": VERSION, "app_version": env!("CARGO_PKG_VERSION") }),
        )
    }

    /// The line of an event; rows have none.
    pub fn event(&mut self, procedure: &Procedure, event: &SessionEvent) -> Option<String> {
        let (name, keys) = match event {
            SessionEvent::Run(event) => of_runner(event),
            SessionEvent::Fault(fault) => (
                "fault",
                json!({
                    "at_us": fault.at.as_us(), "code": fault.code, "name": fault.name,
                    "part": fault.lru.as_ref().map(|part| lru::stored(Some(part))),
                    "severity": fault.severity.label(), "step": fault.step,
                    "message": fault.finding.to_string(), "findings": Findings::from(fault.finding.clone()),
                    "freeze": fault.freeze,
                }),
            ),
            SessionEvent::Trace(trace) => (
                "trace",
                json!({
                    "faults": trace.faults, "rows": trace.rows.len(),
                    "trigger_row": trace.trigger_row, "partial": trace.partial,
                    "began_us": trace.rows.first().map(|row| row.at.as_us()),
                }),
            ),
            SessionEvent::Rows(_) => return None,
            SessionEvent::Recording(recording) => {
                ("recording", json!({ "began_us": recording.began.as_us() }))
            }
            SessionEvent::LinkLost(why) => {
                let findings = Findings::from(Finding::LinkLost { why: why.clone() });
                (
                    match why.is_of_the_bench() {
                        true => "bench_failed",
                        false => "link_lost",
                    },
                    json!({ "reason": why.to_string(), "findings": findings }),
                )
            }
            SessionEvent::Ended { bench_time } => {
                ("ended", json!({ "bench_time_us": bench_time.as_us() }))
            }
        };
        Some(self.line(Some(&procedure.id), name, keys))
    }

    pub fn finished(&mut self, outcome: &Outcome) -> String {
        let counts = &outcome.counts;
        let keys = json!({
            "run": outcome.id.to_string(), "verdict": outcome.verdict.label(),
            "bench_time_us": outcome.bench_time.as_us(), "exit": outcome.exit.code(),
            "steps": counts.planned, "run_steps": counts.run(), "passed": counts.passed, "failed": counts.failed,
            "error": counts.error, "not_run": counts.not_run(), "attempts": counts.attempts,
            "outside": counts.outside,
        });
        self.line(None, "run_finished", keys)
    }

    fn line(&mut self, procedure: Option<&str>, event: &str, keys: Value) -> String {
        let mut line = Map::new();
        line.insert("seq".into(), json!(self.seq));
        line.insert("event".into(), json!(event));
        line.insert("procedure".into(), json!(procedure));
        if let Value::Object(keys) = keys {
            line.extend(keys);
        }
        self.seq += 1;
        Value::Object(line).to_string()
    }
}

fn of_runner(event: &RunEvent) -> (&'static str, Value) {
    match event {
        RunEvent::ProcedureStarted { steps, at } => (
            "procedure_started",
            json!({ "at_us": at.as_us(), "steps": steps }),
        ),
        RunEvent::StepStarted {
            index,
            name,
            turn,
            turns,
            at,
        } => (
            "step_started",
            json!({ "at_us": at.as_us(), "index": index, "name": name, "turn": turn, "turns": turns }),
        ),
        RunEvent::Paused { next, at } => ("paused", json!({ "at_us": at.as_us(), "next": next })),
        RunEvent::Waiting { action, left } => (
            "waiting",
            json!({ "what": action.to_string(), "left_us": left.as_us() }),
        ),
        RunEvent::Prompt { text, left } => {
            ("prompt", json!({ "text": text, "left_us": left.as_us() }))
        }
        RunEvent::Measured { index, measurement } => ("measured", measured(*index, measurement)),
        RunEvent::StepFinished(result) => ("step_finished", of_step(result)),
        RunEvent::UnsolicitedEvent(event) => ("unsolicited_event", of_log(event)),
        RunEvent::UnsolicitedBrake { at } => ("unsolicited_brake", json!({ "at_us": at.as_us() })),
        RunEvent::UnitClockWrong { by_permille, at } => (
            "unit_clock_wrong",
            json!({ "at_us": at.as_us(), "by_permille": by_permille }),
        ),
        RunEvent::OutsideStep(outside) => (
            "outside_step",
            json!({
                "at_us": outside.at.as_us(), "place": outside.place.name(),
                "verdict": outside.verdict.label(), "message": outside.finding.to_string(),
                "findings": Findings::from(outside.finding.clone()),
            }),
        ),
        RunEvent::ProcedureFinished {
            verdict,
            findings,
            at,
        } => (
            "procedure_finished",
            json!({ "at_us": at.as_us(), "verdict": verdict.label(), "message": findings.to_string(), "findings": findings }),
        ),
    }
}

fn measured(index: usize, measurement: &Measurement) -> Value {
    json!({
        "index": index, "name": measurement.name, "value": measurement.value,
        "unit": measurement.unit, "low": measurement.low, "high": measurement.high,
        "limit_source": measurement.limit_source, "verdict": measurement.verdict.label(),
    })
}

fn of_step(result: &StepResult) -> Value {
    json!({
        "index": result.index, "name": result.name, "turn": result.turn, "turns": result.turns,
        "verdict": result.verdict.label(), "message": result.findings.to_string(), "findings": result.findings,
        "repeated": result.kind == ResultKind::Attempt, "again": result.kind == ResultKind::Again,
        "suspect": result.suspect.as_ref().map(|part| lru::stored(Some(part))),
        "started_us": result.started.as_us(), "bench_time_us": result.bench_time.as_us(),
        "script_line": result.line,
    })
}

fn of_log(event: &UnitEvent) -> Value {
    let source = match event.source {
        EventSource::Unit => "unit",
        EventSource::Tcms => "tcms",
    };
    json!({
        "source": source, "code": event.code, "parameter": event.parameter, "unit_ms": event.at_ms,
    })
}
