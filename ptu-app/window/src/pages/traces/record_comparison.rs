//! Comparison of a run in a unit's run record with its target and a sound unit's run: the button, and the result.

use eframe::egui::Ui;
use fault_db::Id;

use crate::PageContext;
use crate::parts::{Face, Look, dialog, last_row};
use crate::request::Request;
use ptu_report::record;
use ptu_report::trace_view::TracePlot;
use ptu_runs::record::CompareRequest;

#[derive(Default)]
pub struct RecordComparison {
    of: Option<Id>,
    found: Request<String>,
}

impl RecordComparison {
    /// Draws the button, for a trace from a unit's run record, and the result.
    pub fn bar(&mut self, ui: &mut Ui, scene: &TracePlot, context: &mut PageContext<'_>) {
        let opened = &scene.opened;
        if self.of != Some(opened.id) {
            *self = Self {
                of: Some(opened.id),
                found: Request::Idle,
            };
        }
        let has = |name: &str| opened.view.data().column(name).is_some();
        // A unit's run record has its target and no limit; a bench's trace has every signal.
        if !has("target") || has("limit") {
            return;
        }
        let words = context.words;
        if self.found.poll()
            && let Request::Failed(why) = &self.found
        {
            context
                .messages
                .trouble(words.memory.not_compared, why.clone());
        }
        if matches!(self.found, Request::Pending(_)) {
            ui.label(words.memory.comparing);
        } else if ui.button(words.memory.compare).clicked() {
            let id = opened.id;
            self.found = Request::Pending(context.queries.run(move |paths| {
                let store = paths.read()?;
                let compared = CompareRequest::default().compare(&store, &paths.scripts, id)?;
                Ok(record::text(&compared))
            }));
        }
        if let Some(text) = self.found.value() {
            let mut close = false;
            let open = dialog(ui, "compared record", words.memory.compare, |ui| {
                ui.label(text);
                last_row(ui, |ui| {
                    let face = Face::new(Look::Secondary, words.frame.close_anyway);
                    close = face.show(ui).clicked();
                });
            });
            if close || !open {
                self.found = Request::Idle;
            }
        }
    }
}
