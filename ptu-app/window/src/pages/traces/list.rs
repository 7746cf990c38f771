//! The list of recorded traces by run, latest first.

use eframe::egui::{RichText, ScrollArea, TextWrapMode, Ui};
use egui_material_icons::icons::ICON_DO_NOT_DISTURB_ON;
use fault_db::Id;

use crate::parts::{
    MemoryReader, Stored, UnitFilter, before_more, chip, find_edit, names, verdict_chip,
};
use crate::request::FollowingResponse;
use crate::{PageContext, Palette};
use ptu_report::naming::PartNames;
use ptu_report::trace_view::listing::{self, ListedRun, ListedTrace, RUNS};
use ptu_report::words::{Words, fill};
use ptu_runs::stored::from_stored;

/// The list and its filters.
#[derive(Default)]
pub struct TraceList {
    runs: FollowingResponse<(), Vec<ListedRun>>,
    filter: String,
    units: UnitFilter,
    /// Rows that fit the filter: index of a run, and of one of its traces; none = the run's heading.
    shown: Vec<(usize, Option<usize>)>,
    /// Button that reads the run record of the chosen unit.
    unit_record: MemoryReader,
}

impl TraceList {
    /// Shows the list; returns the trace that was clicked, and its run.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        context: &mut PageContext<'_>,
        chosen: Option<Id>,
    ) -> Option<(Id, Id)> {
        let words = context.words;
        let mut applies = false;
        ui.horizontal_wrapped(|ui| {
            let wide = before_more(ui);
            let edit = find_edit(ui, &mut self.filter, words.traces.filter, wide);
            if self.unit_record.show(ui, Stored::Runs, context) {
                self.runs.read_again();
            }
            let units = self.runs.items().iter().map(|run| &*run.unit);
            applies = self.units.show(ui, context, &names(units)) | edit.changed();
        });
        if applies {
            self.apply();
        }
        let Some(runs) = self.runs.get().value() else {
            if (self.runs.get()).missing(ui, words, words.traces.cannot_list) {
                self.runs.read_again();
            }
            return None;
        };
        if runs.is_empty() {
            ui.label(words.traces.none_recorded);
        } else if self.shown.is_empty() {
            ui.label(words.traces.none_fits);
        }
        let mut clicked = None;
        ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
        // Rows of runs and of traces have the same height, or scrolling would jump.
        let height = super::ROW;
        ui.spacing_mut().interact_size.y = height;
        ScrollArea::vertical().auto_shrink(false).show_rows(
            ui,
            height,
            self.shown.len(),
            |ui, rows| {
                for (run, trace) in self.shown.get(rows).into_iter().flatten() {
                    let run = &runs[*run];
                    match trace.map(|trace| &run.traces[trace]) {
                        None => run_row(ui, run, words),
                        Some(trace) => {
                            if trace_row(ui, trace, chosen == Some(trace.id), words) {
                                clicked = Some((trace.id, run.id));
                            }
                        }
                    }
                }
                if runs.len() >= RUNS as usize {
                    ui.label(fill(words.traces.only_newest, &[("runs", &RUNS)]));
                }
            },
        );
        clicked
    }

    /// The latest trace and its run.
    pub fn latest(&self) -> Option<(Id, Id)> {
        let mut runs = self.runs.items().iter();
        let run = runs.find(|run| self.units.takes(&run.unit))?;
        Some((run.traces.first()?.id, run.id))
    }

    /// Unit and date of a run; empty for an unknown run.
    pub fn whose(&self, run: Option<Id>) -> (&str, &str) {
        let mut runs = self.runs.items().iter();
        let found = runs.find(|listed| Some(listed.id) == run);
        found.map_or(("", ""), |run| (&run.unit, &run.began))
    }

    /// All traces with their runs, the latest run first.
    pub fn all(&self) -> impl Iterator<Item = (&ListedRun, &ListedTrace)> {
        self.runs
            .items()
            .iter()
            .flat_map(|run| run.traces.iter().map(move |trace| (run, trace)))
    }

    /// Reads the list at first, and again when the data have changed.
    pub fn keep_up(&mut self, context: &PageContext<'_>) {
        if self.runs.keep_up(((), true), context, |paths, ()| {
            listing::list(&paths.read()?, &PartNames::of(&paths.scripts))
        }) {
            self.apply();
        }
    }

    fn apply(&mut self) {
        self.shown.clear();
        for (place, run) in self.runs.items().iter().enumerate() {
            if !self.units.takes(&run.unit) {
                continue;
            }
            let traces = run.traces.iter().enumerate();
            let mut fitting = traces
                .filter(|(_, trace)| trace.fits(&self.filter))
                .peekable();
            if fitting.peek().is_some() {
                self.shown.push((place, None));
            }
            self.shown
                .extend(fitting.map(|(trace, _)| (place, Some(trace))));
        }
    }
}

fn run_row(ui: &mut Ui, run: &ListedRun, words: &Words) {
    let palette = Palette::of(ui);
    let injected = run.injected.as_deref().unwrap_or_default();
    ui.horizontal(|ui| {
        ui.label(RichText::new(&run.unit).strong())
            .on_hover_text(format!("{} {injected}", run.id.short()));
        match run.verdict {
            Some(verdict) => verdict_chip(ui, from_stored(verdict), words),
            None => {
                let broken = (ICON_DO_NOT_DISTURB_ON, words.common.interrupted);
                chip(ui, broken, palette.warn)
            }
        };
        ui.label(RichText::new(&run.began).small().color(palette.quiet));
    });
}

fn trace_row(ui: &mut Ui, trace: &ListedTrace, chosen: bool, words: &Words) -> bool {
    let what = match trace.faults.as_slice() {
        [] => words.traces.no_fault.to_owned(),
        _ => trace.said(words.language),
    };
    let codes: Vec<_> = trace
        .faults
        .iter()
        .map(|fault| fault.code.as_str())
        .collect();
    let (id, codes) = (trace.id.short(), codes.join(", "));
    let hint = format!("{what}\n{codes}\n{id}, {:.1} s", trace.length_s);
    ui.selectable_label(chosen, what)
        .on_hover_text(hint)
        .clicked()
}
