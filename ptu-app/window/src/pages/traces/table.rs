//! Statistics of the signals between the cursors or in view.

use eframe::egui::{Grid, RichText, ScrollArea, Ui};

use super::bar;
use ptu_report::trace_view::statistics::Statistics;
use ptu_report::trace_view::value::{named, number};
use ptu_report::trace_view::{Cursor, TracePlot};
use ptu_report::words::{Words, fill};

/// Most states whose shares are listed; a counter could have as many states as rows.
const STATES: usize = 4;

pub fn statistics(ui: &mut Ui, scene: &mut TracePlot, words: &Words) {
    let traces = &words.traces;
    let (rows, between) = scene.stretch_rows();
    let length = scene.axis.at(rows.end.saturating_sub(1)) - scene.axis.at(rows.start);
    let length = bar::length(scene, length);
    let over = if between {
        traces.between_cursors
    } else {
        traces.in_view
    };
    ui.label(RichText::new(fill(over, &[("length", &length)])).strong());
    let statistics = scene.statistics().to_vec();
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        Grid::new("statistics")
            .striped(true)
            .spacing([16.0, 3.0])
            .show(ui, |ui| {
                for head in [
                    traces.signal,
                    "A",
                    "B",
                    "B − A",
                    traces.least,
                    traces.greatest,
                    traces.mean,
                    traces.rms,
                    traces.changes,
                    traces.shares,
                ] {
                    ui.label(RichText::new(head).strong());
                }
                ui.end_row();
                for (lane, statistics) in scene.lanes.iter().zip(&statistics) {
                    ui.label(&lane.signal);
                    match (lane.place, statistics) {
                        (Some(place), Some(statistics)) => {
                            row(ui, scene, place, statistics, words);
                        }
                        _ => {
                            ui.label(traces.not_in_trace);
                        }
                    }
                    ui.end_row();
                }
            });
    });
}

fn row(ui: &mut Ui, scene: &TracePlot, place: usize, statistics: &Statistics, words: &Words) {
    let channel = scene.view().channel(place);
    for cursor in [Cursor::A, Cursor::B] {
        let value = scene.value(place, cursor);
        ui.label(value.map_or_else(String::new, |v| named(channel, v, words)));
    }
    ui.label(difference(scene, place));
    match statistics {
        Statistics::Quantity {
            low,
            high,
            mean,
            rms,
        } => {
            for value in [low, high, mean, rms] {
                ui.label(number(*value, &channel.unit));
            }
        }
        Statistics::States { changes, shares } => {
            for _ in 0..4 {
                ui.label("");
            }
            ui.label(changes.to_string());
            let told = shares.iter().take(STATES).map(|(value, share)| {
                format!("{} {:.1} %", named(channel, *value, words), share * 100.0)
            });
            let mut told: Vec<_> = told.collect();
            if shares.len() > STATES {
                told.push("…".into());
            }
            ui.label(told.join(", "));
        }
        Statistics::Unknown => {
            ui.label(words.traces.not_known);
        }
    }
}

/// Text: value at cursor B minus value at cursor A of a quantity; empty for other signals.
pub fn difference(scene: &TracePlot, place: usize) -> String {
    let channel = scene.view().channel(place);
    match scene.difference(place) {
        Some(value) if !value.is_nan() => number(value, &channel.unit),
        _ => String::new(),
    }
}
