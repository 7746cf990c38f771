//! Evidence for the named part: its place in the structure, and the trace of the failed check beside that of a good
//! unit.

use std::sync::Arc;

use btu_rig::procedure::{Procedure, Verdict};
use eframe::egui::{RichText, Ui};
use fault_db::{Id, RunOccurrence};
use protocol::LruId;
use protocol::signal::Signal;

use super::chain::chain;
use crate::pages::traces::SmallTrace;
use crate::request::Request;
use crate::{DataPaths, PageContext, Palette};
use ptu_report::naming::{PartNames, failed_turn};
use ptu_report::trace_view::listing::{self, OpenTrace};
use ptu_report::words::Words;
use ptu_runs::bench_worker::Progress;
use ptu_runs::failure::Failure;
use ptu_runs::stored::findings;
use ptu_runs::structure::{Chain, Structure};

/// Signals of the check that are drawn, at most.
const SIGNALS: usize = 4;

/// The evidence as read from the database, and the drawing of the trace.
pub struct Evidence {
    part: String,
    read: Request<Read>,
    trace: Option<SmallTrace>,
}

/// A check that did not pass.
#[derive(Clone)]
struct FailedCheck {
    procedure: Arc<Procedure>,
    index: usize,
    name: String,
    suspect: Option<LruId>,
}

struct Read {
    names: PartNames,
    chain: Option<Chain>,
    /// The trace, until it is drawn.
    trace: Option<OpenTrace>,
    signals: Vec<String>,
}

impl Evidence {
    /// Requests the evidence that `part` failed in this run; `trace` is shown if the part's failed check has no trace.
    pub fn ask(
        part: &str,
        (run, trace): (Id, Option<Id>),
        progress: &Progress,
        context: &PageContext<'_>,
    ) -> Self {
        let checks = failed_checks(progress);
        let of = part.to_owned();
        let question = move |paths: &DataPaths| read(paths, run, trace, &of, checks);
        Self {
            part: part.to_owned(),
            read: Request::Pending(context.queries.run(question)),
            trace: None,
        }
    }

    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        self.read.poll();
        if let Request::Ready(read) = &mut self.read
            && let Some(opened) = read.trace.take()
        {
            self.trace = Some(SmallTrace::beside_twin(opened, &read.signals, context));
        }
        if let Some(trace) = &mut self.trace {
            trace.poll(context);
        }
    }

    pub fn has_way(&self) -> bool {
        self.chain().is_some()
    }

    pub fn has_trace(&self) -> bool {
        self.trace.is_some()
    }

    fn chain(&self) -> Option<(&Chain, &PartNames)> {
        let read = self.read.value()?;
        Some((read.chain.as_ref()?, &read.names))
    }

    pub fn way(&self, ui: &mut Ui, words: &Words) {
        if let Some((way, names)) = self.chain() {
            chain(ui, way, &self.part, names, words);
        }
    }

    pub fn trace(&mut self, ui: &mut Ui, words: &Words) {
        let Some(trace) = &mut self.trace else {
            return;
        };
        let quiet = Palette::of(ui).quiet;
        ui.horizontal_wrapped(|ui| {
            let said = match (trace.is_pending(), trace.has_twin()) {
                (true, _) => words.traces.making_twin,
                (false, true) => words.case.beside_twin,
                (false, false) => words.case.no_twin,
            };
            if trace.is_pending() {
                ui.spinner();
            }
            ui.label(RichText::new(said).color(quiet));
        });
        trace.show(ui, words.case.beside_twin, words);
    }
}

fn failed_checks(run: &Progress) -> Vec<FailedCheck> {
    let of = |progress: &ptu_runs::bench_worker::ProcedureProgress| {
        let failed = progress.results.iter();
        let failed = failed.filter(|result| result.verdict == Verdict::Failed);
        let checks = failed.map(|result| FailedCheck {
            procedure: progress.procedure.clone(),
            index: result.index,
            name: result.name.clone(),
            suspect: result.suspect.clone(),
        });
        checks.collect::<Vec<_>>()
    };
    run.procedures.iter().flat_map(of).collect()
}

/// Reads the evidence of the first failed check that names the part, or else whose chain contains the part.
fn read(
    paths: &DataPaths,
    run: Id,
    trace: Option<Id>,
    part: &str,
    mut checks: Vec<FailedCheck>,
) -> Result<Read, Failure> {
    let structure = Structure::load(&paths.scripts, &paths.scripts.faults()?)?;
    let part: Option<LruId> = part.parse().ok();
    checks.sort_by_key(|check| check.suspect != part);
    let on_way = checks.iter().find_map(|check| {
        let step = check.procedure.steps.get(check.index)?;
        Some((
            check,
            step,
            structure.chain(&check.procedure, step, part.as_ref()?)?,
        ))
    });
    let store = paths.read()?;
    let shows = |seen: &&RunOccurrence| {
        let check = on_way.as_ref().map(|(check, ..)| check);
        check.is_some_and(|check| {
            failed_turn(&findings(&seen.findings), &check.procedure.id, &check.name).is_some()
        })
    };
    let seen = store.run_occurrences(run)?;
    let of_check = seen.iter().find(shows);
    let trace = of_check.and_then(|seen| seen.trace_id).or(trace);
    let names = PartNames::of(&paths.scripts);
    let opened = match trace {
        Some(trace) => Some(listing::open(&store, &names, trace, Some(run))?),
        None => None,
    };
    let mut signals: Vec<Signal> = Vec::new();
    if let Some((_, step, _)) = &on_way {
        step.for_each_signal(&mut |signal| {
            if !signals.contains(&signal) {
                signals.push(signal);
            }
        });
    }
    let known = |name: &&str| {
        opened
            .as_ref()
            .is_some_and(|open| open.view.place(name).is_some())
    };
    let signals = signals.iter().map(|signal| signal.name()).filter(known);
    Ok(Read {
        signals: signals.take(SIGNALS).map(str::to_owned).collect(),
        chain: on_way.map(|(_, _, chain)| chain),
        trace: opened,
        names,
    })
}
