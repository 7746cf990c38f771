//! A list of runs to choose from, the latest first.

use eframe::egui::{RichText, ScrollArea, TextEdit, TextStyle, Ui};
use fault_db::{Id, RunFilter, RunState, RunSummary};

use super::chip;
use crate::gui::request::CachedResponse;
use crate::gui::request::Request;
use crate::gui::{PageContext, Palette};
use ptu_bench::clock;
use ptu_bench::process_id;
use ptu_report::words::Words;

/// As many runs as are listed.
const MOST: u32 = 2_000;

/// The list's own state.
#[derive(Default)]
pub struct RunList {
    runs: CachedResponse<Vec<RunSummary>>,
    /// Runs that had ended when it was asked for; none = not asked yet.
    ended: Option<usize>,
    find: String,
}

impl RunList {
    /// Shows it; the run that was clicked.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        context: &PageContext<'_>,
        chosen: Option<Id>,
    ) -> Option<Id> {
        self.keep_up(context);
        let words = context.words;
        ui.horizontal(|ui| {
            let label = ui.label(words.procedures.find);
            ui.add(TextEdit::singleline(&mut self.find).desired_width(110.0))
                .labelled_by(label.id);
            if ui.button(words.common.refresh).clicked() {
                self.ended = None;
            }
        });
        let runs = match self.runs.get() {
            Request::Ready(runs) => runs,
            Request::Failed(why) => {
                ui.label(RichText::new(why).color(Palette::of(ui).bad));
                return None;
            }
            Request::Idle | Request::Pending(_) => {
                ui.label(words.common.loading);
                return None;
            }
        };
        let find = self.find.trim().to_lowercase();
        let shown: Vec<_> = runs.iter().filter(|run| matches(run, &find)).collect();
        if shown.is_empty() {
            ui.label(words.common.nothing);
        }
        let height = 2.0 * ui.text_style_height(&TextStyle::Body) + 8.0;
        let mut clicked = None;
        ScrollArea::vertical().auto_shrink(false).show_rows(
            ui,
            height,
            shown.len(),
            |ui, range| {
                for run in shown.get(range).into_iter().flatten() {
                    if row(ui, words, run, chosen == Some(run.id)) {
                        clicked = Some(run.id);
                    }
                }
            },
        );
        clicked
    }

    /// The run to show when none was chosen: the latest that ended, since it is what the person has just
    /// done.
    pub fn foremost(&self) -> Option<Id> {
        let mut runs = self.runs.get().value()?.iter();
        Some(runs.find(|run| run.verdict.is_some())?.id)
    }

    /// Asks when it was not asked yet, and when a run has ended since.
    fn keep_up(&mut self, context: &PageContext<'_>) {
        let ended = context.units.runs_ended();
        if self.ended != Some(ended) {
            self.ended = Some(ended);
            self.runs.request(context.queries.run(|paths| {
                let filter = RunFilter {
                    limit: Some(MOST),
                    ..RunFilter::default()
                };
                Ok(paths.read()?.runs(&filter, &process_id::is_alive)?)
            }));
        }
        self.runs.poll();
    }
}

fn row(ui: &mut Ui, words: &Words, run: &RunSummary, chosen: bool) -> bool {
    let mut clicked = false;
    ui.horizontal(|ui| {
        let name = format!("{}  {}", run.id.short(), clock::local(run.started_at_us));
        clicked = ui.selectable_label(chosen, name).clicked();
    });
    ui.horizontal(|ui| {
        ui.add_space(14.0);
        let palette = Palette::of(ui);
        let common = &words.common;
        let (said, colour) = match (run.verdict, run.state) {
            (Some(verdict), _) => (
                common.stored_verdict(verdict),
                palette.stored_verdict(verdict),
            ),
            (None, RunState::Running) => (common.running, palette.accent),
            (None, _) => (common.interrupted, palette.warn),
        };
        chip(ui, said, colour);
        ui.label(RichText::new(&run.unit_serial).color(palette.quiet));
    });
    clicked
}

fn matches(run: &RunSummary, find: &str) -> bool {
    [
        run.id.to_string(),
        run.unit_serial.clone(),
        run.operator.clone(),
        run.line.clone(),
        clock::local(run.started_at_us),
        run.verdict
            .map(|verdict| verdict.to_string())
            .unwrap_or_default(),
    ]
    .iter()
    .any(|text| text.to_lowercase().contains(find))
}
