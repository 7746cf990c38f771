//! The dialog before faults are closed or their repair is recorded: all faults that the change affects, and the
//! entries to be made.

use eframe::egui::{Grid, RichText, Ui};
use fault_db::{FaultAction, FaultDetail, FaultState, FaultSummary};

use crate::parts::{ActionPlace, Face, Look, dialog, field, go_on, last_row, name_edit, note_edit};
use ptu_report::naming::PartNames;
use ptu_report::words::{Faults, Words, fill};

/// Width of a field, points.
const FIELD: f32 = 260.0;

/// Entries of a person before a fault is brought to another state.
pub struct Asked {
    pub to: FaultState,
    reason: Option<usize>,
    pub note: String,
    pub serial_old: String,
    pub serial_new: String,
}

/// Button of the dialog that was clicked.
pub enum Chosen {
    Cancel,
    /// Write the change, with this note.
    Write(String),
}

/// The fault, and the faults of its case that change to state `to` with it: for a repair all for which it is allowed,
/// for a closing those in the fault's present state.
pub fn going_with(detail: &FaultDetail, to: FaultState) -> Vec<&FaultSummary> {
    let state = detail.fault.state;
    let follows = |fault: &&FaultSummary| {
        let can = fault.state.next(FaultAction::towards(to)).is_ok();
        can && (to == FaultState::Repaired || fault.state == state)
    };
    std::iter::once(&detail.fault)
        .chain(detail.case.iter().filter(follows))
        .collect()
}

impl Asked {
    /// A dialog that begins with this note.
    pub fn new(to: FaultState, note: &str) -> Self {
        Self {
            to,
            reason: None,
            note: note.to_owned(),
            serial_old: String::new(),
            serial_new: String::new(),
        }
    }

    /// Draws the dialog over the page; the button that was clicked.
    pub fn show(
        &mut self,
        ui: &Ui,
        (words, parts): (&Words, &PartNames),
        detail: &FaultDetail,
    ) -> Option<Chosen> {
        let said = &words.faults;
        let going = going_with(detail, self.to);
        let of_verified = detail.fault.state == FaultState::Verified;
        let part = parts.name(detail.fault.cause(), words.language);
        let (title, together, button, missing) = match self.to {
            FaultState::Repaired => (
                said.repair_asked,
                said.repair_together,
                words.case.record_repair,
                said.repair_reason,
            ),
            _ if of_verified => (said.close_repaired, said.close_together, said.close_n, ""),
            _ => (
                said.close_unrepaired,
                said.close_together,
                said.close_n,
                said.close_reason,
            ),
        };
        let filled: [(&str, &dyn std::fmt::Display); 2] = [("n", &going.len()), ("part", &part)];
        let place = ActionPlace::new(ui, "asked of faults", detail.fault.id);
        let mut chosen = None;
        let open = dialog(ui, "asked of faults", &fill(title, &filled), |ui| {
            if going.len() > 1 {
                ui.label(fill(together, &filled));
            }
            for fault in &going {
                let name = parts.fault(&fault.lru, (&fault.findings, &fault.message), words);
                ui.label(RichText::new(name).strong());
            }
            match self.to {
                FaultState::Repaired => self.serials(ui, words),
                _ if !of_verified => self.why(ui, said),
                _ => {}
            }
            let note = self.note(said, of_verified);
            last_row(ui, |ui| {
                let why_not = note.is_none().then_some(missing);
                let write = Face::new(Look::Primary, fill(button, &filled)).off(why_not);
                if place.clicked(&write.show(ui)) {
                    chosen = note.map(Chosen::Write);
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

    fn serials(&mut self, ui: &mut Ui, words: &Words) {
        Grid::new("serials").num_columns(2).show(ui, |ui| {
            let said = &words.faults;
            let fields = [
                field(ui, said.serial_old, name_edit(&mut self.serial_old, FIELD)),
                field(ui, said.serial_new, name_edit(&mut self.serial_new, FIELD)),
                field(ui, words.case.note, note_edit(&mut self.note, FIELD)),
            ];
            go_on(ui, &fields);
        });
    }

    fn why(&mut self, ui: &mut Ui, said: &Faults) {
        ui.label(said.close_why);
        for (place, reason) in reasons(said).into_iter().enumerate() {
            ui.radio_value(&mut self.reason, Some(place), reason);
        }
        let label = ui.label(said.close_looked);
        let field = note_edit(&mut self.note, f32::INFINITY);
        ui.add(field).labelled_by(label.id);
    }

    /// Text to be stored; none while an entry is missing.
    fn note(&self, said: &Faults, of_verified: bool) -> Option<String> {
        let note = self.note.trim().to_owned();
        if self.to == FaultState::Repaired {
            let all = [&note, &self.serial_old, &self.serial_new];
            return all
                .iter()
                .any(|text| !text.trim().is_empty())
                .then_some(note);
        }
        if of_verified {
            return Some(note);
        }
        let reason = reasons(said)[self.reason?];
        (!note.is_empty()).then(|| format!("{reason}: {note}"))
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
