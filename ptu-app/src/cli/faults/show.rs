//! `ptu faults show`: one fault with its occurrences, repairs and notes.

use fault_db::{FaultDetail, FaultEvent, FaultSummary, FreezeSample, Store};
use protocol::display_text::line;
use serde_json::{Value, json};

use crate::cli::Json;
use ptu_report::event_text::{cause_text, correction_text, note_text, repair_text};
use ptu_report::fault_json;
use ptu_report::naming::PartNames;
use ptu_report::words::{Language, Words, fill};
use ptu_runs::clock::{local, rfc3339};
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::table::Table;

/// Shows the fault that an id names. In Korean, parts and signals have their Korean names; in English, the names that
/// commands and scripts use.
pub fn show(store: &Store, id: &str, json: Json, names: &PartNames) -> Result<Exit, Failure> {
    let fault = store.fault(store.resolve_fault(id)?)?;
    json.answer(|| detail_json(&fault), || detail(&fault, names))
}

fn detail_json(detail: &FaultDetail) -> Value {
    let mut value = fault_json(&detail.fault);
    value["case"] = detail.case.iter().map(fault_json).collect();
    value["occurrence_list"] = detail
        .occurrences
        .iter()
        .map(|seen| {
            json!({
                "id": seen.id.to_string(), "run_id": seen.run_id.to_string(),
                "step_index": seen.step_index, "at": rfc3339(seen.at_us),
                "bench_time_s": seen.bench_us as f64 / 1e6, "message": seen.message,
                "trace_id": seen.trace_id.map(|id| id.to_string()), "freeze_frame": seen.freeze,
            })
        })
        .collect();
    value["events"] = detail.events.iter().map(event_json).collect();
    value["withdrawn"] = detail.withdrawn.iter().map(event_json).collect();
    value
}

fn event_json(event: &FaultEvent) -> Value {
    let mut value = json!({
        "kind": event.kind, "at": rfc3339(event.at_us), "who": event.who,
        "note": event.note, "state": event.state.map(|state| state.as_str()),
        "repair": event.repair, "cause": event.cause,
    });
    if let Some(by) = &event.correction {
        value["withdrawn"] = json!({ "at": rfc3339(by.at_us), "who": by.who, "note": by.note });
    }
    value
}

fn detail(detail: &FaultDetail, parts: &PartNames) -> String {
    let words = Words::shown();
    let (common, faults) = (&words.common, &words.faults);
    let part = |id: &str| match words.language {
        Language::English => line(id).into_owned(),
        Language::Korean => line(parts.name(id, words.language)).into_owned(),
    };
    let fault = &detail.fault;
    let mut text = format!(
        "{} {}  {} {}  {}\n{} {}  {} {}  {} {}  {}  {} {}\n",
        common.fault,
        fault.id,
        fault.code,
        line(&fault.code_name),
        line(words.report.severity(&fault.severity)),
        common.unit,
        line(&fault.unit_serial),
        common.part,
        part(&fault.lru),
        faults.cause,
        part(fault.cause()),
        words.fault_state(fault.state),
        faults.seen,
        times(fault, words),
    );
    for other in &detail.case {
        text.push_str(&format!(
            "  {}: {}  {} {}  {} {}  {}\n",
            faults.same_case,
            other.id.short(),
            other.code,
            line(&other.code_name),
            common.part,
            part(&other.lru),
            words.fault_state(other.state),
        ));
    }
    let mut seen_in = Table::headed(&[
        faults.seen_at,
        common.run,
        words.report.trace,
        words.report.what,
    ]);
    for seen in &detail.occurrences {
        seen_in.row([
            local(seen.at_us),
            seen.run_id.short(),
            seen.trace_id.map_or_else(String::new, |id| id.short()),
            words.found(&seen.findings, &seen.message).into_owned(),
        ]);
    }
    let earlier =
        fault.occurrences as usize - detail.occurrences.len().min(fault.occurrences as usize);
    let more = match earlier {
        0 => String::new(),
        n => format!("{}\n", fill(faults.and_earlier, &[("n", &n)])),
    };
    text.push_str(&format!("\n{}\n{more}", seen_in.render()));
    if let Some(last) = detail.occurrences.first() {
        text.push_str(&format!(
            "\n{}\n{}\n",
            faults.freeze,
            freeze_frame(&last.freeze, words)
        ));
    }
    let mut done = Table::headed(&[faults.at, faults.event, faults.who, common.note]);
    for event in detail.history() {
        let repair = event.repair.as_ref();
        let repair = repair.map_or_else(String::new, |repair| repair_text(repair, part));
        let cause = event.cause.as_ref();
        let cause = cause.map_or_else(String::new, |cause| cause_text(cause, part));
        let correction = event.correction.as_ref().map_or_else(String::new, |by| {
            format!(" [{}]", line(&correction_text(by, words)))
        });
        let said = note_text(detail, event, words);
        let note = format!("{said}{repair}{cause}{correction}");
        done.row([
            local(event.at_us),
            words.event_kind(&event.kind).to_owned(),
            event.who.clone(),
            note,
        ]);
    }
    text.push_str(&format!("\n{}", done.render()));
    text
}

/// Text with the number and the times of a fault's occurrences.
fn times(fault: &FaultSummary, words: &Words) -> String {
    let [first, last] = [fault.first_at_us, fault.last_at_us].map(local);
    match fault.occurrences {
        1 => fill(words.faults.once, &[("last", &last)]),
        n => {
            let of = [("n", &n as _), ("first", &first as _), ("last", &last as _)];
            fill(words.faults.n_times, &of)
        }
    }
}

fn freeze_frame(samples: &[FreezeSample], words: &Words) -> String {
    let mut table = Table::headed(&[words.traces.signal, words.common.value]);
    for sample in samples {
        let value = match (&sample.label, sample.value) {
            (Some(label), _) => words.state(&sample.name, label).into_owned(),
            (None, Some(value)) => format!("{value:.2} {}", sample.unit),
            (None, None) => words.faults.not_known.into(),
        };
        table.row([words.signal(&sample.name).into_owned(), value]);
    }
    table.render()
}
