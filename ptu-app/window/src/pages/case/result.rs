//! What a run found: the part, the values that show it, three reasons, and what to do next.

use std::collections::BTreeSet;
use std::sync::Arc;

use btu_rig::procedure::{Measurement, StepResult, Verdict};
use eframe::egui::{RichText, Ui};
use fault_db::Id;

use super::evidence::Evidence;
use super::verdict::{Next, Told, named};
use super::{CasePage, Stage, large, primary};
use crate::pages::procedures::{Concluded, measurements};
use crate::parts::{ActionPlace, chip};
use crate::{Density, Destination, PageContext, Palette, Sizes};
use ptu_report::diagnosis::MOST_REASONS;
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::Progress;
use ptu_runs::clock;
use ptu_runs::run::Outcome;
use ptu_runs::run_diagnosis::Answer;

/// What was found in a run.
pub struct Found {
    pub run: Id,
    /// When it ended, µs since 1970.
    ended_us: i64,
    told: Told,
    /// In the language of the window.
    headline: String,
    /// The conclusion of the diagnosis, likewise.
    concluded: String,
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
        let part = parts.first().filter(|_| outcome.verdict == Verdict::Failed);
        let told = Told::of(outcome.verdict, diagnosis.map(|said| &said.conclusion));
        let shown = |part: &String| Evidence::ask(part, (outcome.id, trace), run, context);
        Self {
            run: outcome.id,
            ended_us: clock::now_us(),
            told,
            headline: headline(told, run, outcome, answer, context.words),
            concluded: said.map(|said| said.text.clone()).unwrap_or_default(),
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

/// The headline with its parts, steps or reason.
pub fn headline(
    told: Told,
    run: &Progress,
    outcome: &Outcome,
    answer: Option<&Answer>,
    words: &Words,
) -> String {
    let parts = answer.map(|answer| words.parts(&named(&answer.diagnosis), &answer.names));
    let error = |result: &&StepResult| result.verdict == Verdict::Error;
    let why = || {
        let mut results = run.procedures.iter().rev().flat_map(|of| &of.results);
        let result = results.find(error);
        result.map(|result| words.findings(&result.findings))
    };
    let why = why().filter(|_| told == Told::NotTested);
    let counts: [(&str, &dyn std::fmt::Display); 4] = [
        ("part", &parts.unwrap_or_default()),
        ("why", &why.unwrap_or_default()),
        ("n", &outcome.counts.run()),
        ("all", &outcome.counts.planned),
    ];
    fill(told.headline(&words.case), &counts)
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
        let palette = Palette::of(ui);
        ui.horizontal_wrapped(|ui| {
            let word = found.told.word(&words.case);
            chip(ui, word, found.told.colour(&palette));
            let said: [(&str, &dyn std::fmt::Display); 2] = [
                ("id", &found.run.short()),
                ("time", &clock::local(found.ended_us)),
            ];
            ui.label(RichText::new(fill(words.case.of_run, &said)).color(palette.quiet));
        });
        let headline = RichText::new(&found.headline).size(Sizes::of(ui).headline);
        ui.label(headline.strong());
        if let Some((step, measured)) = &found.shown_by {
            ui.label(RichText::new(&*words.content(step)).size(Sizes::of(ui).lead));
            measurements(ui, words, measured);
        }
        reasons(ui, words, found);
        let place = ActionPlace::new(ui, "case result", found.run);
        let check = found.answer.as_ref();
        let check = check.and_then(|answer| answer.diagnosis.next_check.as_ref());
        let first = found.told.next(check.is_some());
        let failed = matches!(found.told, Told::Part | Told::Unsure | Told::NoPart);
        let may_run = context.units.chosen().may_run();
        let mut asked = None;
        ui.horizontal_wrapped(|ui| {
            let time = check.map(|check| format!("{:.0} s", check.cost_s.ceil()));
            let mut ways = [
                (Next::Repair, words.case.record_repair, failed),
                (Next::Check, words.case.run_next, check.is_some()),
                (
                    Next::ShowFailed,
                    words.case.show_failed,
                    first == Next::ShowFailed,
                ),
                (
                    Next::WholeSuite,
                    words.case.run_whole,
                    first == Next::WholeSuite,
                ),
                (
                    Next::RunAgain,
                    words.case.run_again,
                    first == Next::RunAgain,
                ),
                (Next::Sheet, words.case.to_sheet, true),
            ];
            ways.sort_by_key(|(way, ..)| *way != first);
            for (way, text, _) in ways.iter().filter(|(.., offered)| *offered) {
                let text = fill(text, &[("time", &time.as_deref().unwrap_or_default())]);
                let runs = matches!(way, Next::Check | Next::WholeSuite | Next::RunAgain);
                let button = match *way == first {
                    true => primary(ui, &text, may_run || !runs),
                    false => large(ui, &text, may_run || !runs),
                };
                if runs && !may_run {
                    ui.label(RichText::new(words.procedures.connect_first).color(palette.quiet));
                }
                if place.clicked(&button) {
                    asked = Some(*way);
                }
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
        next_check(ui, found, words);
        if let Some(evidence) = &mut found.evidence {
            evidence.show(ui, words);
        }
        match asked {
            Some(Next::Repair) => {
                self.repair.prepare(found, &self.known);
                self.stage = Stage::Repair;
            }
            Some(Next::Sheet) => self.stage = Stage::Sheet,
            Some(Next::ShowFailed) => context.go_to.push(Destination::Report(found.run)),
            Some(Next::Check) => {
                let check = check.map(|next| &next.check).zip(self.unit.clone());
                context
                    .go_to
                    .extend(check.map(|(check, unit)| Destination::RunStep {
                        procedure: check.procedure.clone(),
                        step: check.step.clone(),
                        unit,
                    }));
            }
            Some(again @ (Next::WholeSuite | Next::RunAgain)) => {
                let symptom = self.tiles.symptom();
                context.go_to.push(match again {
                    Next::WholeSuite => Destination::RunAll(symptom),
                    _ => Destination::FindPart(symptom),
                });
                self.found = None;
                self.stage = Stage::Find;
            }
            None => {}
        }
    }
}

/// Shows the check that would tell the diagnosis most, and what of.
fn next_check(ui: &mut Ui, found: &Found, words: &Words) {
    let Some(answer) = &found.answer else {
        return;
    };
    let Some(next) = &answer.diagnosis.next_check else {
        return;
    };
    let step = words.content(&next.check.step);
    let mut said = fill(words.case.next_check, &[("check", &step)]);
    let tells = words.tells(next, &answer.names);
    if !tells.is_empty() {
        said = format!("{said}: {tells}");
    }
    let said = ui.label(RichText::new(said).size(Sizes::of(ui).lead));
    if Sizes::of(ui).density == Density::Engineer {
        said.on_hover_text(next.check.to_string());
    }
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
    ui.label(RichText::new(&found.concluded).color(quiet));
}
