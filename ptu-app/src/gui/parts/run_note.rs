//! A form for a note on a run.

use eframe::egui::{Button, Ui};
use fault_db::Id;

use crate::gui::messages::Messages;
use crate::gui::parts::note_edit;
use crate::gui::query_worker::QueryWorker;
use crate::gui::request::Request;
use ptu_bench::clock::now_us;
use ptu_report::words::Words;

/// Room for the button, points.
const BUTTON: f32 = 130.0;

/// The field and what becomes of it.
#[derive(Default)]
pub struct RunNoteForm {
    text: String,
    run: Option<Id>,
    /// Answers with the run that was noted on.
    under_way: Request<Id>,
}

impl RunNoteForm {
    /// The run on which a note has just been stored.
    pub fn poll(&mut self, words: &Words, messages: &mut Messages) -> Option<Id> {
        if !self.under_way.poll() {
            return None;
        }
        match std::mem::take(&mut self.under_way) {
            Request::Failed(why) => {
                messages.trouble(words.report.note_not_saved, why);
                None
            }
            Request::Ready(noted) => {
                messages.note(words.report.note_saved);
                if self.run == Some(noted) {
                    self.text.clear();
                }
                Some(noted)
            }
            Request::Idle | Request::Pending(_) => None,
        }
    }

    /// The field with its button, for this run.
    pub fn show(&mut self, ui: &mut Ui, words: &Words, queries: &QueryWorker, who: &str, run: Id) {
        if self.run != Some(run) {
            // What was begun on another run is not meant for this one.
            self.run = Some(run);
            self.text.clear();
        }
        let label = ui.label(words.report.note_field);
        let left = ui.available_size_before_wrap().x;
        let wide = (left - BUTTON).max(BUTTON);
        ui.add(note_edit(&mut self.text, wide))
            .labelled_by(label.id);
        let (who, text) = (who.trim().to_owned(), self.text.trim().to_owned());
        let writes = !queries.paths().is_server();
        let may = writes && !who.is_empty() && !text.is_empty() && self.under_way.is_idle();
        let why = match writes {
            true => words.report.note_hint,
            false => words.care.is_server,
        };
        let save = ui.add_enabled(may, Button::new(words.report.note_save));
        if save.on_disabled_hover_text(why).clicked() {
            self.under_way = Request::Pending(queries.run(move |paths| {
                paths.open()?.add_run_note(run, &who, &text, now_us())?;
                Ok(run)
            }));
        }
    }
}
