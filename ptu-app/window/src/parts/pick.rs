//! Boxes in which one of several values is chosen, with names for screen readers.

use eframe::egui::{ComboBox, Response, Role, Ui, WidgetInfo};

/// A box in which one value is chosen, `wide` points wide; true when another value was chosen.
pub fn pick<T: Clone + PartialEq, S: Into<String>>(
    ui: &mut Ui,
    (name, wide): (&str, f32),
    chosen: &mut T,
    all: impl IntoIterator<Item = (T, S)>,
) -> bool {
    let all = all.into_iter().map(|(value, said)| (value, said.into()));
    let all: Vec<(T, String)> = all.collect();
    let shown = all.iter().find(|(value, _)| value == chosen);
    let shown = shown.map_or_else(String::new, |(_, said)| said.clone());
    let combo = ComboBox::from_id_salt(name).selected_text(&shown);
    let combo = combo.width(wide).truncate().show_ui(ui, |ui| {
        let pick = |(value, said)| ui.selectable_value(chosen, value, said).changed();
        all.into_iter().map(pick).fold(false, |any, one| any | one)
    });
    named_combo(&combo.response, name, &shown);
    combo.inner.unwrap_or_default()
}

/// The names in alphabetical order, each once.
pub fn names<'a>(all: impl Iterator<Item = &'a str>) -> Vec<String> {
    let names: std::collections::BTreeSet<_> = all.collect();
    names.into_iter().map(str::to_owned).collect()
}

/// Gives a box its name for screen readers, which would otherwise read only the chosen value.
pub fn named_combo(response: &Response, name: &str, chosen: &str) {
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ComboBox, response.enabled(), name);
        info.current_text_value = Some(chosen.to_owned());
        info
    });
}
