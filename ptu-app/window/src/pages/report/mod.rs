//! The test sheet of a run: shown as it will be printed, and written to a file.

mod compare;
mod file;
mod sheet_of;
mod strip;

use std::path::PathBuf;

use eframe::egui::{CentralPanel, RichText, Ui};
use egui_material_icons::icons::ICON_DESCRIPTION;
use fault_db::{Id, RunDetail};

use crate::parts::{NoteOn, RunList, RunNoteForm, Side, empty, show_sheet};
use crate::request::Request;
use crate::{PageContext, Palette};
use compare::ComparedWith;
use ptu_report::naming::PartNames;
use ptu_report::run::page::{Page, pages};
use ptu_report::run::{CaseSheet, RunComparison, Sheet, SheetTrace};
use ptu_report::words::{Language, fill};
pub use sheet_of::SheetOf;

#[derive(Default)]
pub struct ReportPage {
    runs: RunList,
    /// The requested sheet, and the sheet shown until the requested one has arrived.
    asked: Request<Shown>,
    shown: Option<Shown>,
    asked_for: Option<Asked>,
    /// Version of the data at the request.
    version: (usize, u64),
    /// Number of the window's drawing pass in which the page was last shown.
    pass: u64,
    /// Language of the sheet; none = the window's.
    language: Option<Language>,
    file: String,
    writing: Request<PathBuf>,
    /// File to which the shown sheet was written last.
    written: Option<PathBuf>,
    note: RunNoteForm,
    with: ComparedWith,
}

/// Choice of a sheet: what it is of, its language and its depot.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Asked {
    of: SheetOf,
    language: Language,
    depot: String,
}

struct Shown {
    of: SheetOf,
    pages: Vec<Page>,
    /// Traces of the run, each with the faults it shows.
    traces: Vec<(Id, String)>,
    /// A step did not pass, or the run has faults.
    faulty: bool,
}

impl ReportPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let run = self.runs.show(ui, context);
        let of = run.map(|run| self.with.sheet_of(run));
        self.keep_up(ui, context, of);
        if self.shown.is_some() {
            let strip = Side {
                name: context.words.report.strip,
                wide: [232.0, 280.0],
                at_right: true,
            };
            strip.show_open(ui, |ui| self.strip(ui, context));
        }
        CentralPanel::default().show(ui, |ui| {
            self.runs.tell_other_unit(ui, context.words);
            self.sheet(ui, context);
        });
    }

    pub fn open(&mut self, run: Id, context: &mut PageContext<'_>) {
        self.runs.choose(run, context);
        self.with = ComparedWith::default();
        self.ask(SheetOf::Run(run), context);
    }

    /// Shows this sheet, without the list of runs.
    pub fn show_one(&mut self, of: SheetOf, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.keep_up(ui, context, Some(of));
        if self.shown.is_some() {
            self.files(ui, context);
        }
        self.sheet(ui, context);
    }

    /// Requests the sheet of another run, and the same sheet again when something may have been added to it: the data
    /// have changed, or the page was not shown for a while.
    fn keep_up(&mut self, ui: &Ui, context: &PageContext<'_>, of: Option<SheetOf>) {
        let pass = ui.ctx().cumulative_pass_nr();
        let away = pass > self.pass + 1;
        let pending = matches!(self.asked, Request::Pending(_));
        let again = (away || context.data_version() != self.version) && !pending;
        self.pass = pass;
        let Some(of) = of else {
            (self.asked, self.shown, self.asked_for) = (Request::Idle, None, None);
            return;
        };
        if again || self.asked_for.as_ref() != Some(&self.wanted(of, context)) {
            self.ask(of, context);
        }
    }

    fn ask(&mut self, of: SheetOf, context: &PageContext<'_>) {
        if self.asked_for.as_ref().is_none_or(|asked| asked.of != of) {
            self.shown = None;
            self.file = file::named_after(of, &self.file);
            self.written = None;
        }
        let wanted = self.wanted(of, context);
        self.asked_for = Some(wanted.clone());
        self.version = context.data_version();
        self.asked = Request::Pending(context.queries.run(move |paths| {
            let store = paths.read()?;
            let scripts = &paths.scripts;
            let words = wanted.language.words();
            let shown = |pages, run: &RunDetail, traces: Option<&[SheetTrace]>| {
                let seen = store.run_occurrences(run.run.id)?;
                let parts = PartNames::of(scripts);
                let shows = |trace: Id| {
                    let shown = seen.iter().filter(|seen| seen.trace_id == Some(trace));
                    let said = shown
                        .map(|seen| parts.fault(&seen.lru, (&seen.findings, &seen.message), words));
                    said.collect::<Vec<_>>().join("; ")
                };
                let traces = traces.unwrap_or_default().iter();
                let run = &run.run;
                Ok(Shown {
                    of,
                    pages,
                    traces: traces.map(|trace| (trace.id, shows(trace.id))).collect(),
                    faulty: run.recorded.not_passed() + run.recorded.outside > 0 || run.faults > 0,
                })
            };
            match of {
                SheetOf::Run(run) => {
                    let sheet = Sheet::gather(&store, scripts, run)?;
                    shown(pages(&sheet, words)?, &sheet.run, Some(&sheet.traces))
                }
                SheetOf::Case { fault, .. } => {
                    let case = CaseSheet::gather(&store, scripts, fault, &wanted.depot, false)?;
                    let last = case.last();
                    shown(pages(&case, words)?, &last.run, Some(&last.traces))
                }
                SheetOf::Compared { before, after, all } => {
                    let compared = RunComparison::gather(&store, before, after, all)?;
                    shown(pages(&compared, words)?, &compared.b, None)
                }
            }
        }));
    }

    /// The run of the requested sheet: alone, or the last run of a case.
    fn run(&self) -> Option<Id> {
        self.asked_for.as_ref().map(|asked| asked.of.run())
    }

    fn wanted(&self, of: SheetOf, context: &PageContext<'_>) -> Asked {
        Asked {
            of,
            language: self.language(context),
            depot: context.settings.depot.clone(),
        }
    }

    /// The sheet's language.
    fn language(&self, context: &PageContext<'_>) -> Language {
        self.language.unwrap_or(context.words.language)
    }

    /// Takes responses that have arrived, whichever page is shown.
    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        if self.asked.poll() {
            match std::mem::take(&mut self.asked) {
                Request::Ready(shown) => self.shown = Some(shown),
                other => self.asked = other,
            }
        }
        let words = &context.words.report;
        if let Some(path) = self.writing.take(words.not_written, context.messages) {
            let said = fill(words.written, &[("file", &path.display())]);
            context.messages.note(said);
            self.written = Some(path);
        }
        if let Some(noted) = self.note.poll(context.words, context.messages)
            && self.run().map(NoteOn::Run) == Some(noted)
            && let Some(asked) = &self.asked_for
        {
            self.ask(asked.of, context);
        }
    }

    fn sheet(&self, ui: &mut Ui, context: &PageContext<'_>) {
        let words = context.words;
        if let Request::Failed(why) = &self.asked {
            let said = RichText::new(words.report.not_read).color(Palette::of(ui).bad);
            ui.label(said.strong());
            ui.label(&*context.words.trouble(why));
            return;
        }
        match (&self.shown, &self.asked) {
            (Some(shown), _) => show_sheet(ui, shown.of.run(), &shown.pages),
            (None, Request::Pending(_)) => drop(ui.label(words.common.loading)),
            (None, _) => {
                let missing = (words.report.choose_run, "");
                empty(ui, ICON_DESCRIPTION, missing, None);
            }
        }
    }
}
