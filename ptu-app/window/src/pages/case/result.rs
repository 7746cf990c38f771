//! Result of a run: the part, the values that show it, three reasons, and what to do next.

use std::collections::BTreeSet;
use std::sync::Arc;

use btu_rig::procedure::{Measurement, StepResult, Verdict};
use diagnosis::NextCheck;
use eframe::egui::{RichText, Ui};
use fault_db::{Id, StepCounts};

use super::evidence::Evidence;
use super::verdict::{Next, Told, named};
use crate::pages::procedures::{Concluded, why_not};
use crate::parts::{ActionPlace, Card, Face, Look, limit_scale, segments, title};
use crate::units::Unit;
use crate::{Density, PageContext, Palette, Sizes};
use ptu_report::diagnosis::MOST_REASONS;
use ptu_report::naming::{self, DOT};
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::Progress;
use ptu_runs::clock;
use ptu_runs::run::Outcome;
use ptu_runs::run_diagnosis::Answer;

/// Width of a window that shows all of a result at once, points.
const WIDE: f32 = 1600.0;
/// Values that are drawn large, at most.
const MOST_BARS: usize = 2;

/// Findings of a run.
pub struct Found {
    pub run: Id,
    /// When the run ended, µs since 1970.
    pub ended_us: i64,
    pub told: Told,
    /// Headline in the language of the window.
    headline: String,
    /// The conclusion of the diagnosis in the language of the window.
    concluded: String,
    /// Parts in the order of their probability.
    pub parts: Vec<String>,
    answer: Option<Arc<Answer>>,
    /// Name of the first step with a value out of its limits, and those values.
    shown_by: Option<(String, Vec<Measurement>)>,
    /// Counts of the steps by outcome.
    pub counts: StepCounts,
    evidence: Option<Evidence>,
    shown: Part,
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
            ended_us: run.ended_us,
            told,
            headline: headline(told, run, outcome, answer, context.words),
            concluded: said.map(|said| said.text.clone()).unwrap_or_default(),
            answer: said.and_then(|said| said.answer.clone()),
            shown_by: shown_by(run),
            evidence: part.map(shown),
            counts: outcome.counts,
            shown: Part::default(),
            procedures: not_passed(run),
            parts,
        }
    }
}

/// The part of a result that is shown.
#[derive(Clone, Copy, Default, PartialEq)]
pub enum Part {
    #[default]
    Why,
    Way,
    Beside,
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
        let of_step = result.map(|result| words.findings(&result.findings));
        // If no step tells the reason, a finding outside the steps does.
        let outside = run
            .procedures
            .iter()
            .rev()
            .map(|of| words.findings(&of.findings));
        let mut said = of_step.into_iter().chain(outside);
        said.find(|said| !said.is_empty())
            .unwrap_or_else(|| words.case.is_not_tested.into())
    };
    let why = (told == Told::NotTested).then(why);
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
    // The entry for the run as a whole has no steps and is no procedure.
    let procedures = (run.procedures.iter()).filter(|of| !of.procedure.steps.is_empty());
    let failed = procedures.filter(|procedure| {
        procedure.verdict.is_some_and(bad) || procedure.results.iter().any(|step| bad(step.verdict))
    });
    failed.map(|failed| failed.procedure.id.clone()).collect()
}

/// Name and failed values of the first step in which a value failed.
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

impl Found {
    fn part(&mut self, ui: &mut Ui, part: Part, words: &Words) {
        if part == Part::Why {
            reasons(ui, words, self);
            next_check(ui, self, words);
        } else if let Some(evidence) = &mut self.evidence {
            match part {
                Part::Way => evidence.way(ui, words),
                _ => evidence.trace(ui, words),
            }
        }
    }

    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        if let Some(evidence) = &mut self.evidence {
            evidence.poll(context);
        }
    }

    /// Draws the result; `names_run`: with run and time, because no strip beside the result names them.
    pub fn show(&mut self, ui: &mut Ui, names_run: bool, words: &Words) {
        let said: [(&str, &dyn std::fmt::Display); 2] = [
            ("id", &self.run.short()),
            ("time", &clock::local(self.ended_us)),
        ];
        let counts = &self.counts;
        let count: [(&str, &dyn std::fmt::Display); 2] =
            [("n", &counts.not_passed()), ("run", &counts.run())];
        let mut count = fill(words.case.count, &count);
        if names_run {
            count = [count, fill(words.case.of_run, &said)].join(DOT);
        }
        let card = Card {
            icon: self.told.icon(),
            word: self.told.word(&words.case),
            colour: self.told.colour(&Palette::of(ui)),
            count: &count,
            headline: &self.headline,
        };
        card.show(ui, |ui| {
            if let Some((step, measured)) = &self.shown_by {
                ui.label(&*words.content(step));
                for measured in measured.iter().take(MOST_BARS) {
                    let name = naming::measurement(&measured.name, words);
                    ui.label(RichText::new(&name).color(Palette::of(ui).quiet));
                    limit_scale(ui, words, (&name, measured));
                }
            }
        });
        ui.add_space(8.0);
        let has = |part| match part {
            Part::Why => self.answer.is_some(),
            Part::Way => self.evidence.as_ref().is_some_and(Evidence::has_way),
            Part::Beside => self.evidence.as_ref().is_some_and(Evidence::has_trace),
        };
        let parts = [
            (Part::Why, words.case.why),
            (Part::Way, words.case.way),
            (Part::Beside, words.case.beside),
        ];
        let parts: Vec<_> = parts.into_iter().filter(|(part, _)| has(*part)).collect();
        if ui.ctx().content_rect().width() >= WIDE {
            for (part, name) in parts {
                title(ui, name);
                self.part(ui, part, words);
            }
            return;
        }
        segments(ui, &mut self.shown, parts);
        ui.add_space(8.0);
        self.part(ui, self.shown, words);
    }

    /// The check that would tell the diagnosis most.
    pub fn next_check(&self) -> Option<&NextCheck> {
        self.answer.as_ref()?.diagnosis.next_check.as_ref()
    }

    /// Buttons for what is to be done next, the first thing first; what was chosen.
    pub fn foot(&self, ui: &mut Ui, unit: &Unit, words: &Words) -> Option<Next> {
        let place = ActionPlace::new(ui, "case result", self.run);
        let check = self.next_check();
        let first = self.told.next(self.counts.run() == self.counts.planned);
        let failed = self.told.is_failed();
        let time = check.map(|check| format!("{:.0} s", check.cost_s.ceil()));
        let is_first = |way| way == first;
        let case = &words.case;
        // A way without a condition (`false`) is offered only as the first.
        let mut ways = [
            (Next::Repair, case.record_repair, failed),
            (Next::Check, case.run_next, check.is_some()),
            (Next::ShowFailed, case.show_failed, false),
            (Next::WholeSuite, case.run_whole, false),
            (Next::RunAgain, case.run_again, false),
            (Next::Sheet, case.to_sheet, !failed),
        ];
        ways.sort_by_key(|(way, ..)| *way != first);
        let mut asked = None;
        for (way, text, _) in ways
            .iter()
            .filter(|(way, _, offered)| *offered || is_first(*way))
        {
            let text = fill(text, &[("time", &time.as_deref().unwrap_or_default())]);
            let runs = matches!(way, Next::Check | Next::WholeSuite | Next::RunAgain);
            let look = if is_first(*way) {
                Look::Primary
            } else {
                Look::Secondary
            };
            let why_not = (runs && !unit.may_run()).then(|| why_not(unit, words));
            let button = Face::new(look, text).off(why_not);
            // An action whose button has no room here can be reached by the list of steps.
            if !is_first(*way) && button.wide(ui) > ui.available_width() {
                continue;
            }
            if place.clicked(&button.show(ui)) {
                asked = Some(*way);
            }
        }
        asked
    }
}

/// Shows the check that would tell the diagnosis most, and the parts it would tell apart.
fn next_check(ui: &mut Ui, found: &Found, words: &Words) {
    let Some((answer, next)) = found.answer.as_ref().zip(found.next_check()) else {
        return;
    };
    let step = words.content(&next.check.step);
    let mut said = fill(words.case.next_check, &[("check", &step)]);
    let tells = words.tells(next, &answer.names);
    if !tells.is_empty() {
        said = format!("{said}: {tells}");
    }
    let said = ui.label(said);
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
    for reason in first.for_it.iter().take(MOST_REASONS) {
        let said = match Sizes::of(ui).density {
            Density::Operator => words.reason_in_procedure(reason, &answer.run),
            Density::Engineer => words.reason(reason, &answer.run),
        };
        ui.label(format!("+ {said}"));
    }
    ui.label(RichText::new(&found.concluded).color(quiet));
}
