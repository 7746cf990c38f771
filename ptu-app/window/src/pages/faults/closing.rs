//! The dialog before faults are closed: every fault that closes, and why. A reason is required of faults that nobody repaired.

use eframe::egui::{Align2, Button, Id, Key, RichText, ScrollArea, Ui, Window};
use fault_db::{FaultAction, FaultDetail, FaultState, FaultSummary};

use crate::parts::{ActionPlace, note_edit};
use crate::{Palette, Sizes};
use ptu_report::naming::PartNames;
use ptu_report::words::{Faults, Words, fill};

/// Width of the dialog, points.
const WIDE: f32 = 560.0;
/// Height of its title and its last rows with what is above it, points.
const AROUND: f32 = 240.0;

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
        let mut chosen = ui
            .input(|input| input.key_pressed(Key::Escape))
            .then_some(Chosen::Cancel);
        let dialog = Window::new(fill(title, &n)).id(Id::unique("close faults"));
        let dialog = dialog.collapsible(false).resizable(false);
        let dialog = dialog.anchor(Align2::CENTER_CENTER, [0.0, 0.0]);
        dialog.show(ui.ctx(), |ui| {
            Sizes::of(ui).set(ui);
            ui.set_width(WIDE.min(ui.ctx().content_rect().width() - 40.0));
            let high = ui.ctx().content_rect().height() - AROUND;
            ScrollArea::vertical().max_height(high).show(ui, |ui| {
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
            });
            let note = self.note(said, repaired);
            let missing = note.is_none();
            if missing {
                let quiet = Palette::of(ui).quiet;
                ui.label(RichText::new(said.close_reason).color(quiet));
            }
            ui.horizontal(|ui| {
                if place.clicked(&ui.button(words.common.cancel)) {
                    chosen = Some(Chosen::Cancel);
                }
                let close = ui.add_enabled(!missing, Button::new(fill(said.close_n, &n)));
                if place.clicked(&close.on_disabled_hover_text(said.close_reason)) {
                    chosen = note.map(Chosen::Close);
                }
            });
        });
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
