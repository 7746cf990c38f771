//! The unit and its symptom: the unit's history, tiles of symptoms, and the button that begins the search for the part.

use eframe::egui::Ui;
use egui_material_icons::icons::ICON_ARROW_FORWARD;

use crate::parts::{ActionPlace, Face, Look, choice};
use crate::request::Request;
use crate::{Destination, PageContext, Sizes, Wanted};
use ptu_report::words::Words;
use ptu_runs::symptoms::{self, Symptom};

/// Least width and height of a tile, and gap between two tiles, points.
const WIDE: f32 = 230.0;
const HIGH: f32 = 44.0;
const GAP: f32 = 8.0;

/// The symptoms in the scripts directory, and the chosen symptom.
#[derive(Default)]
pub struct SymptomTiles {
    symptoms: Request<Vec<Symptom>>,
    /// `None` = nothing chosen yet; `Some(None)` = the symptom is unknown.
    chosen: Option<Option<Symptom>>,
}

impl SymptomTiles {
    /// The chosen symptom; none if unknown or not chosen.
    pub fn symptom(&self) -> Option<Symptom> {
        self.chosen.clone().flatten()
    }

    /// The chosen symptom as text.
    pub fn said(&self, words: &Words) -> String {
        match &self.chosen {
            Some(Some(symptom)) => words.content(&symptom.name).into_owned(),
            Some(None) => words.case.unknown.to_owned(),
            None => String::new(),
        }
    }

    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        if self.symptoms.poll()
            && let Request::Failed(why) = &self.symptoms
        {
            let said = context.words.procedures.not_loaded;
            context.messages.trouble(said, why.clone());
        }
    }

    /// Draws the tiles to choose from.
    pub fn show(&mut self, ui: &mut Ui, context: &PageContext<'_>) {
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
        let high = Sizes::of(ui).target.max(HIGH);
        let columns = ((ui.available_width() + GAP) / (WIDE + GAP))
            .floor()
            .clamp(1.0, 3.0);
        let wide = (ui.available_width() - GAP * (columns - 1.0)) / columns;
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = [GAP, GAP].into();
            for (name, symptom) in tiles.chain([unknown]) {
                let on = self.chosen.as_ref() == Some(&symptom);
                if choice(ui, (&*name, ""), on, [wide.floor(), high]).clicked() {
                    clicked = Some(symptom);
                }
            }
        });
        self.chosen = clicked.or_else(|| self.chosen.take());
    }
}

impl SymptomTiles {
    /// The button that begins the search for the part; true when it was clicked.
    pub fn foot(&self, ui: &mut Ui, context: &mut PageContext<'_>) -> bool {
        let words = &context.words.case;
        let may = context.units.chosen().may_run();
        let named = !context.settings.operator.trim().is_empty();
        let place = ActionPlace::new(ui, "case find", may);
        let why_not = match (named, self.chosen.is_some()) {
            (false, _) => Some(words.name_first),
            (true, false) => Some(words.what_is_wrong),
            (true, true) => (!may).then_some(words.under_way),
        };
        let find = Face::new(Look::Primary, words.find_part).off(why_not);
        let clicked = place.clicked(&find.end(ICON_ARROW_FORWARD).show(ui));
        if clicked {
            let wanted = Wanted::Part {
                symptom: self.symptom(),
                adaptive: true,
            };
            context.go_to.push(Destination::Run(wanted));
        }
        clicked
    }
}
