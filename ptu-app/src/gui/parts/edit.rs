//! Text fields that accept no more than the database stores.

use eframe::egui::TextEdit;
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
