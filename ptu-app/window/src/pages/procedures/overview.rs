//! The progress of several units side by side.

use eframe::egui::{Grid, Ui, vec2};

use crate::parts::{progress, progress_text, verdict_chip};
use crate::{PageContext, Palette};
use ptu_runs::bench_worker::Phase;

/// Draws a line for each unit, if there are several.
pub fn overview(ui: &mut Ui, context: &mut PageContext<'_>) {
    if context.units.count() < 2 {
        return;
    }
    let words = context.words;
    let mut choose = None;
    Grid::new("units")
        .num_columns(4)
        .striped(true)
        .show(ui, |ui| {
            for (place, unit) in context.units.iter().enumerate() {
                let chosen = place == context.units.chosen_place();
                let name = format!("{}: {}", place + 1, unit.name());
                if ui.selectable_label(chosen, name).clicked() {
                    choose = Some(place);
                }
                let phase = unit.phase();
                ui.label(match phase {
                    Phase::Offline => words.frame.not_connected,
                    Phase::Connecting => words.frame.connecting,
                    Phase::Idle | Phase::Running | Phase::MakingSafe => words.frame.connected,
                });
                let Some(run) = &unit.run else {
                    ui.end_row();
                    continue;
                };
                progress(ui, vec2(160.0, 8.0), run, words);
                ui.horizontal(|ui| {
                    if let Some(Some(outcome)) = &run.ended {
                        verdict_chip(ui, outcome.verdict, words);
                    }
                    let quiet = Palette::of(ui).quiet;
                    ui.colored_label(quiet, progress_text(run, words));
                });
                ui.end_row();
            }
        });
    if let Some(place) = choose {
        context.units.choose(place);
    }
}
