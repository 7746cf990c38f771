//! The unit and its symptom: what is known, tiles to choose from, and the search for the part.

use eframe::egui::{Button, RichText, Ui, vec2};

use super::{CasePage, Stage, TARGET, TEXT, large};
use crate::gui::parts::ActionPlace;
use crate::gui::request::Request;
use crate::gui::{Destination, PageContext};
use ptu_bench::symptoms::{self, Symptom};
use ptu_report::naming::PartNames;
use ptu_report::words::Words;

/// Width of a tile, points.
const WIDE: f32 = 260.0;

/// The symptoms of the scripts directory, and the one chosen; what parts are called.
#[derive(Default)]
pub struct SymptomTiles {
    loaded: Request<(Vec<Symptom>, PartNames)>,
    /// `Some(None)` = it is not known.
    chosen: Option<Option<Symptom>>,
}

impl SymptomTiles {
    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        if self.loaded.poll()
            && let Request::Failed(why) = &self.loaded
        {
            let said = context.words.procedures.not_loaded;
            context.messages.trouble(said, why.clone());
        }
    }

    /// What people call a part.
    pub fn part<'a>(&'a self, id: &'a str, words: &Words) -> &'a str {
        let names = self.loaded.value().map(|(_, names)| names);
        names.map_or(id, |names| names.name(id, words.language))
    }

    /// A fault of this part in one line.
    pub fn fault(&self, part: &str, message: &str, words: &Words) -> String {
        let names = self.loaded.value().map(|(_, names)| names);
        let said = names.map(|names| names.fault(part, message, words));
        said.unwrap_or_else(|| part.to_owned())
    }

    fn show(&mut self, ui: &mut Ui, context: &PageContext<'_>) {
        if self.loaded.is_idle() {
            let asked = context.queries.run(|paths| {
                let scripts = &paths.scripts;
                Ok((symptoms::load(scripts)?, PartNames::of(scripts)))
            });
            self.loaded = Request::Pending(asked);
        }
        let words = context.words;
        let loaded = self.loaded.value();
        let known = loaded.into_iter().flat_map(|(symptoms, _)| symptoms);
        let tiles = known.map(|symptom| (words.content(&symptom.name), Some(symptom.clone())));
        let unknown = (words.case.unknown.into(), None);
        let mut clicked = None;
        ui.horizontal_wrapped(|ui| {
            for (name, symptom) in tiles.chain([unknown]) {
                let on = self.chosen.as_ref() == Some(&symptom);
                let button = Button::new(RichText::new(name).size(TEXT)).selected(on);
                if ui.add(button.min_size(vec2(WIDE, TARGET))).clicked() {
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
        ui.label(RichText::new(&serial).size(super::HEADLINE).strong());
        self.known.keep(&serial, context);
        self.known.show(ui, context.words, &self.tiles);
        ui.add_space(8.0);
        ui.label(RichText::new(words.what_is_wrong).size(TEXT).strong());
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
            let symptom = self.tiles.chosen.clone().flatten();
            context.go_to.push(Destination::FindPart(symptom));
            self.stage = Stage::Find;
        }
    }
}
