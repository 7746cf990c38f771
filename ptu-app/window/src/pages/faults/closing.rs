//! The dialog before faults are closed: every fault that closes, and why. A reason is required of faults that nobody repaired.

use eframe::egui::{RichText, Ui};
use fault_db::{FaultAction, FaultDetail, FaultState, FaultSummary};

use crate::parts::{ActionPlace, Face, Look, dialog, last_row, note_edit};
use ptu_report::naming::PartNames;
use ptu_report::words::{Faults, Words, fill};

/// What is written before faults are closed.
#[derive(Default)]
pub struct Closing {
    reason: Option<usize>,
    looked: String,
}

/// Which button of the dialog was clicked.
pub enum Chosen {
    Cancel,
    /// With this note.
    Close(String),
}

/// The faults that close with one, itself first: those of its case that are as far as it.
pub fn closing_with(detail: &FaultDetail) -> Vec<&FaultSummary> {
    let state = detail.fault.state;
    let follows =
        |fault: &&FaultSummary| fault.state == state && state.next(FaultAction::Close).is_ok();
    std::iter::once(&detail.fault)
        .chain(detail.case.iter().filter(follows))
        .collect()
}

impl Closing {
    /// Draws it over the page; what was chosen.
    pub fn show(
        &mut self,
        ui: &Ui,
        (words, parts): (&Words, &PartNames),
        detail: &FaultDetail,
    ) -> Option<Chosen> {
        let said = &words.faults;
        let closing = closing_with(detail);
        let n = [("n", &closing.len() as &dyn std::fmt::Display)];
        let repaired = detail.fault.state == FaultState::Verified;
        let title = match repaired {
            true => said.close_repaired,
            false => said.close_unrepaired,
        };
        let place = ActionPlace::new(ui, "close faults", detail.fault.id);
        let mut chosen = None;
        let open = dialog(ui, "close faults", &fill(title, &n), |ui| {
            if closing.len() > 1 {
                let part = parts.name(detail.fault.cause(), words.language);
                ui.label(fill(said.close_together, &[("part", &part)]));
            }
            for fault in &closing {
                let name = parts.fault(&fault.lru, (&fault.findings, &fault.message), words);
                ui.label(RichText::new(name).strong());
            }
            if !repaired {
                self.why(ui, said);
            }
            let note = self.note(said, repaired);
            last_row(ui, |ui| {
                let close = fill(said.close_n, &n);
                let why_not = note.is_none().then_some(said.close_reason);
                let close = Face::new(Look::Primary, close).off(why_not).show(ui);
                if place.clicked(&close) {
                    chosen = note.map(Chosen::Close);
                }
                let cancel = Face::new(Look::Quiet, words.common.cancel).show(ui);
                if place.clicked(&cancel) {
                    chosen = Some(Chosen::Cancel);
                }
            });
        });
        if !open {
            return Some(Chosen::Cancel);
        }
        chosen
    }

    fn why(&mut self, ui: &mut Ui, said: &Faults) {
        ui.label(said.close_why);
        for (place, reason) in reasons(said).into_iter().enumerate() {
            ui.radio_value(&mut self.reason, Some(place), reason);
        }
        let label = ui.label(said.close_looked);
        let field = note_edit(&mut self.looked, f32::INFINITY);
        ui.add(field).labelled_by(label.id);
    }

    /// What is written down; nothing while something is missing.
    fn note(&self, said: &Faults, repaired: bool) -> Option<String> {
        let looked = self.looked.trim();
        if repaired {
            return Some(looked.to_owned());
        }
        let reason = reasons(said)[self.reason?];
        (!looked.is_empty()).then(|| format!("{reason}: {looked}"))
    }
}

fn reasons(said: &Faults) -> [&'static str; 4] {
    [
        said.close_not_found,
        said.close_elsewhere,
        said.close_bench,
        said.close_other,
    ]
}
