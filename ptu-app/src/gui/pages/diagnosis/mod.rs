//! Diagnosis: the part to replace, why, and what to check next.

mod candidates;

use eframe::egui::{CentralPanel, Panel, RichText, ScrollArea, Ui};
use fault_db::Id;
use protocol::injection::Lru;

use crate::gui::parts::RunList;
use crate::gui::request::Request;
use crate::gui::{Destination, PageContext, Palette};
use ptu_bench::clock;
use ptu_bench::run_diagnosis::{Answer, diagnose_run};
use ptu_report::words::{Language, Words, fill};

/// Size of the conclusion, points: it is read first, and may fill two lines.
const HEADLINE: f32 = 20.0;

#[derive(Default)]
pub struct DiagnosisPage {
    runs: RunList,
    run: Option<Id>,
    answer: Request<NamedAnswer>,
}

/// An answer, and what people call the parts.
pub struct NamedAnswer {
    answer: Answer,
    parts: Vec<Lru>,
}

impl NamedAnswer {
    /// What people call a part, in their language.
    fn part(&self, id: &str, words: &Words) -> String {
        let known = self.parts.iter().find(|part| part.id == id);
        let name = known.map(|part| match words.language {
            Language::English => part.name.clone(),
            Language::Korean => part.name_ko.clone(),
        });
        name.unwrap_or_default()
    }
}

impl DiagnosisPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.answer.poll();
        let list = Panel::left("diagnosed runs").default_size(270.0);
        let run = list.show(ui, |ui| self.runs.show(ui, context)).inner;
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
            Request::Pending(context.queries.run(move |paths| {
                Ok(NamedAnswer {
                    answer: diagnose_run(&paths.read()?, &paths.scripts, run)?,
                    parts: paths.scripts.faults()?.lrus,
                })
            }))
        });
    }

    fn answer(&self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = &context.words.diagnosis;
        let palette = Palette::of(ui);
        let named = match &self.answer {
            Request::Ready(named) => named,
            Request::Idle => {
                ui.label(words.choose_run);
                return;
            }
            Request::Pending(_) => {
                ui.spinner();
                return;
            }
            Request::Failed(why) => {
                ui.label(RichText::new(words.no_answer).color(palette.bad).strong());
                ui.label(why);
                return;
            }
        };
        let answer = &named.answer;
        self.head(ui, context, answer);
        for warning in &answer.warnings {
            ui.label(RichText::new(format!("⚠ {warning}")).color(palette.warn));
        }
        ui.separator();
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
            &[
                ("run", &run.id.short()),
                ("unit", &run.unit_serial),
                ("time", &time),
            ],
        );
        ui.label(RichText::new(of_run).color(Palette::of(ui).quiet));
        let conclusion = words.sentence(&answer.diagnosis.conclusion);
        ui.label(RichText::new(conclusion).strong().size(HEADLINE));
        next_check(ui, context, answer);
        if ui.button(words.diagnosis.report).clicked() {
            context.go_to.push(Destination::Report(run.id));
        }
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
        let check = next.check.to_string();
        ui.label(RichText::new(context.words.content(&check)).strong());
        let gains = fill(
            words.gains,
            &[
                ("bits", &format!("{:.2}", next.gain_bits)),
                ("time", &format!("{:.0} s", next.cost_s)),
            ],
        );
        ui.label(RichText::new(gains).color(Palette::of(ui).quiet));
        if ui.button(RichText::new(words.run_it).strong()).clicked() {
            context.go_to.push(Destination::RunStep {
                procedure: next.check.procedure.clone(),
                step: next.check.step.clone(),
                unit: answer.run.run.unit_serial.clone(),
            });
        }
    });
}
