//! A case as data: the same content as its sheet.

use serde_json::{Value, json};

use super::{CaseSheet, Standing};
use crate::json::{fault_json, run_summary_json, value_json};
use crate::words::Language;
use ptu_runs::clock::rfc3339;

/// A case: its number, the standing of its repair, the repair, both runs, and each failure before and after.
pub fn case_json(case: &CaseSheet) -> Value {
    let words = Language::English.words();
    let fault = &case.fault.fault;
    let all = std::iter::once(fault).chain(&case.fault.case);
    let vouched = match &case.standing {
        Standing::Vouched(who, at_us, why) => {
            json!({ "who": who, "at": rfc3339(*at_us), "why": why })
        }
        _ => Value::Null,
    };
    let run = |sheet: &crate::run::Sheet| run_summary_json(&sheet.run.run);
    json!({
        "document": case.number(),
        "repair_is": case.standing.name(),
        "vouched_by": vouched,
        "simulated": case.is_practice(),
        "depot": case.depot,
        "unit_serial": fault.unit_serial,
        "part": case.part(),
        "symptom": case.symptom.as_ref().map(|symptom| &symptom.id),
        "found_by": case.found_by(words),
        "repair": case.repair.as_ref().map(|repair| json!({
            "part": repair.record.part,
            "serial_old": repair.record.serial_old,
            "serial_new": repair.record.serial_new,
            "note": repair.record.note,
            "who": repair.who,
            "at": rfc3339(repair.at_us),
        })),
        "run_before": run(&case.before),
        "run_after": case.after.as_ref().map(run),
        "passed_runs": case.passed.iter().map(|run| run.to_string()).collect::<Vec<_>>(),
        "compared": case.compared().iter().map(|one| json!({
            "procedure": one.step().map(|step| &step.procedure),
            "step": one.step().map(|step| &step.name),
            "message": one.step().map(|step| &step.message),
            "measurement": one.before.map(|before| &before.name),
            "unit": one.before.map(|before| &before.unit),
            "before": one.before.map(value_json),
            "after": one.after.map(value_json),
            "verdict_after": one.verdict_after().map(|verdict| verdict.as_str()),
        })).collect::<Vec<_>>(),
        "conclusion": case.before.diagnosis.as_ref().ok()
            .map(|answer| Language::English.words().concluded(answer)),
        "faults": all.map(fault_json).collect::<Vec<_>>(),
    })
}
