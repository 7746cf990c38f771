//! Named questions to a page, saved to be asked again; layouts of lanes are saved in the same way.

use eframe::egui::{Button, Ui};
use egui_material_icons::icons::ICON_BOOKMARK;
use serde::{Deserialize, Serialize};

use super::{Face, Look, caption, menu, name_edit, typed};
use ptu_report::words::Words;

/// Width of the field for a name, points.
const FIELD: f32 = 200.0;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedQuestion<T> {
    name: String,
    asked: T,
}

/// Texts of the list and its buttons.
pub struct SavedSaid {
    pub list: &'static str,
    pub none: &'static str,
    pub name: &'static str,
    pub save: &'static str,
    pub forget: &'static str,
}

impl SavedSaid {
    pub fn questions(words: &Words) -> Self {
        let said = &words.statistics;
        Self {
            list: said.questions,
            none: said.no_question,
            name: said.question_name,
            save: said.save_question,
            forget: said.forget_question,
        }
    }

    pub fn layouts(words: &Words) -> Self {
        let said = &words.traces;
        Self {
            list: said.layouts,
            none: words.statistics.no_question,
            name: words.statistics.question_name,
            save: said.save_layout,
            forget: said.forget_layout,
        }
    }
}

/// The menu of saved questions, with the field for a name to save the present question (`now`); returns the question
/// that was chosen.
pub fn saved_questions<T: Clone + PartialEq>(
    ui: &mut Ui,
    said: &SavedSaid,
    (saved, name): (&mut Vec<SavedQuestion<T>>, &mut String),
    now: &T,
) -> Option<T> {
    let at = saved.iter().position(|question| question.asked == *now);
    let mut chosen = None;
    let face = Face::new(Look::Quiet, "").icon(ICON_BOOKMARK);
    menu(ui, &face.named(said.list).hint(said.list), |ui| {
        if saved.is_empty() {
            ui.label(said.none);
        }
        for (place, question) in saved.iter().enumerate() {
            let one = ui.selectable_label(at == Some(place), &question.name);
            if one.clicked() {
                chosen = Some(question.asked.clone());
                ui.close();
            }
        }
        ui.separator();
        match at {
            Some(at) => {
                if ui.button(said.forget).clicked() {
                    saved.remove(at);
                }
            }
            None => {
                let label = caption(ui, said.name);
                ui.add(name_edit(name, FIELD)).labelled_by(label.id);
                let named = typed(name);
                let save = ui.add_enabled(named.is_some(), Button::new(said.save));
                if let (true, Some(named)) = (save.clicked(), named) {
                    saved.retain(|question| question.name != named);
                    saved.push(SavedQuestion {
                        name: named,
                        asked: now.clone(),
                    });
                    name.clear();
                }
            }
        }
    });
    chosen
}
