//! The bar above the sheet: links to trace and diagnosis, language, files, and a note.

use eframe::egui::{Align2, Button, ComboBox, Label, RichText, TextEdit, Ui};

use super::{ReportPage, SheetOf, Shown, file};
use crate::data_paths::DataPaths;
use crate::messages::told;
use crate::parts::{NoteOn, named_combo, open_file};
use crate::request::Request;
use crate::{Destination, PageContext, Palette, Sizes};
use ptu_report::words::{Language, Words, fill};

/// Room for the buttons beside the file's name, points.
const BUTTONS: f32 = 190.0;

impl ReportPage {
    pub(super) fn bar(&mut self, ui: &mut Ui, brief: bool, context: &mut PageContext<'_>) {
        let words = context.words;
        let language = self.language(context);
        let Some(shown) = &self.shown else { return };
        let of = shown.of;
        if brief {
            ui.horizontal(|ui| self.files(ui, context));
            self.open_written(ui, context);
            return;
        }
        ui.horizontal_wrapped(|ui| {
            ways_on(ui, words, shown, context.go_to);
            if let Some(other) = languages(ui, words, language) {
                self.language = Some(other);
            }
            if !matches!(of, SheetOf::Case { .. }) {
                self.with.show(ui, words, of, &self.runs);
            }
        });
        ui.horizontal(|ui| self.files(ui, context));
        self.open_written(ui, context);
        ui.horizontal_wrapped(|ui| {
            let who = &context.settings.operator;
            self.note
                .show(ui, words, context.queries, who, NoteOn::Run(of.run()));
        });
    }

    fn files(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = &context.words.report;
        let label = ui.label(words.file);
        let buttons = BUTTONS * Sizes::of(ui).body / 14.0;
        let wide = (ui.available_width() - buttons).max(BUTTONS);
        let file = TextEdit::singleline(&mut self.file).align(Align2::LEFT_CENTER);
        ui.add(file.desired_width(wide)).labelled_by(label.id);
        for (name, ending) in [
            (words.write_html, ".html"),
            (words.write_pdf, ".pdf"),
            (words.write_csv, ".csv"),
        ] {
            let button = ui.add_enabled(self.writing.is_idle(), Button::new(name));
            if button.on_hover_text(words.write_hint).clicked() {
                self.write(context, ending);
            }
        }
        if !self.writing.is_idle() {
            ui.spinner();
            ui.label(words.writing);
        }
    }

    /// What was written, with the way to see and to print it.
    fn open_written(&self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = &context.words.report;
        let Some(path) = &self.written else { return };
        ui.horizontal(|ui| {
            if ui.button(words.open_file).clicked()
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

/// To the diagnosis and to the traces.
fn ways_on(ui: &mut Ui, words: &Words, shown: &Shown, go_to: &mut Vec<Destination>) {
    let words = &words.report;
    let diagnosis = ui.add_enabled(shown.faulty, Button::new(words.to_diagnosis));
    if diagnosis.clicked() {
        go_to.push(Destination::Diagnosis(shown.of.run()));
    }
    match &shown.traces[..] {
        [] => {}
        [(only, faults)] => {
            if ui.button(words.to_trace).on_hover_text(faults).clicked() {
                go_to.push(Destination::Trace(*only));
            }
        }
        all => {
            let title = fill(words.to_traces, &[("n", &all.len())]);
            ui.menu_button(title, |ui| {
                for (id, faults) in all {
                    if ui.button(faults).on_hover_text(id.to_string()).clicked() {
                        go_to.push(Destination::Trace(*id));
                    }
                }
            });
        }
    }
}

/// The language that was chosen.
fn languages(ui: &mut Ui, words: &Words, language: Language) -> Option<Language> {
    let mut chosen = None;
    ui.label(words.report.language);
    let combo = ComboBox::from_id_salt("language of the sheet").selected_text(language.name());
    let combo = combo.show_ui(ui, |ui| {
        for other in Language::ALL {
            if ui
                .selectable_label(other == language, other.name())
                .clicked()
            {
                chosen = Some(other);
            }
        }
    });
    named_combo(&combo.response, words.report.language, language.name());
    chosen
}
