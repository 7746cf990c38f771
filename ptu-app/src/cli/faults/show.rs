//! `ptu faults show`: one fault with its occurrences, repairs and notes.

use fault_db::{FaultDetail, FaultEvent, FaultSummary, FreezeSample, Store};
use protocol::display_text::line;
use serde_json::{Value, json};

use crate::cli::{print_json, print_out};
use ptu_bench::clock::{local, rfc3339};
use ptu_bench::failure::{Exit, Failure};
use ptu_bench::table::Table;
use ptu_report::diagnosis::cause_text;
use ptu_report::fault_json;

/// Shows the fault an id stands for.
pub fn show(store: &Store, id: &str, json: bool) -> Result<Exit, Failure> {
    let fault = store.fault(store.resolve_fault(id)?)?;
    if json {
        print_json(&detail_json(&fault))
    } else {
        print_out(&detail(&fault))
    }
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

fn detail(detail: &FaultDetail) -> String {
    let fault = &detail.fault;
    let mut text = format!(
        "fault {}  {} {}  {}\nunit {}  part {}  cause {}  {}  seen {}\n",
        fault.id,
        fault.code,
        line(&fault.code_name),
        line(&fault.severity),
        line(&fault.unit_serial),
        line(&fault.lru),
        line(fault.cause()),
        fault.state.as_str(),
        times(fault),
    );
    for other in &detail.case {
        text.push_str(&format!(
            "  same case: {}  {} {}  part {}  {}\n",
            other.id.short(),
            other.code,
            line(&other.code_name),
            line(&other.lru),
            other.state.as_str(),
        ));
    }
    let mut table = Table::new(&["SEEN AT", "RUN", "TRACE", "WHAT"]);
    for seen in &detail.occurrences {
        table.row([
            local(seen.at_us),
            seen.run_id.short(),
            seen.trace_id.map_or_else(String::new, |id| id.short()),
            seen.message.clone(),
        ]);
    }
    let earlier =
        fault.occurrences as usize - detail.occurrences.len().min(fault.occurrences as usize);
    let more = match earlier {
        0 => String::new(),
        n => format!("… and {n} earlier\n"),
    };
    text.push_str(&format!("\n{}\n{more}", table.render()));
    if let Some(last) = detail.occurrences.first() {
        text.push_str(&format!("\nfreeze frame\n{}\n", freeze_frame(&last.freeze)));
    }
    let mut table = Table::new(&["AT", "EVENT", "WHO", "NOTE"]);
    let mut events: Vec<&FaultEvent> = detail.events.iter().chain(&detail.withdrawn).collect();
    events.sort_by_key(|event| event.at_us);
    for event in events {
        let repair = event.repair.as_ref().map_or_else(String::new, |repair| {
            format!(
                "{} {} → {} {}",
                repair.part,
                repair.serial_old.as_deref().unwrap_or("?"),
                repair.serial_new.as_deref().unwrap_or("?"),
                repair.note
            )
        });
        let cause = event.cause.as_ref().map_or_else(String::new, cause_text);
        let correction = event.correction.as_ref().map_or_else(String::new, |by| {
            let at = local(by.at_us);
            format!(" [withdrawn {at} {} {}]", line(&by.who), line(&by.note))
        });
        let note = format!("{}{repair}{cause}{correction}", event.note);
        table.row([
            local(event.at_us),
            event.kind.clone(),
            event.who.clone(),
            note,
        ]);
    }
    text.push_str(&format!("\n{}", table.render()));
    text
}

/// How often and when it was seen.
fn times(fault: &FaultSummary) -> String {
    let last = local(fault.last_at_us);
    match fault.occurrences {
        1 => format!("once, {last}"),
        n => format!("{n} times, {} .. {last}", local(fault.first_at_us)),
    }
}

fn freeze_frame(samples: &[FreezeSample]) -> String {
    let mut table = Table::new(&["SIGNAL", "VALUE"]);
    for sample in samples {
        let value = match (&sample.label, sample.value) {
            (Some(label), _) => label.clone(),
            (None, Some(value)) => format!("{value:.2} {}", sample.unit),
            (None, None) => "not known".into(),
        };
        table.row([sample.name.clone(), value]);
    }
    table.render()
}
