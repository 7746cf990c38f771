//! Automatic runs of a whole train with a simulated unit, from station to station, as `ptu drive` does them; figures
//! and plots are shown in the window.

mod form;

use std::sync::{Arc, Mutex};

use eframe::egui::{CentralPanel, ScrollArea, Ui};
use egui_material_icons::icons::ICON_TRAIN;

use crate::PageContext;
use crate::parts::{Done, Face, Job, Look, empty, foot, form, show_sheet};
use crate::request::Request;
use form::{Form, Offered};
use ptu_report::drive::Results;
use ptu_report::run::page::{Page, pages};
use ptu_report::words::{Language, fill};
use ptu_runs::drive::{Driven, drive_all};
use ptu_runs::pool::cores;
use ptu_runs::pool::held;

/// Slot into which the thread that computes the drives puts its results.
type Slot = Arc<Mutex<Option<Vec<Driven>>>>;

#[derive(Default)]
pub struct DrivePage {
    offered: Request<Offered>,
    form: Form,
    job: Job,
    driven: Slot,
    sheet: Option<Arc<Results>>,
    /// Number of the sheet; a new sheet is shown from its top.
    number: usize,
    pages: Request<Vec<Page>>,
    language: Option<Language>,
}

impl DrivePage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        self.poll(context);
        if form(ui, "drive", |ui| self.form(ui, context)) {
            self.begin(context);
        }
        CentralPanel::default().show(ui, |ui| {
            if self.job.is_under_way() {
                self.job.progress(ui, words, true);
                return;
            }
            self.job.result(ui);
            if self.pages.is_idle() {
                let missing = (words.drive.nothing, words.drive.explained);
                empty(ui, ICON_TRAIN, missing, None);
            } else if let Some(pages) = self.pages.shown(ui, words) {
                show_sheet(ui, ("drive", self.number), pages);
            }
        });
    }

    /// Form of the drive, and the button that begins it; true when the button was clicked.
    fn form(&mut self, ui: &mut Ui, context: &PageContext<'_>) -> bool {
        let words = context.words;
        let why_not = self.job.is_under_way().then_some(words.drive.under_way);
        let Request::Ready(offered) = &self.offered else {
            if (self.offered).missing(ui, words, words.drive.cannot_list) {
                self.offered = Request::Idle;
            }
            return false;
        };
        let begin = Face::new(Look::Primary, words.drive.drive).off(why_not);
        let asked = foot(ui, "begin to drive", |ui| begin.show(ui).clicked());
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.add_enabled_ui(why_not.is_none(), |ui| self.form.show(ui, words, offered));
        });
        asked
    }

    /// Takes results that have arrived, and has their sheet laid out in the window's language.
    fn poll(&mut self, context: &mut PageContext<'_>) {
        if self.offered.is_idle() {
            self.offered = Request::Pending(context.queries.run(Offered::read));
        }
        self.offered.poll();
        if self.job.poll(context, context.words.drive.cannot_drive) {
            let mut driven = held(&self.driven);
            let runs = driven.take().filter(|runs| !runs.is_empty());
            self.sheet = runs.map(|runs| Arc::new(Results::of_runs(runs)));
            (self.pages, self.language) = (Request::Idle, None);
            self.number += 1;
        }
        let language = context.words.language;
        if let Some(sheet) = self
            .sheet
            .clone()
            .filter(|_| self.language != Some(language))
        {
            self.language = Some(language);
            let laid = move |_: &_| pages(&*sheet, language.words());
            self.pages = Request::Pending(context.queries.run(laid));
        }
        self.pages.poll();
    }

    fn begin(&mut self, context: &mut PageContext<'_>) {
        let words = context.words;
        let form = self.form.clone();
        self.driven = Slot::default();
        let slot = self.driven.clone();
        let told = (words.common.loading.to_owned(), words.drive.cannot_drive);
        self.job.begin(context, told, move |paths, told| {
            let cases = form.request()?.cases(&paths.scripts)?;
            let of = cases.len();
            let so_far = |wording, done: usize| fill(wording, &[("done", &done), ("of", &of)]);
            let mut tell = |done| told.say(so_far(words.drive.driving, done));
            let runs = drive_all(cases, cores(), &told.stop, &mut tell);
            let text = match runs.len() < of {
                true => so_far(words.drive.stopped, runs.len()),
                false => String::new(),
            };
            *held(&slot) = Some(runs);
            Ok(Done::all(text, Vec::new()))
        });
    }
}
