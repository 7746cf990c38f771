//! The unit and its symptom: what is known, tiles to choose from, and the search for the part.

use eframe::egui::{Button, RichText, Ui, vec2};

use super::{CasePage, Stage, large};
use crate::parts::ActionPlace;
use crate::request::Request;
use crate::{Destination, PageContext, Sizes};
use ptu_runs::symptoms::{self, Symptom};

/// Width of a tile, points.
const WIDE: f32 = 260.0;

/// The symptoms of the scripts directory, and the one chosen.
#[derive(Default)]
pub struct SymptomTiles {
    symptoms: Request<Vec<Symptom>>,
    /// `Some(None)` = it is not known.
    chosen: Option<Option<Symptom>>,
}

impl SymptomTiles {
    /// The one chosen, if it is known.
    pub fn symptom(&self) -> Option<Symptom> {
        self.chosen.clone().flatten()
    }

    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        if self.symptoms.poll()
            && let Request::Failed(why) = &self.symptoms
        {
            let said = context.words.procedures.not_loaded;
            context.messages.trouble(said, why.clone());
        }
    }

    fn show(&mut self, ui: &mut Ui, context: &PageContext<'_>) {
        if self.symptoms.is_idle() {
            let asked = context.queries.run(|paths| {
                let scripts = &paths.scripts;
                symptoms::load(scripts, &scripts.faults()?.lrus)
            });
            self.symptoms = Request::Pending(asked);
        }
        let words = context.words;
        let known = self.symptoms.value().into_iter().flatten();
        let tiles = known.map(|symptom| (words.content(&symptom.name), Some(symptom.clone())));
        let unknown = (words.case.unknown.into(), None);
        let mut clicked = None;
        ui.horizontal_wrapped(|ui| {
            for (name, symptom) in tiles.chain([unknown]) {
                let on = self.chosen.as_ref() == Some(&symptom);
                let button = Button::new(RichText::new(name).size(Sizes::of(ui).lead)).selected(on);
                if ui
                    .add(button.min_size(vec2(WIDE, Sizes::of(ui).target)))
                    .clicked()
                {
                    clicked = Some(symptom);
                }
            }
        });
        self.chosen = clicked.or_else(|| self.chosen.take());
    }
}

impl CasePage {
    pub(super) fn unit(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = &context.words.case;
        let unit = context.units.chosen();
        let (serial, may) = (unit.name(), unit.may_run());
        ui.label(RichText::new(&serial).size(Sizes::of(ui).headline).strong());
        self.known.keep(&serial, context);
        self.known.show(ui, context.words, context.go_to);
        ui.add_space(8.0);
        ui.label(
            RichText::new(words.what_is_wrong)
                .size(Sizes::of(ui).lead)
                .strong(),
        );
        self.tiles.show(ui, context);
        ui.add_space(8.0);
        self.name(ui, context);
        let named = !context.settings.operator.trim().is_empty();
        let place = ActionPlace::new(ui, "case find", may);
        let find = large(
            ui,
            words.find_part,
            may && named && self.tiles.chosen.is_some(),
        );
        let hint = match named {
            true => words.what_is_wrong,
            false => words.name_first,
        };
        if place.clicked(&find.on_disabled_hover_text(hint)) {
            let symptom = self.tiles.symptom();
            context.go_to.push(Destination::FindPart(symptom));
            self.stage = Stage::Find;
        }
    }
}
