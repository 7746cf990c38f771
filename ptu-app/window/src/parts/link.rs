//! A link to another page or place.

use eframe::egui::{Button, Response, RichText, Ui};

/// Underlined words to click, as high as a button.
pub fn link(ui: &mut Ui, text: impl Into<String>) -> Response {
    let text = RichText::new(text).color(ui.visuals().hyperlink_color);
    ui.add(Button::new(text.underline()).frame(false))
}
