//! The run that the shown one is compared with, chosen among those of its unit.

use eframe::egui::{ComboBox, Ui};
use fault_db::{Id, RunSummary};

use super::SheetOf;
use crate::parts::{RunList, named_combo};
use ptu_report::naming::DOT;
use ptu_report::words::Words;
use ptu_runs::clock;

/// As many runs are offered, the latest first.
const MOST: usize = 50;

#[derive(Default)]
pub struct ComparedWith {
    /// The run it was chosen for, and the two in the order in which they were made.
    chosen: Option<(Id, [Id; 2])>,
    /// Also what passed in both.
    all: bool,
}

impl ComparedWith {
    /// The sheet to show of this run: alone, or beside the one chosen for it.
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

    /// The choice, beside the sheet that is shown.
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
        let shown = chosen.map_or_else(|| report.no_comparison.to_owned(), name);
        ui.label(report.compare_with);
        let combo = ComboBox::from_id_salt("compare with").selected_text(&shown);
        let combo = combo.show_ui(ui, |ui| {
            let none = ui.selectable_label(chosen.is_none(), report.no_comparison);
            if none.clicked() {
                self.chosen = None;
            }
            for other in &others {
                let on = chosen.is_some_and(|chosen| chosen.id == other.id);
                let one = ui.selectable_label(on, name(other));
                if one.on_hover_text(other.id.to_string()).clicked() {
                    self.chosen = Some((run, runs.in_time([run, other.id])));
                }
            }
        });
        named_combo(&combo.response, report.compare_with, &shown);
        if chosen.is_some() {
            ui.checkbox(&mut self.all, report.all_steps);
        }
    }
}
