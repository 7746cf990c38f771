//! Text fields that accept no more than the database stores.

use eframe::egui::{TextEdit, Ui, WidgetText};
use fault_db::limits::{MOST_NAME, MOST_TEXT};

/// A field for a name or a serial number, so many points wide.
pub fn name_edit(text: &mut String, wide: f32) -> TextEdit<'_> {
    TextEdit::singleline(text)
        .char_limit(MOST_NAME)
        .desired_width(wide)
}

/// A field for a note, so many points wide.
pub fn note_edit(text: &mut String, wide: f32) -> TextEdit<'_> {
    TextEdit::singleline(text)
        .char_limit(MOST_TEXT)
        .desired_width(wide)
}

/// A field with its name before it, as one row of a grid of two columns.
pub fn field(ui: &mut Ui, name: impl Into<WidgetText>, edit: TextEdit<'_>) {
    let label = ui.label(name);
    ui.add(edit).labelled_by(label.id);
    ui.end_row();
}

/// What was typed, if anything.
pub fn typed(text: &str) -> Option<String> {
    let text = text.trim();
    (!text.is_empty()).then(|| text.to_owned())
}
