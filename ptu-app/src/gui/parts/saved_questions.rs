//! Questions that were given a name: what a page was asked, to be asked again.

use eframe::egui::{Button, ComboBox, Ui};
use serde::{Deserialize, Serialize};

use super::{name_edit, named_combo, typed};
use ptu_report::words::Words;

/// Width of the field for a name, points.
const FIELD: f32 = 110.0;

/// A question and its name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedQuestion<T> {
    name: String,
    asked: T,
}

/// The list of saved questions, and the field for the name of another one; the question that was chosen. `now` is what is
/// asked at present.
pub fn saved_questions<T: Clone + PartialEq>(
    ui: &mut Ui,
    words: &Words,
    (saved, name): (&mut Vec<SavedQuestion<T>>, &mut String),
    now: &T,
) -> Option<T> {
    let said = &words.statistics;
    let at = saved.iter().position(|question| question.asked == *now);
    let mut chosen = None;
    let shown = at.map_or(said.no_question, |at| saved[at].name.as_str());
    ui.label(said.questions);
    let combo = ComboBox::from_id_salt("questions")
        .selected_text(shown)
        .width(FIELD)
        .truncate();
    let combo = combo.show_ui(ui, |ui| {
        for (place, question) in saved.iter().enumerate() {
            let one = ui.selectable_label(at == Some(place), &question.name);
            if one.clicked() {
                chosen = Some(question.asked.clone());
            }
        }
    });
    named_combo(&combo.response, said.questions, shown);
    match at {
        Some(at) => {
            if ui.button(said.forget_question).clicked() {
                saved.remove(at);
            }
        }
        None => {
            let label = ui.label(said.question_name);
            ui.add(name_edit(name, FIELD)).labelled_by(label.id);
            let named = typed(name);
            let save = ui.add_enabled(named.is_some(), Button::new(said.save_question));
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
    chosen
}
