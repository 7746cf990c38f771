//! Frames with a heading, and names with values in columns.

use eframe::egui::{
    Align2, AsIdSalt, Color32, FontId, FontSelection, Frame, Margin, Painter, Pos2, Rect, RichText,
    Role, Sense, Stroke, TextWrapMode, Ui, WidgetInfo, WidgetText, pos2, vec2,
};

use crate::Palette;

/// Height of a name with its value, points.
const LINE: f32 = 17.0;
/// Font size of names, points.
const NAME: f32 = 12.0;
/// Font size of values, points.
const VALUE: f32 = 14.0;
/// Greatest share of a column's width for a name, and greatest width of a name, points.
const NAME_SHARE: f32 = 0.52;
const NAME_MOST: f32 = 118.0;
/// Gap between columns, points.
const BETWEEN: f32 = 14.0;

pub fn card(ui: &mut Ui, title: &str, add: impl FnOnce(&mut Ui)) {
    framed(ui, |ui| {
        heading(ui, title);
        add(ui);
    });
}

/// An outline around a group; a filled background would be most of the painting of a live page.
pub fn framed(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    Frame::new()
        .stroke(Stroke::new(1.0, Palette::of(ui).grid))
        .corner_radius(6)
        .inner_margin(Margin::symmetric(8, 4))
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.spacing_mut().item_spacing.y = 2.0;
            add(ui);
        });
}

/// A frame's heading.
pub fn heading(ui: &mut Ui, title: &str) {
    let quiet = Palette::of(ui).quiet;
    ui.label(RichText::new(title).size(NAME).color(quiet).strong());
}

pub struct Fact {
    pub name: &'static str,
    pub value: String,
    /// The value's colour; none = the colour of text.
    pub colour: Option<Color32>,
}

impl Fact {
    /// A value in the colour of text.
    pub fn new(name: &'static str, value: impl Into<String>) -> Self {
        Self {
            name,
            value: value.into(),
            colour: None,
        }
    }

    /// Sets the value's colour, so that it stands out.
    pub fn coloured(mut self, colour: Option<Color32>) -> Self {
        self.colour = colour;
        self
    }
}

/// Names with values, filled column by column.
pub fn facts(ui: &mut Ui, columns: usize, facts: &[Fact]) {
    let palette = Palette::of(ui);
    let rows = facts.len().div_ceil(columns.max(1));
    let size = vec2(ui.available_width(), rows as f32 * LINE);
    let (area, _) = ui.allocate_exact_size(size, Sense::hover());
    let width = (area.width() + BETWEEN) / columns.max(1) as f32;
    for (place, fact) in facts.iter().enumerate() {
        let (column, row) = (place / rows.max(1), place % rows.max(1));
        let corner = area.min + vec2(column as f32 * width, row as f32 * LINE);
        let rect = Rect::from_min_size(corner, vec2(width - BETWEEN, LINE));
        let name_width = (rect.width() * NAME_SHARE).min(NAME_MOST);
        let name = RichText::new(fact.name).size(NAME).color(palette.quiet);
        write(
            ui,
            pos2(rect.left(), rect.center().y),
            name_width - 4.0,
            name,
        );
        let colour = fact.colour.unwrap_or(ui.visuals().strong_text_color());
        let value = RichText::new(&fact.value).size(VALUE).color(colour);
        let at = pos2(rect.left() + name_width, rect.center().y);
        write(ui, at, rect.width() - name_width, value);
        named(ui, rect, ("fact", fact.name), || {
            format!("{}: {}", fact.name, fact.value)
        });
    }
}

/// Writes one line of text from this point to the right, cut at `width`.
pub fn write(ui: &Ui, left_middle: Pos2, width: f32, text: RichText) {
    let galley = WidgetText::from(text).into_galley(
        ui,
        Some(TextWrapMode::Truncate),
        width,
        FontSelection::Default,
    );
    let at = left_middle - vec2(0.0, galley.size().y / 2.0);
    ui.painter().galley(at, galley, ui.visuals().text_color());
}

/// Names a painted area for screen readers, and shows the full name under the pointer.
pub fn named(ui: &Ui, rect: Rect, salt: impl AsIdSalt, name: impl Fn() -> String) {
    let response = ui.interact(rect, ui.scope_id().with(salt), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, name()));
    if response.hovered() {
        response.on_hover_text(name());
    }
}

/// Text that begins at this point.
pub fn put_left(painter: &Painter, at: Pos2, size: f32, colour: Color32, text: &str) {
    let font = FontId::proportional(size);
    painter.text(at, Align2::LEFT_CENTER, text, font, colour);
}

/// Text centred on this point.
pub fn put_centred(painter: &Painter, at: Pos2, size: f32, colour: Color32, text: &str) {
    let font = FontId::proportional(size);
    painter.text(at, Align2::CENTER_CENTER, text, font, colour);
}
