//! Text fields that accept no more than the database stores.

use crate::Palette;
use eframe::egui::{Align2, Key, Response, RichText, Role, TextEdit, Ui, WidgetInfo, WidgetText};
use fault_db::limits::{MOST_NAME, MOST_TEXT};

/// A field for a name or a serial number, this many points wide.
pub fn name_edit(text: &mut String, wide: f32) -> TextEdit<'_> {
    path_edit(text, wide).char_limit(MOST_NAME)
}

/// A field for a file or an address, this many points wide.
pub fn path_edit(text: &mut String, wide: f32) -> TextEdit<'_> {
    TextEdit::singleline(text)
        .align(Align2::LEFT_CENTER)
        .desired_width(wide)
}

/// A field for a note, this many points wide.
pub fn note_edit(text: &mut String, wide: f32) -> TextEdit<'_> {
    path_edit(text, wide).char_limit(MOST_TEXT)
}

/// A search field, this many points wide, with its name inside instead of beside it.
pub fn find_edit(ui: &mut Ui, text: &mut String, name: &str, wide: f32) -> Response {
    let field = ui.add(path_edit(text, wide).hint_text(name));
    name_input(&field, name);
    field
}

/// A small name above a widget.
pub fn caption(ui: &mut Ui, name: &str) -> Response {
    ui.label(RichText::new(name).small().color(Palette::of(ui).quiet))
}

/// The name of a text field that has no label beside it.
pub fn name_input(response: &Response, name: &str) {
    response.widget_info(|| WidgetInfo::labeled(Role::TextInput, response.enabled(), name));
}

/// A field with its name before it, as one row of a grid of two columns.
pub fn field(ui: &mut Ui, name: impl Into<WidgetText>, edit: TextEdit<'_>) -> Response {
    let label = ui.label(name);
    let field = ui.add(edit).labelled_by(label.id);
    ui.end_row();
    field
}

/// Moves the keyboard to the next of these fields with Enter: a scanner of serial numbers is a keyboard that
/// ends with Enter.
pub fn go_on(ui: &Ui, fields: &[Response]) {
    let is_left = |field: &Response| field.lost_focus();
    let left = fields.iter().position(is_left);
    let next = left.and_then(|left| fields.get(left + 1));
    if let Some(next) = next.filter(|_| ui.input(|input| input.key_pressed(Key::Enter))) {
        next.request_focus();
    }
}

/// Text of a field, trimmed; none if it is empty.
pub fn typed(text: &str) -> Option<String> {
    let text = text.trim();
    (!text.is_empty()).then(|| text.to_owned())
}
