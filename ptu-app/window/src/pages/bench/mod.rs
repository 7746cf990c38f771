//! The bench page: the unit live as in its cab, manual stimuli, and a rolling plot.
//!
//! [`live_copy`] copies the bench's state once per frame, [`forms`] turns the filled-in fields into stimuli;
//! neither uses widgets.

mod forms;
mod live;
mod live_copy;
mod plot;
mod rolling;
mod scale;
mod stimuli;
pub mod text;
mod track;

use std::collections::BTreeMap;

use eframe::egui::{Align, Frame, Layout, Margin, Panel, ScrollArea, Ui, vec2};

use crate::PageContext;
use forms::Forms;
use live::{View, view};
pub use live_copy::BenchSnapshot;
pub use plot::Plot;
use ptu_runs::bench_worker::Phase;
use ptu_runs::run::BenchSetup;
pub use rolling::chosen;
use stimuli::{StimuliGiven, StimulusPanel, stimuli};

/// Width of the panel of stimuli, points.
const STIMULI: f32 = 324.0;
/// Least height of log and plot, and height of their margins, points.
const LOWEST: f32 = 100.0;
const AROUND: f32 = 30.0;
/// Height by which the plot's heading exceeds the log's, points.
const HEADING: f32 = 8.0;
/// Share of the width that the log takes.
const LOG_SHARE: f32 = 0.4;

/// Forms of one unit's bench, and the stimuli given to it.
struct Sheet {
    /// Checksums of the unit's configuration and line.
    of: (u32, u32),
    /// Bench epoch in which the stimuli of `given` were given.
    bench_epoch: u64,
    forms: Forms,
    given: StimuliGiven,
}

#[derive(Default)]
pub struct BenchPage {
    /// Sheets by the unit's id.
    sheets: BTreeMap<u64, Sheet>,
    plot: Plot,
}

impl BenchPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.sheets
            .retain(|id, _| context.units.iter().any(|unit| unit.id == *id));
        let unit = context.units.chosen();
        let Some(setup) = unit.setup.value() else {
            ui.label(context.words.bench.connect_first);
            return;
        };
        let seen = BenchSnapshot::of(&unit.bench);
        let sheet = sheet(&mut self.sheets, unit.id, setup, seen.bench_epoch);
        // A run begins with its own track; stimuli given by hand are no longer in force.
        if seen.phase != Phase::Idle {
            sheet.given = StimuliGiven::default();
        }
        stimuli_panel().show(ui, |ui| {
            let mut hand = StimulusPanel {
                bench: &unit.bench,
                seen: &seen,
                words: context.words,
                messages: context.messages,
                given: &mut sheet.given,
            };
            stimuli(ui, &mut sheet.forms, setup, &mut hand);
        });
        let shown = View {
            words: context.words,
            seen: &seen,
            setup,
            laid: sheet.given.laid,
            given: sheet.given.station.as_ref(),
            events: &unit.log,
        };
        let signals = chosen(&context.settings.plotted);
        self.plot.take(&unit.bench, &signals);
        live_view(ui, &shown, |ui, height| {
            let plotted = &mut context.settings.plotted;
            self.plot
                .show(ui, height, &signals, plotted, (context.words, &seen));
        });
    }
}

/// The unit's sheet: new for another configuration or line, and without given stimuli after a new bench epoch.
fn sheet<'a>(
    sheets: &'a mut BTreeMap<u64, Sheet>,
    unit: u64,
    setup: &BenchSetup,
    bench_epoch: u64,
) -> &'a mut Sheet {
    let of = (setup.config.crc, setup.line.crc);
    let new = || Sheet {
        of,
        bench_epoch,
        forms: Forms::new(setup),
        given: StimuliGiven::default(),
    };
    let sheet = sheets.entry(unit).or_insert_with(new);
    if sheet.of != of {
        *sheet = new();
    }
    if sheet.bench_epoch != bench_epoch {
        sheet.bench_epoch = bench_epoch;
        sheet.given = StimuliGiven::default();
    }
    sheet
}

/// Panel for stimuli at the right.
fn stimuli_panel() -> Panel {
    let frame = Frame::new().inner_margin(Margin {
        left: 8,
        ..Margin::ZERO
    });
    Panel::right("stimuli").exact_size(STIMULI).frame(frame)
}

/// Draws the live view, and log and plot in the remaining height.
fn live_view(ui: &mut Ui, shown: &View<'_>, plot: impl FnOnce(&mut Ui, f32)) {
    let height = ui.available_height();
    let scroll = ScrollArea::vertical()
        .id_salt("live")
        .auto_shrink([false, false]);
    scroll.show(ui, |ui| {
        let top = ui.cursor().top();
        ui.spacing_mut().item_spacing.y = 4.0;
        view(ui, shown);
        let used = ui.cursor().top() - top;
        let left = (height - used - AROUND).max(LOWEST);
        let width = ui.available_width();
        if width < live::WIDE {
            live::log(ui, left, shown);
            plot(ui, left);
            return;
        }
        ui.horizontal_top(|ui| {
            let log = vec2((width * LOG_SHARE).round(), left);
            let down = Layout::top_down(Align::Min);
            ui.allocate_ui_with_layout(log, down, |ui| live::log(ui, left + HEADING, shown));
            ui.vertical(|ui| plot(ui, left));
        });
    });
}
