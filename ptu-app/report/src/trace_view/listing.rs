//! Lists the recorded traces, and opens one with the events in it.

use fault_db::{Id, RunFilter, RunOccurrence, RunSummary, Store, Verdict};

use super::TraceView;
use crate::naming::PartNames;
use crate::words::Language;
use ptu_runs::clock;
use ptu_runs::failure::{Asked, Failure};

/// Number of the newest runs whose traces are listed.
pub const RUNS: u32 = 500;

/// Permitted times from row to row, µs: up to a minute.
const PERIODS_US: std::ops::RangeInclusive<i64> = 1..=60_000_000;

/// A run with its traces.
#[derive(Clone, Debug)]
pub struct ListedRun {
    pub id: Id,
    /// Serial number of its unit.
    pub unit: String,
    /// When it began, local time.
    pub began: String,
    /// Verdict of the run; none before its end.
    pub verdict: Option<Verdict>,
    /// Faults injected on purpose.
    pub injected: Option<String>,
    /// Traces of the run, in order.
    pub traces: Vec<ListedTrace>,
}

#[derive(Clone, Debug)]
pub struct ListedTrace {
    pub id: Id,
    /// Length of the trace, s.
    pub length_s: f64,
    /// Faults that the trace shows, each once.
    pub faults: Vec<ListedFault>,
    /// Text in which a filter searches, in lower case.
    text: String,
}

/// A fault that a trace shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListedFault {
    /// Code, name and part, as `9000 check_failed eb_relay`.
    pub code: String,
    /// Name of the fault for people, in each language.
    said: [String; 2],
}

impl ListedFault {
    fn of(occurrence: &RunOccurrence, parts: &PartNames) -> Self {
        let said = |language: Language| {
            let seen = (&occurrence.findings, &*occurrence.message);
            parts.fault(&occurrence.lru, seen, language.words())
        };
        Self {
            code: format!(
                "{} {} {}",
                occurrence.code, occurrence.code_name, occurrence.lru
            ),
            said: [said(Language::English), said(Language::Korean)],
        }
    }

    pub fn said(&self, language: Language) -> &str {
        language.choose([&self.said[0], &self.said[1]])
    }
}

impl ListedTrace {
    /// Faults of the trace in one line; empty where it has none.
    pub fn said(&self, language: Language) -> String {
        let said: Vec<_> = self
            .faults
            .iter()
            .map(|fault| fault.said(language))
            .collect();
        said.join("; ")
    }
}

/// Something that happened in a trace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    /// Row at which it happened.
    pub row: usize,
    /// Fault at this place; none = the trigger.
    pub fault: Option<ListedFault>,
}

#[derive(Debug)]
pub struct OpenTrace {
    pub id: Id,
    /// Run of the trace, as far as it is known.
    pub run: Option<Id>,
    pub view: TraceView,
    /// The trigger and the faults found in its window, in order.
    pub events: Vec<Event>,
}

/// Runs that have traces, newest first.
///
/// # Errors
/// The database fails.
pub fn list(store: &Store, parts: &PartNames) -> Result<Vec<ListedRun>, Failure> {
    let newest = RunFilter {
        limit: Some(RUNS),
        ..RunFilter::default()
    };
    let mut listed = Vec::new();
    for run in store.runs(&newest)? {
        let traces = store.traces(run.id)?;
        if traces.is_empty() {
            continue;
        }
        let occurrences = store.run_occurrences(run.id)?;
        let began = clock::local(run.started_at_us);
        let trace = |trace: fault_db::TraceSummary| {
            let mut faults: Vec<ListedFault> = Vec::new();
            for occurrence in occurrences.iter().filter(|o| o.trace_id == Some(trace.id)) {
                let fault = ListedFault::of(occurrence, parts);
                if !faults.contains(&fault) {
                    faults.push(fault);
                }
            }
            ListedTrace {
                id: trace.id,
                length_s: f64::from(trace.rows) * trace.period_us as f64 / 1e6,
                text: text(&run, &began, trace.id, &faults),
                faults,
            }
        };
        listed.push(ListedRun {
            id: run.id,
            traces: traces.into_iter().map(trace).collect(),
            unit: run.unit_serial,
            began,
            verdict: run.verdict,
            injected: run.injected,
        });
    }
    Ok(listed)
}

fn text(run: &RunSummary, began: &str, trace: Id, faults: &[ListedFault]) -> String {
    let injected = run.injected.as_deref().unwrap_or_default();
    let of = |fault: &ListedFault| format!("{} {}", fault.code, fault.said.join(" "));
    let faults: Vec<String> = faults.iter().map(of).collect();
    let (run_id, faults) = (run.id.short(), faults.join(" "));
    format!(
        "{run_id} {} {began} {injected} {} {faults}",
        run.unit_serial,
        trace.short()
    )
    .to_lowercase()
}

impl ListedTrace {
    /// Whether each word of the filter occurs in the text of the trace.
    pub fn fits(&self, filter: &str) -> bool {
        let filter = filter.to_lowercase();
        filter
            .split_whitespace()
            .all(|word| self.text.contains(word))
    }
}

/// Reads a trace; its run is `run`, or else the run that the trace's recording names.
///
/// # Errors
/// The trace is gone or damaged, or the database fails.
pub fn open(
    store: &Store,
    parts: &PartNames,
    id: Id,
    run: Option<Id>,
) -> Result<OpenTrace, Failure> {
    let data = store.trace(id)?;
    if !PERIODS_US.contains(&data.period_us) {
        return Err(Failure::bench(Asked::TraceDamaged(id, data.period_us)));
    }
    let run = match run {
        Some(run) => Some(run),
        None => store.recording(id)?.map(|recording| recording.run_id),
    };
    let occurrences = match run {
        Some(run) => store.run_occurrences(run)?,
        None => Vec::new(),
    };
    let mut events: Vec<Event> = occurrences
        .iter()
        .filter_map(|occurrence| {
            let since_us = occurrence.bench_us.saturating_sub(data.t0_bench_us);
            let row = usize::try_from(since_us.div_euclid(data.period_us)).ok()?;
            (row < data.rows()).then(|| Event {
                row,
                fault: Some(ListedFault::of(occurrence, parts)),
            })
        })
        .collect();
    events.extend(data.trigger_row.map(|row| Event {
        row: row as usize,
        fault: None,
    }));
    events.sort_by_key(|event| event.row);
    Ok(OpenTrace {
        id,
        run,
        view: TraceView::new(data),
        events,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_finds_all_its_words_in_any_order() {
        let trace = ListedTrace {
            id: Id::from_bytes([0; 16]),
            length_s: 1.0,
            faults: Vec::new(),
            text: "443485fc bad-1 2026-11-22 9000 check_failed eb_relay".into(),
        };
        assert!(trace.fits(""));
        assert!(trace.fits("relay BAD-1"));
        assert!(!trace.fits("relay good"));
    }
}
