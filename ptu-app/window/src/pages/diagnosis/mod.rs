//! Diagnosis: the part to replace, why, and what to check next.

mod candidates;

use btu_rig::procedure::{Findings, Verdict};
use diagnosis::Reason;
use eframe::egui::{CentralPanel, RichText, ScrollArea, Ui};
use egui_material_icons::icons::{ICON_DESCRIPTION, ICON_TROUBLESHOOT};
use fault_db::{Id, RunOccurrence};

use super::case::{Told, named};
use crate::parts::{Card, Face, Look, RunList, empty};
use crate::request::Request;
use crate::{DataPaths, Destination, PageContext, Palette, Wanted};
use ptu_report::naming::{PartNames, failed_turn};
use ptu_report::words::{Words, fill};
use ptu_runs::clock;
use ptu_runs::coverage::counts_of;
use ptu_runs::failure::Failure;
use ptu_runs::run_diagnosis::{Answer, diagnose_run};
use ptu_runs::stored::{findings, from_stored};

#[derive(Default)]
pub struct DiagnosisPage {
    runs: RunList,
    run: Option<Id>,
    answer: Request<NamedAnswer>,
}

/// An answer of the diagnosis, the names of parts, and what the run's traces show.
pub struct NamedAnswer {
    answer: Answer,
    parts: PartNames,
    /// Occurrences of faults that have a trace, each with its findings.
    traced: Vec<(RunOccurrence, Findings)>,
}

impl NamedAnswer {
    fn of(paths: &DataPaths, run: Id) -> Result<Self, Failure> {
        let store = paths.read()?;
        let traced = store.run_occurrences(run)?.into_iter();
        let traced = traced.filter(|fault| fault.trace_id.is_some());
        let traced = traced.map(|fault| {
            let seen = findings(&fault.findings);
            (fault, seen)
        });
        Ok(Self {
            answer: diagnose_run(&store, &paths.scripts, run)?,
            parts: PartNames::of(&paths.scripts),
            traced: traced.collect(),
        })
    }

    fn shown_by(&self, trace: Id, words: &Words) -> String {
        let shown = self
            .traced
            .iter()
            .find(|(fault, _)| fault.trace_id == Some(trace));
        shown.map_or_else(
            || trace.short(),
            |(fault, _)| {
                let seen = (&fault.findings, &*fault.message);
                self.parts.fault(&fault.lru, seen, words)
            },
        )
    }

    /// The trace of the step that a reason is about.
    fn trace_of(&self, reason: &Reason) -> Option<Id> {
        let check = reason.step()?;
        let mut traced = self.traced.iter();
        let about =
            traced.find(|(_, seen)| failed_turn(seen, &check.procedure, &check.step).is_some());
        about?.0.trace_id
    }
}

impl DiagnosisPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.answer.poll();
        let run = self.runs.show(ui, context);
        if run != self.run {
            self.ask(run, context);
        }
        CentralPanel::default().show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                self.runs.tell_other_unit(ui, context.words);
                self.answer(ui, context);
            });
        });
    }

    /// Shows the diagnosis of this run.
    pub fn open(&mut self, run: Id, context: &mut PageContext<'_>) {
        self.runs.choose(run, context);
        self.ask(Some(run), context);
    }

    fn ask(&mut self, run: Option<Id>, context: &PageContext<'_>) {
        self.run = run;
        self.answer = run.map_or(Request::Idle, |run| {
            Request::Pending(
                context
                    .queries
                    .run(move |paths| NamedAnswer::of(paths, run)),
            )
        });
    }

    fn answer(&self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = &context.words.diagnosis;
        let palette = Palette::of(ui);
        let named = match &self.answer {
            Request::Ready(named) => named,
            Request::Idle => {
                empty(ui, ICON_TROUBLESHOOT, (words.choose_run, ""), None);
                return;
            }
            Request::Pending(_) => {
                ui.spinner();
                return;
            }
            Request::Failed(why) => {
                ui.label(RichText::new(words.no_answer).color(palette.bad).strong());
                ui.label(&*context.words.trouble(why));
                return;
            }
        };
        let answer = &named.answer;
        self.head(ui, context, answer);
        for warning in &answer.warnings {
            ui.label(
                RichText::new(format!("⚠ {}", context.words.trouble(warning))).color(palette.warn),
            );
        }
        ui.add_space(8.0);
        candidates::ranked(ui, context, named);
        let from = context.words.report.origin(answer.dictionary_from);
        let from = fill(words.dictionary, &[("from", &from)]);
        ui.label(RichText::new(from).small().color(palette.quiet));
    }

    fn head(&self, ui: &mut Ui, context: &mut PageContext<'_>, answer: &Answer) {
        let words = context.words;
        let run = &answer.run.run;
        let time = clock::local(run.started_at_us);
        let of_run = fill(
            words.diagnosis.of_run,
            &[("unit", &run.unit_serial), ("time", &time)],
        );
        let verdict = run.verdict.map_or(Verdict::Error, from_stored);
        let told = Told::of(verdict, Some(&answer.diagnosis.conclusion));
        let (conclusion, counts) = (words.concluded(answer), counts_of(run));
        let said: [(&str, &dyn std::fmt::Display); 4] = [
            (
                "part",
                &words.parts(&named(&answer.diagnosis), &answer.names),
            ),
            ("why", &words.case.is_not_tested),
            ("n", &counts.run()),
            ("all", &counts.planned),
        ];
        let card = Card {
            icon: told.icon(),
            word: told.word(&words.case),
            colour: told.colour(&Palette::of(ui)),
            count: &of_run,
            headline: &fill(told.headline(&words.case), &said),
        };
        card.show(ui, |ui| {
            ui.label(conclusion);
            next_check(ui, context, answer);
            let report = Face::new(Look::Secondary, words.diagnosis.report);
            if report.icon(ICON_DESCRIPTION).show(ui).clicked() {
                context.go_to.push(Destination::Report(run.id));
            }
        });
    }
}

fn next_check(ui: &mut Ui, context: &mut PageContext<'_>, answer: &Answer) {
    let words = &context.words.diagnosis;
    let Some(next) = &answer.diagnosis.next_check else {
        ui.label(RichText::new(words.settled).color(Palette::of(ui).quiet));
        return;
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(words.next_check);
        ui.label(RichText::new(context.words.check(&next.check)).strong());
        let bits = format!("{:.2}", next.gain_bits);
        let time = format!("{:.0} s", next.cost_s);
        let gains = fill(words.gains, &[("bits", &bits), ("time", &time)]);
        ui.label(RichText::new(gains).color(Palette::of(ui).quiet));
        if ui.button(RichText::new(words.run_it).strong()).clicked() {
            context.go_to.push(Destination::Run(Wanted::Step {
                procedure: next.check.procedure.clone(),
                step: next.check.step.clone(),
                unit: answer.run.run.unit_serial.clone(),
            }));
        }
    });
}
