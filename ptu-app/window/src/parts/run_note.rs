//! A form for a note on a run, or at a place of a trace.

use eframe::egui::Ui;
use fault_db::{Id, TracePlace};

use crate::messages::Messages;
use crate::parts::{Face, Look, note_edit};
use crate::query_worker::QueryWorker;
use crate::request::Request;
use ptu_report::words::Words;
use ptu_runs::clock::now_us;

/// Width of the button, points.
const BUTTON: f32 = 130.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoteOn {
    Run(Id),
    Place(TracePlace),
}

impl NoteOn {
    /// Id of the run or the trace.
    fn id(self) -> Id {
        match self {
            Self::Run(run) => run,
            Self::Place(place) => place.trace,
        }
    }
}

/// The field for a note, and the note that is being stored.
#[derive(Default)]
pub struct RunNoteForm {
    text: String,
    /// The run or the trace that the text is meant for.
    on: Option<Id>,
    /// Response: the run or the place to which the note was added.
    under_way: Request<NoteOn>,
}

impl RunNoteForm {
    /// Takes the response: the run or place whose note has just been stored.
    pub fn poll(&mut self, words: &Words, messages: &mut Messages) -> Option<NoteOn> {
        let noted = self.under_way.take(words.report.note_not_saved, messages)?;
        messages.note(words.report.note_saved);
        if self.on == Some(noted.id()) {
            self.text.clear();
        }
        Some(noted)
    }

    /// The field with its button, for a note on `on` by `who`.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        words: &Words,
        queries: &QueryWorker,
        who: &str,
        on: NoteOn,
    ) {
        if self.on != Some(on.id()) {
            // Text typed for another run or trace is not meant for this one.
            self.on = Some(on.id());
            self.text.clear();
        }
        let label = ui.label(match on {
            NoteOn::Run(_) => words.report.note_field,
            NoteOn::Place(_) => words.traces.note_field,
        });
        let is_row = ui.layout().is_horizontal();
        let left = ui.available_size_before_wrap().x;
        let wide = if is_row {
            (left - BUTTON).max(BUTTON)
        } else {
            left
        };
        ui.add(note_edit(&mut self.text, wide))
            .labelled_by(label.id);
        let (who, text) = (who.trim().to_owned(), self.text.trim().to_owned());
        let writes = !queries.paths.is_server();
        let may = writes && !who.is_empty() && !text.is_empty() && self.under_way.is_idle();
        let why = match writes {
            true => words.report.note_hint,
            false => words.care.is_server,
        };
        let why_not = (!may).then_some(why);
        let save = Face::new(Look::Secondary, words.report.note_save);
        let save = match is_row {
            true => save.because(why_not),
            false => save.off(why_not),
        };
        if save.show(ui).clicked() {
            self.under_way = Request::Pending(queries.run(move |paths| {
                let store = paths.open()?;
                match on {
                    NoteOn::Run(run) => store.add_run_note(run, &who, &text, now_us())?,
                    NoteOn::Place(place) => store.add_trace_note(place, &who, &text, now_us())?,
                }
                Ok(on)
            }));
        }
    }
}
