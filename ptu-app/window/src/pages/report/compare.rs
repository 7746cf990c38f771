//! Choice of a second run of the same unit, with which the shown run is compared.

use eframe::egui::Ui;
use fault_db::{Id, RunSummary};

use super::sheet_of::SheetOf;
use crate::parts::{RunList, caption, pick};
use ptu_report::naming::DOT;
use ptu_report::words::Words;
use ptu_runs::clock;

/// Number of runs that are offered, the latest first.
const MOST: usize = 50;

#[derive(Default)]
pub struct ComparedWith {
    /// The run to compare, and it and the chosen run, the earlier first.
    chosen: Option<(Id, [Id; 2])>,
    /// Steps that passed in both runs are shown, too.
    all: bool,
}

impl ComparedWith {
    /// The sheet of this run alone, or of its comparison with the run chosen for it.
    pub fn sheet_of(&self, run: Id) -> SheetOf {
        match self.chosen {
            Some((of, [before, after])) if of == run => SheetOf::Compared {
                before,
                after,
                all: self.all,
            },
            _ => SheetOf::Run(run),
        }
    }

    /// Draws the list from which the second run is chosen.
    pub fn show(&mut self, ui: &mut Ui, words: &Words, of: SheetOf, runs: &RunList) {
        let run = match (of, self.chosen) {
            (SheetOf::Compared { .. }, Some((run, _))) => run,
            _ => of.run(),
        };
        let others: Vec<_> = runs.of_same_unit(run).take(MOST).collect();
        let chosen = match of {
            SheetOf::Compared { before, after, .. } => {
                let is_it = |other: &&&RunSummary| [before, after].contains(&other.id);
                others.iter().find(is_it).copied()
            }
            SheetOf::Run(_) | SheetOf::Case { .. } => None,
        };
        let report = &words.report;
        let name = |other: &RunSummary| {
            let verdict = other.verdict.map(|said| words.common.stored_verdict(said));
            let verdict = verdict.unwrap_or(words.common.interrupted);
            [&*clock::local(other.started_at_us), verdict].join(DOT)
        };
        let mut with = chosen.map(|chosen| chosen.id);
        let offered = others.iter().map(|other| (Some(other.id), name(other)));
        let none = (None, report.no_comparison.to_owned());
        caption(ui, report.compare_with);
        let wide = ui.available_width();
        let offered = std::iter::once(none).chain(offered);
        if pick(ui, (report.compare_with, wide), &mut with, offered) {
            self.chosen = with.map(|other| (run, runs.in_time([run, other])));
        }
        if chosen.is_some() {
            ui.checkbox(&mut self.all, report.all_steps);
        }
    }
}
