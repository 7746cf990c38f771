//! The test sheet of a run: shown as it will be printed, and written to a file.

mod bar;
mod drawing;
mod file;
mod flow;
mod paper;
mod ruler;

use std::path::PathBuf;

use eframe::egui::{CentralPanel, Panel, RichText, Ui};
use fault_db::Id;

use crate::gui::library::Asked;
use crate::gui::parts::{RunList, RunNoteForm};
use crate::gui::{Desk, Palette};
use crate::report::run::{Block, Sheet, blocks};
use crate::words::{Language, fill};
use paper::Paper;

/// The page.
#[derive(Default)]
pub struct ReportPage {
    runs: RunList,
    /// None = the foremost.
    chosen: Option<Id>,
    /// The sheet asked for, and the one shown until that is there.
    asked: Asked<Shown>,
    shown: Option<Shown>,
    asked_for: Option<(Id, Language)>,
    /// Runs that had ended when it was asked for.
    ended: usize,
    /// When the page was last shown, in passes of the window.
    pass: u64,
    /// Language of the sheet; none = the window's.
    language: Option<Language>,
    paper: Paper,
    file: String,
    writing: Asked<PathBuf>,
    note: RunNoteForm,
}

/// A sheet.
struct Shown {
    run: Id,
    blocks: Vec<Block>,
    /// Its traces with the faults each shows.
    traces: Vec<(Id, String)>,
    /// Something in it did not pass.
    faulty: bool,
}

impl ReportPage {
    /// Shows it.
    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        self.poll(desk);
        let list = Panel::left("reported runs").default_size(270.0);
        let shown = self.run();
        let clicked = list.show(ui, |ui| self.runs.show(ui, desk, shown)).inner;
        self.chosen = clicked.or(self.chosen);
        self.keep_up(ui, desk);
        CentralPanel::default().show(ui, |ui| self.sheet(ui, desk));
    }

    /// Shows this one.
    pub fn open(&mut self, run: Id, desk: &mut Desk<'_>) {
        self.chosen = Some(run);
        self.ask(run, desk);
    }

    /// Asks when another run is to be shown, and anew when something may have been added to this one:
    /// a run has ended, or the page was away.
    fn keep_up(&mut self, ui: &Ui, desk: &Desk<'_>) {
        let (pass, ended) = (ui.ctx().cumulative_pass_nr(), desk.units.runs_ended());
        let away = pass > self.pass + 1 && !matches!(self.asked, Asked::Pending(_));
        let anew = away || ended != self.ended;
        self.pass = pass;
        let Some(run) = self.chosen.or_else(|| self.runs.foremost()) else {
            return;
        };
        if anew || self.asked_for != Some((run, self.language(desk))) {
            self.ask(run, desk);
        }
    }

    fn ask(&mut self, run: Id, desk: &Desk<'_>) {
        if self.run() != Some(run) {
            self.shown = None;
            self.file = file::named_after(run, &self.file);
        }
        let language = self.language(desk);
        self.asked_for = Some((run, language));
        self.ended = desk.units.runs_ended();
        self.asked = Asked::Pending(desk.library.ask(move |shelf| {
            let sheet = Sheet::gather(&shelf.read()?, Some(&shelf.scripts), run)?;
            Ok(Shown::of(&sheet, language))
        }));
    }

    /// The run that is shown or will be.
    fn run(&self) -> Option<Id> {
        self.asked_for.map(|(run, _)| run)
    }

    /// The sheet's language.
    fn language(&self, desk: &Desk<'_>) -> Language {
        self.language.unwrap_or(desk.words.language)
    }

    fn poll(&mut self, desk: &mut Desk<'_>) {
        if self.asked.poll() {
            match std::mem::take(&mut self.asked) {
                Asked::There(shown) => {
                    self.shown = Some(shown);
                    self.paper = Paper::default();
                }
                other => self.asked = other,
            }
        }
        if self.writing.poll() {
            match std::mem::take(&mut self.writing) {
                Asked::There(path) => {
                    let file = path.display();
                    let said = fill(desk.words.report.written, &[("file", &file)]);
                    desk.messages.tell(said);
                }
                Asked::Failed(why) => desk.messages.trouble(desk.words.report.not_written, why),
                Asked::Not | Asked::Pending(_) => {}
            }
        }
        if let Some(noted) = self.note.poll(desk.words, desk.messages)
            && self.run() == Some(noted)
        {
            self.ask(noted, desk);
        }
    }

    fn sheet(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let words = desk.words;
        if let Asked::Failed(why) = &self.asked {
            let said = RichText::new(words.report.not_read).color(Palette::of(ui).bad);
            ui.label(said.strong());
            ui.label(why);
            return;
        }
        if self.shown.is_none() {
            ui.label(match self.asked {
                Asked::Pending(_) => words.common.loading,
                _ => words.report.choose_run,
            });
            return;
        }
        self.bar(ui, desk);
        ui.separator();
        if let Some(shown) = &self.shown {
            self.paper.show(ui, shown.run, &shown.blocks);
        }
    }
}

impl Shown {
    fn of(sheet: &Sheet, language: Language) -> Self {
        let run = &sheet.run.run;
        let traces = sheet.traces.iter();
        Self {
            run: run.id,
            blocks: blocks(sheet, language.words()),
            traces: traces
                .map(|trace| (trace.id, trace.faults.join(", ")))
                .collect(),
            faulty: run.steps_not_passed > 0 || run.faults > 0,
        }
    }
}
