//! What a run found: the part, the values that show it, three reasons, and what to do next.

use std::collections::BTreeSet;
use std::sync::Arc;

use btu_rig::procedure::{Measurement, Verdict};
use eframe::egui::{RichText, Ui};
use fault_db::Id;

use super::evidence::Evidence;
use super::{CasePage, Stage, large};
use crate::pages::procedures::{Concluded, measurements};
use crate::parts::ActionPlace;
use crate::{Density, Destination, PageContext, Palette, Sizes};
use ptu_report::diagnosis::MOST_REASONS;
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::Progress;
use ptu_runs::failure::Exit;
use ptu_runs::run::Outcome;
use ptu_runs::run_diagnosis::Answer;

/// What was found in a run.
pub struct Found {
    pub run: Id,
    exit: Exit,
    verdict: Verdict,
    /// The conclusion of the diagnosis, in the language of the window.
    headline: String,
    /// Parts in the order of their probability.
    pub parts: Vec<String>,
    answer: Option<Arc<Answer>>,
    /// The first measured values that were out of their limits, with their step.
    shown_by: Option<(String, Vec<Measurement>)>,
    trace: Option<Id>,
    evidence: Option<Evidence>,
    /// Procedures that did not pass.
    pub procedures: BTreeSet<String>,
}

impl Found {
    pub fn of(
        outcome: &Outcome,
        run: &Progress,
        said: Option<&Concluded>,
        context: &PageContext<'_>,
    ) -> Self {
        let answer = said.and_then(|said| said.answer.as_deref());
        let diagnosis = answer.map(|answer| &answer.diagnosis);
        let candidates = || diagnosis.into_iter().flat_map(|said| &said.candidates);
        let mut parts: Vec<String> = Vec::new();
        for candidate in candidates() {
            let part = candidate.lru.to_string();
            if !parts.contains(&part) {
                parts.push(part);
            }
        }
        let traces = answer.and_then(|answer| answer.traces.get(parts.first()?));
        let any = answer.and_then(|answer| answer.traces.values().flatten().next());
        let trace = traces.and_then(|traces| traces.first()).or(any).copied();
        let part = parts.first().filter(|_| outcome.exit == Exit::Failed);
        let shown = |part: &String| Evidence::ask(part, (outcome.id, trace), run, context);
        Self {
            run: outcome.id,
            exit: outcome.exit,
            verdict: outcome.verdict,
            headline: said.map(|said| said.text.clone()).unwrap_or_default(),
            answer: said.and_then(|said| said.answer.clone()),
            shown_by: shown_by(run),
            evidence: part.map(shown),
            trace,
            procedures: not_passed(run),
            parts,
        }
    }
}

impl Found {
    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        if let Some(evidence) = &mut self.evidence {
            evidence.poll(context);
        }
    }
}

/// Procedures of a run that did not pass.
fn not_passed(run: &Progress) -> BTreeSet<String> {
    let bad = |verdict: Verdict| !matches!(verdict, Verdict::Passed | Verdict::Skipped);
    // The run as a whole is none.
    let procedures = (run.procedures.iter()).filter(|of| !of.procedure.steps.is_empty());
    let failed = procedures.filter(|procedure| {
        procedure.verdict.is_some_and(bad) || procedure.results.iter().any(|step| bad(step.verdict))
    });
    failed.map(|failed| failed.procedure.id.clone()).collect()
}

/// Values of the first step that failed by one.
fn shown_by(run: &Progress) -> Option<(String, Vec<Measurement>)> {
    let results = run.procedures.iter().flat_map(|progress| &progress.results);
    let bad = |measured: &&Measurement| measured.verdict == Verdict::Failed;
    results
        .map(|result| {
            let measured = result.measurements.iter().filter(bad).cloned();
            (result.name.clone(), measured.collect::<Vec<_>>())
        })
        .find(|(_, measured)| !measured.is_empty())
}

impl CasePage {
    pub(super) fn result(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        let Some(found) = &mut self.found else {
            return;
        };
        let headline = match found.exit {
            Exit::Failed => found.headline.clone(),
            Exit::Passed => words.case.no_fault.to_owned(),
            _ => {
                let verdict = words.common.verdict(found.verdict);
                fill(words.case.not_finished, &[("verdict", &verdict)])
            }
        };
        ui.label(
            RichText::new(headline)
                .size(Sizes::of(ui).headline)
                .strong(),
        );
        if let Some((step, measured)) = &found.shown_by {
            ui.label(RichText::new(&*words.content(step)).size(Sizes::of(ui).text));
            measurements(ui, words, measured);
        }
        reasons(ui, words, found);
        let place = ActionPlace::new(ui, "case result", found.run);
        let mut next = None;
        ui.horizontal_wrapped(|ui| {
            let failed = found.exit == Exit::Failed;
            if failed && place.clicked(&large(ui, words.case.record_repair, true)) {
                next = Some(Stage::Repair);
            }
            if place.clicked(&large(ui, words.case.to_sheet, true)) {
                next = Some(Stage::Sheet);
            }
            if let Some(trace) = found.trace
                && ui.button(words.diagnosis.traces).clicked()
            {
                context.go_to.push(Destination::Trace(trace));
            }
            if ui.button(words.procedures.to_diagnosis).clicked() {
                context.go_to.push(Destination::Diagnosis(found.run));
            }
        });
        next_check(ui, found, self.unit.as_deref(), context);
        if let Some(evidence) = &mut found.evidence {
            evidence.show(ui, words);
        }
        if let Some(next) = next {
            self.repair.prepare(found, &self.known);
            self.stage = next;
        }
    }
}

/// What would tell more, and how long it takes.
fn next_check(ui: &mut Ui, found: &Found, unit: Option<&str>, context: &mut PageContext<'_>) {
    let words = context.words;
    let (Some(answer), Some(unit)) = (&found.answer, unit) else {
        return;
    };
    let Some(next) = &answer.diagnosis.next_check else {
        return;
    };
    ui.horizontal_wrapped(|ui| {
        let step = words.content(&next.check.step);
        let time = format!("{:.0} s", next.cost_s.ceil());
        let said = [("check", &step as &dyn std::fmt::Display), ("time", &time)];
        let mut said = fill(words.case.next_check, &said);
        let tells = words.tells(next, &answer.names);
        if !tells.is_empty() {
            said = format!("{said}: {tells}");
        }
        ui.label(RichText::new(said).size(Sizes::of(ui).text));
        let run = ui.button(words.diagnosis.run_it);
        let run = match Sizes::of(ui).density {
            Density::Operator => run,
            Density::Engineer => run.on_hover_text(next.check.to_string()),
        };
        if run.clicked() {
            context.go_to.push(Destination::RunStep {
                procedure: next.check.procedure.clone(),
                step: next.check.step.clone(),
                unit: unit.to_owned(),
            });
        }
    });
}

fn reasons(ui: &mut Ui, words: &Words, found: &Found) {
    let Some(answer) = &found.answer else {
        return;
    };
    let Some(first) = answer.diagnosis.candidates.first() else {
        return;
    };
    let quiet = Palette::of(ui).quiet;
    ui.label(RichText::new(words.case.because).color(quiet));
    for reason in first.for_it.iter().take(MOST_REASONS) {
        let said = match Sizes::of(ui).density {
            Density::Operator => words.reason_in_procedure(reason, &answer.run),
            Density::Engineer => words.reason(reason, &answer.run),
        };
        ui.label(format!("+ {said}"));
    }
}
