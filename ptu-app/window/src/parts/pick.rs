//! Boxes in which one of several is chosen, and accessible names for them.

use eframe::egui::{ComboBox, Response, Role, Ui, WidgetInfo};

/// One of these in a box of this name, so wide, points; true when another one was chosen.
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

/// Names in order, each once.
pub fn names<'a>(all: impl Iterator<Item = &'a str>) -> Vec<String> {
    let names: std::collections::BTreeSet<_> = all.collect();
    names.into_iter().map(str::to_owned).collect()
}

/// Names a box to choose from for screen readers; by itself the box shows only the choice.
pub fn named_combo(response: &Response, name: &str, chosen: &str) {
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ComboBox, response.enabled(), name);
        info.current_text_value = Some(chosen.to_owned());
        info
    });
}
