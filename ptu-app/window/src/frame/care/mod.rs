//! Maintenance of the history: sync with a server, import of another file, backup, check.

mod work;

use crate::request::FollowingResponse;
use std::path::PathBuf;

use eframe::egui::{Button, RichText, Ui};
use fault_db::{Address, LastSync};

use crate::parts::{Face, Job, Look, caption, dialog, last_row, path_edit, typed};
use crate::{PageContext, Palette};
use ptu_report::words::fill;
use ptu_runs::clock;

/// Width of the dialog's fields, points.
const FIELD: f32 = 380.0;

/// State of the dialog and of its work.
#[derive(Default)]
pub struct HistoryMaintenance {
    open: bool,
    address: String,
    /// An address has been proposed; it is not proposed again over a typed one.
    proposed: bool,
    without_traces: bool,
    file: String,
    job: Job,
    last: FollowingResponse<(), Vec<LastSync>>,
}

impl HistoryMaintenance {
    pub fn open(&mut self) {
        self.open = true;
    }

    /// Takes results that have arrived, and shows the dialog while it is open.
    pub fn show(&mut self, ui: &Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        if self.job.poll(context, words.care.failed) {
            self.last.read_again();
        }
        if !self.open {
            return;
        }
        if context.only_reads().is_none() {
            (self.last).keep_up(((), true), context, |paths, ()| {
                Ok(paths.read()?.last_syncs()?)
            });
        }
        let mut closed = false;
        self.open = dialog(ui, "care", words.care.title, |ui| {
            self.contents(ui, context);
            last_row(ui, |ui| {
                closed = Face::new(Look::Quiet, words.frame.close_anyway)
                    .show(ui)
                    .clicked();
            });
        }) && !closed;
    }

    fn contents(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        if context.settings.is_locked() {
            super::only_look(ui);
        }
        let file = context.queries.paths.database.display().to_string();
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(words.care.file).color(Palette::of(ui).quiet));
            ui.label(file);
        });
        if self.job.is_under_way() {
            // A server's check is short, and cannot be stopped.
            let stops = context.only_reads().is_none();
            self.job.progress(ui, words, stops);
        } else {
            self.job.result(ui);
        }
        ui.separator();
        if let Some(why) = context.only_reads() {
            ui.label(why);
            let check = ui.add_enabled(!self.job.is_under_way(), Button::new(words.care.check));
            if check.clicked() {
                work::check(&mut self.job, context);
            }
            return;
        }
        self.sync(ui, context);
        ui.separator();
        self.files(ui, context);
        let (faults, traces) = (words.faults.title, words.traces.title);
        let logs = fill(words.care.logs, &[("faults", &faults), ("traces", &traces)]);
        ui.label(RichText::new(logs).color(Palette::of(ui).quiet));
    }

    fn sync(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = &context.words.care;
        let last = self.last.get().shown(ui, context.words);
        if last.is_some_and(Vec::is_empty) {
            ui.label(words.never_synced);
        }
        for sync in last.into_iter().flatten() {
            let at = clock::local(sync.at_us);
            let said = [
                ("at", &at as &dyn std::fmt::Display),
                ("server", &sync.server),
                ("n", &sync.waiting),
            ];
            ui.label(fill(words.last_synced, &said));
        }
        if let (false, Some(last)) = (self.proposed, last) {
            // The last typed address comes first: the stored one may not be the address by which this computer reaches
            // the server.
            let latest = last.first().map(|sync| sync.server.clone());
            let typed = typed(&context.settings.server);
            self.address = typed.or(latest).unwrap_or_default();
            self.proposed = true;
        }
        let address = &mut self.address;
        ui.horizontal_wrapped(|ui| {
            let label = ui.label(words.server);
            ui.add(path_edit(address, FIELD))
                .labelled_by(label.id)
                .on_hover_text(words.address_hint);
        });
        let parsed = address.trim().parse::<Address>();
        let mut with_traces = !self.without_traces;
        let why_not = match (self.job.is_under_way(), &parsed) {
            (true, _) => Some(words.under_way),
            (false, Err(_)) => Some(words.address_hint),
            (false, Ok(_)) => None,
        };
        let clicked = ui.horizontal_wrapped(|ui| {
            ui.checkbox(&mut with_traces, words.with_traces);
            let sync = Face::new(Look::Secondary, words.sync).off(why_not);
            sync.show(ui).clicked()
        });
        self.without_traces = !with_traces;
        if let (true, Ok(parsed)) = (clicked.inner, parsed) {
            context.settings.server = match parsed.has_password() {
                true => parsed.to_string(),
                false => address.trim().to_owned(),
            };
            let address = parsed;
            work::sync(&mut self.job, context, address, with_traces);
        }
    }

    fn files(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = &context.words.care;
        ui.horizontal_wrapped(|ui| {
            let label = ui.label(words.other_file);
            ui.add(path_edit(&mut self.file, FIELD))
                .labelled_by(label.id);
        });
        let file = typed(&self.file).map(PathBuf::from);
        let (free, unnamed) = (!self.job.is_under_way(), context.words.report.name_file);
        ui.horizontal_wrapped(|ui| {
            let busy = (!free).then_some(words.under_way);
            let why_not = busy.or_else(|| file.is_none().then_some(unnamed));
            let button = |name, why_not| Face::new(Look::Secondary, name).because(why_not);
            let import = button(words.import, why_not).show(ui);
            let backup = button(words.backup, why_not).show(ui);
            let check = button(words.check, busy).show(ui);
            if let Some(why) = why_not {
                caption(ui, why);
            }
            if check.clicked() {
                work::check(&mut self.job, context);
            }
            let Some(file) = file else { return };
            if import.clicked() {
                work::import(&mut self.job, context, file);
            } else if backup.clicked() {
                work::backup(&mut self.job, context, file);
            }
        });
    }
}
