//! Accessible names for widgets without a label.

use eframe::egui::{Response, Role, WidgetInfo};

/// Gives a box to choose from, which shows only what is chosen, the name of what it chooses.
pub fn named_combo(response: &Response, name: &str, chosen: &str) {
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ComboBox, response.enabled(), name);
        info.current_text_value = Some(chosen.to_owned());
        info
    });
}
