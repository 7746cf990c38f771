//! Text fields that accept no more than the database stores.

use eframe::egui::{Align2, Key, Response, TextEdit, Ui, WidgetText};
use fault_db::limits::{MOST_NAME, MOST_TEXT};

/// A field for a name or a serial number, this many points wide.
pub fn name_edit(text: &mut String, wide: f32) -> TextEdit<'_> {
    TextEdit::singleline(text)
        .char_limit(MOST_NAME)
        .align(Align2::LEFT_CENTER)
        .desired_width(wide)
}

/// A field for a note, this many points wide.
pub fn note_edit(text: &mut String, wide: f32) -> TextEdit<'_> {
    TextEdit::singleline(text)
        .char_limit(MOST_TEXT)
        .align(Align2::LEFT_CENTER)
        .desired_width(wide)
}

/// A field with its name before it, as one row of a grid of two columns.
pub fn field(ui: &mut Ui, name: impl Into<WidgetText>, edit: TextEdit<'_>) -> Response {
    let label = ui.label(name);
    let field = ui.add(edit).labelled_by(label.id);
    ui.end_row();
    field
}

/// Goes to the next of these fields with Enter: a scanner of serial numbers is a keyboard that ends with it.
pub fn go_on(ui: &Ui, fields: &[Response]) {
    let is_left = |field: &Response| field.lost_focus();
    let left = fields.iter().position(is_left);
    let next = left.and_then(|left| fields.get(left + 1));
    if let Some(next) = next.filter(|_| ui.input(|input| input.key_pressed(Key::Enter))) {
        next.request_focus();
    }
}

/// What was typed, if anything.
pub fn typed(text: &str) -> Option<String> {
    let text = text.trim();
    (!text.is_empty()).then(|| text.to_owned())
}
