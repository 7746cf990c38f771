//! The strip beside the sheet: its language, the run to compare with, links, a note, and files.

use eframe::egui::{Label, Popup, RichText, ScrollArea, Ui};
use egui_material_icons::icons::{
    ICON_KEYBOARD_ARROW_DOWN, ICON_PRINT, ICON_SHOW_CHART, ICON_TROUBLESHOOT,
};

use super::{ReportPage, SheetOf, Shown, file};
use crate::data_paths::DataPaths;
use crate::messages::told;
use crate::parts::{
    ActionPlace, Face, Look, NoteOn, caption, file_place, foot, open_file, segments,
};
use crate::request::Request;
use crate::{Destination, PageContext, Palette};
use ptu_report::words::{Language, Words, fill};

/// File types that can be written; the first has the main button.
const ENDINGS: [(Look, &str); 3] = [
    (Look::Primary, ".pdf"),
    (Look::Secondary, ".html"),
    (Look::Secondary, ".csv"),
];

impl ReportPage {
    pub(super) fn strip(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        let before = self.language(context);
        let mut language = before;
        foot(ui, "files of a sheet", |ui| {
            self.file_place(ui, words);
            ui.horizontal_wrapped(|ui| self.buttons(ui, context));
            self.open_written(ui, context);
        });
        let Some(shown) = &self.shown else { return };
        let of = shown.of;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            caption(ui, words.report.language);
            segments(ui, &mut language, Language::ALL.map(|of| (of, of.name())));
            if language != before {
                self.language = Some(language);
            }
            if !matches!(of, SheetOf::Case { .. }) {
                self.with.show(ui, words, of, &self.runs);
            }
            ui.separator();
            ways_on(ui, words, shown, context.go_to);
            ui.separator();
            let who = &context.settings.operator;
            let on = NoteOn::Run(of.run());
            self.note.show(ui, words, context.queries, who, on);
        });
    }

    /// Draws the buttons that write the sheet, in one row, and below them the written file.
    pub(super) fn files(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        ui.horizontal(|ui| {
            self.buttons(ui, context);
            self.file_place(ui, words);
        });
        self.open_written(ui, context);
    }

    fn file_place(&mut self, ui: &mut Ui, words: &Words) {
        let said = (words.report.file, words.report.write_hint);
        file_place(ui, &mut self.file, said);
    }

    fn buttons(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        let busy = (!self.writing.is_idle()).then_some(words.report.writing);
        let place = ActionPlace::new(ui, "files of a sheet", self.run());
        for (look, ending) in ENDINGS {
            let face = Face::new(look, name_of(words, ending)).because(busy);
            if place.clicked(&face.show(ui)) {
                self.write(context, ending);
            }
        }
    }

    /// The written file, with a button to open it, for reading or printing.
    fn open_written(&self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = &context.words.report;
        let Some(path) = &self.written else { return };
        ui.horizontal_wrapped(|ui| {
            let open = Face::new(Look::Secondary, words.open_file).icon(ICON_PRINT);
            if open.show(ui).clicked()
                && let Err(failure) = open_file(path)
            {
                context.messages.trouble(words.not_opened, failure.message);
            }
            let file = RichText::new(path.display().to_string());
            ui.add(Label::new(file.color(Palette::of(ui).quiet)).truncate());
        });
    }

    fn write(&mut self, context: &mut PageContext<'_>, ending: &str) {
        let words = &context.words.report;
        let Some(asked) = self.asked_for.clone() else {
            return;
        };
        let Some(path) = file::with_ending(&self.file, ending) else {
            context
                .messages
                .trouble(words.not_written, told(words.name_file));
            return;
        };
        let write = move |paths: &DataPaths| file::write(paths, &asked, &path);
        self.writing = Request::Pending(context.queries.run(write));
    }
}

fn name_of(words: &Words, ending: &str) -> &'static str {
    match ending {
        ".html" => words.report.write_html,
        ".pdf" => words.report.write_pdf,
        _ => words.report.write_csv,
    }
}

/// Links to the diagnosis and to the traces.
fn ways_on(ui: &mut Ui, words: &Words, shown: &Shown, go_to: &mut Vec<Destination>) {
    let words = &words.report;
    let diagnosis = Face::new(Look::Quiet, words.to_diagnosis).icon(ICON_TROUBLESHOOT);
    let why_not = (!shown.faulty).then_some(words.all_right);
    if diagnosis.off(why_not).show(ui).clicked() {
        go_to.push(Destination::Diagnosis(shown.of.run()));
    }
    let trace = |name| Face::new(Look::Quiet, name).icon(ICON_SHOW_CHART);
    match &shown.traces[..] {
        [] => {}
        [(only, faults)] => {
            if trace(words.to_trace.to_owned())
                .hint(faults)
                .show(ui)
                .clicked()
            {
                go_to.push(Destination::Trace(*only));
            }
        }
        all => {
            let title = fill(words.to_traces, &[("n", &all.len())]);
            let menu = trace(title).end(ICON_KEYBOARD_ARROW_DOWN).show(ui);
            Popup::menu(&menu).show(|ui| {
                for (id, faults) in all {
                    if ui.button(faults).on_hover_text(id.to_string()).clicked() {
                        go_to.push(Destination::Trace(*id));
                    }
                }
            });
        }
    }
}
