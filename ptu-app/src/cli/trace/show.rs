//! `ptu trace show`: a trace, and where it deviates from a good unit's trace.

use clap::Args;
use fault_db::{Channel, Id, Store, TraceData};
use serde_json::{Value, json};

use super::explained::{explanation_json, explanation_text};
use super::plot::{lanes, plot};
use super::{PartArguments, read};
use crate::cli::{Json, ScriptsOption, print_json, print_out};
use ptu_report::trace_notes::TraceNote;
use ptu_report::words::{Language, Words, fill};
use ptu_runs::clock::rfc3339;
use ptu_runs::failure::{Exit, Failure, RecordTrouble};
use ptu_runs::replay::{Explanation, explain};
use ptu_runs::table::Table;

#[derive(Debug, Args)]
pub struct ShowArguments {
    /// The trace
    id: String,
    #[command(flatten)]
    part: PartArguments,
    /// Show deviating signals beside the signals of the good twin: a sound unit with the same stimuli
    #[arg(long)]
    twin: bool,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl ShowArguments {
    pub fn run(self, store: &Store) -> Result<Exit, Failure> {
        let (id, trace) = read(store, &self.id, &self.part.signals, self.part.window)?;
        let noted = |words| TraceNote::all(store, id, words);
        if self.json.is_asked() {
            let notes = noted(Language::English.words())?;
            let mut document = trace_json(id, &trace, &notes);
            if self.twin {
                add(&mut document, explanation_json(&self.explained(store, id)?));
            }
            return print_json(&document);
        }
        // A trace that cannot be explained can still be looked at, unless the twin was asked for.
        let explained = match self.explained(store, id) {
            Err(failure) if self.twin => return Err(failure),
            explained => explained,
        };
        let words = Words::shown();
        let (told, twin) = match &explained {
            Ok(explanation) => (explanation_text(explanation), Some(explanation)),
            Err(failure) => {
                let why = words.told(&failure.message);
                let said = fill(words.terminal.not_expected, &[("why", &why)]);
                (said, None)
            }
        };
        let mut text = plot(id, &trace) + &notes(&noted(words)?, words);
        if let Some(explanation) = twin.filter(|_| self.twin) {
            let came = store.trace(id)?;
            let names: Vec<_> = explanation
                .comparison
                .deviations
                .iter()
                .map(|deviation| deviation.signal.as_str())
                .filter(|name| {
                    self.part.signals.is_empty() || self.part.signals.iter().any(|s| s == name)
                })
                .collect();
            text.push_str("\n\n");
            text.push_str(&lanes(&came, &explanation.twin, &names));
        }
        print_out(&format!("{text}\n\n{told}"))
    }

    fn explained(&self, store: &Store, id: Id) -> Result<Explanation, Failure> {
        // A missing recording is told before missing scripts.
        if store.recording(id)?.is_none() {
            return Err(Failure::usage(RecordTrouble::NoRecording(id)));
        }
        explain(store, &self.scripts.find()?, id)
    }
}

fn add(document: &mut Value, more: Value) {
    if let (Value::Object(document), Value::Object(more)) = (document, more) {
        document.extend(more);
    }
}

/// Table of the notes on places of the trace, below the trace.
fn notes(notes: &[TraceNote], words: &Words) -> String {
    if notes.is_empty() {
        return String::new();
    }
    let common = &words.common;
    let mut table = Table::headed(&[common.time, words.terminal.by, common.note]);
    for note in notes {
        table.row([note.time(), note.who.clone(), note.text.clone()]);
    }
    format!("\n\n{}", table.render())
}

fn trace_json(id: Id, trace: &TraceData, notes: &[TraceNote]) -> Value {
    let channel = |(channel, column): (&Channel, &Vec<f64>)| {
        let samples: Vec<_> = column.iter().map(|v| (!v.is_nan()).then_some(*v)).collect();
        json!({
            "name": channel.name, "unit": channel.unit, "kind": channel.kind, "samples": samples,
        })
    };
    json!({
        "id": id.to_string(),
        "t0": rfc3339(trace.t0_us),
        "t0_bench_s": trace.t0_bench_us as f64 / 1e6,
        "period_ms": trace.period_us as f64 / 1e3,
        "rows": trace.rows(),
        "trigger_row": trace.trigger_row,
        "partial": trace.partial,
        "notes": notes.iter().map(|note| json!({
            "time_s": note.time_us as f64 / 1e6, "at": note.at, "who": note.who, "text": note.text,
        })).collect::<Vec<_>>(),
        "signals": trace.channels.iter().zip(&trace.columns).map(channel).collect::<Vec<_>>(),
    })
}
