//! Notes at places of the trace: a list, a flag at each place, and a field for a new note at cursor A.

use eframe::egui::{Rect, RichText, Sense, Stroke, Ui, pos2};
use fault_db::{Id, TracePlace};

use super::events::{self, FLAG};
use super::row::Sheet;
use crate::parts::{NoteOn, RunNoteForm, lane, link};
use crate::request::FollowingResponse;
use crate::{PageContext, Palette};
use ptu_report::trace_notes::TraceNote;
use ptu_report::trace_view::{Cursor, TracePlot, TraceView};
use ptu_runs::table::cut;

/// Characters of a note in the list; its tooltip has all of it.
const MOST: usize = 60;
/// Notes listed at most.
const LINKS: usize = 40;

/// The notes on the trace that is open.
#[derive(Default)]
pub struct TraceNotes {
    notes: FollowingResponse<Id, Vec<TraceNote>>,
    form: RunNoteForm,
}

impl TraceNotes {
    /// Reads the notes when another trace is open, a note was added, or the database has changed.
    pub fn poll(&mut self, trace: Id, context: &mut PageContext<'_>) {
        let words = context.words;
        if self.form.poll(words, context.messages).is_some() {
            self.notes.read_again();
        }
        self.notes
            .keep_up((trace, false), context, move |paths, trace| {
                Ok(TraceNote::all(&paths.read()?, trace, words)?)
            });
    }

    /// The list of notes, each a link to its place, and the field for a new note at cursor A.
    pub fn bar(&mut self, ui: &mut Ui, scene: &mut TracePlot, context: &mut PageContext<'_>) {
        let words = context.words;
        let quiet = Palette::of(ui).quiet;
        let notes = self.notes.items();
        if !notes.is_empty() {
            ui.horizontal_wrapped(|ui| {
                ui.label(RichText::new(words.report.notes).color(quiet));
                for (number, note) in (1..).zip(notes).take(LINKS) {
                    let text = format!("{number}  {} {}", note.time(), cut(&note.text, MOST));
                    if link(ui, text).on_hover_text(whole(note)).clicked()
                        && let Some(row) = row_of(note, scene.view())
                    {
                        let place = scene.axis.at(row);
                        scene.camera.centre(place);
                    }
                }
                if notes.len() > LINKS {
                    ui.label("…");
                }
            });
        }
        let Some(row) = scene.cursor(Cursor::A) else {
            return;
        };
        let view = scene.view();
        let rows = row as i64 - view.trigger_row() as i64;
        let place = TracePlace {
            trace: scene.opened.id,
            at_us: rows.saturating_mul(view.data().period_us),
        };
        ui.horizontal_wrapped(|ui| {
            let who = &context.settings.operator;
            self.form
                .show(ui, words, context.queries, who, NoteOn::Place(place));
        });
    }

    /// A flag with the note's number at each place in view; the tooltip has the text of the note.
    pub fn flags(&self, ui: &Ui, strip: Rect, lanes: Rect, sheet: &Sheet<'_>) {
        let ink = sheet.palette.ink;
        let ground = ui.visuals().window_fill;
        for (number, note) in (1..).zip(self.notes.items()) {
            let Some(row) = row_of(note, sheet.scene.view()) else {
                continue;
            };
            let x = lane::x_at(lanes, sheet.scene.window(), sheet.scene.axis.at(row));
            if !lanes.x_range().contains(x) {
                continue;
            }
            let line = Stroke::new(1.0, ink);
            ui.painter().vline(x, strip.bottom()..=lanes.bottom(), line);
            // To the right, so that a cursor's flag at the same place stays visible.
            let corner = pos2(x + FLAG / 2.0 + 1.0, strip.bottom() - FLAG);
            let flag = events::flag(ui.painter(), corner, &number.to_string(), ink, ground);
            let id = ui.scope_id().with(("note on the trace", number));
            ui.interact(flag, id, Sense::hover())
                .on_hover_text(whole(note));
        }
    }
}

/// The row at the note's time, if the trace reaches that far.
fn row_of(note: &TraceNote, view: &TraceView) -> Option<usize> {
    let data = &view.data();
    let rows = note.time_us.div_euclid(data.period_us);
    let row = rows.saturating_add(view.trigger_row() as i64);
    usize::try_from(row).ok().filter(|row| *row < data.rows())
}

/// The whole note, with time and author.
fn whole(note: &TraceNote) -> String {
    format!("{} · {}: {}", note.time(), note.who, note.text)
}
