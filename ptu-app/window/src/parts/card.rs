//! Cards: the outcome of a run, a large choice, and a name with its value.

use eframe::egui::{
    Color32, Frame, Label, Margin, Rect, Response, RichText, Role, Sense, Stroke, Ui, WidgetInfo,
    vec2,
};
use egui_material_icons::MaterialIcon;

use super::{Face, Look};
use crate::{Palette, Sizes};

/// Width of a card's stripe, and margin between its edge and its content, points.
const STRIPE: f32 = 6.0;
const INNER: i8 = 16;
/// Width of a message that something is missing, points.
const EMPTY: f32 = 420.0;

/// Card of an outcome: an icon and a word in the outcome's colour, a count and a headline.
pub struct Card<'a> {
    pub icon: MaterialIcon,
    pub word: &'a str,
    pub colour: Color32,
    /// Count beside the word, as text.
    pub count: &'a str,
    pub headline: &'a str,
}

impl Card<'_> {
    pub fn show(&self, ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
        let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
        let shown = ground(&palette).show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.horizontal_wrapped(|ui| {
                let icon = RichText::new(self.icon.codepoint).family(self.icon.font_family());
                let icon = ui.label(icon.size(sizes.icon + 4.0).color(self.colour));
                icon.widget_info(|| WidgetInfo::labeled(Role::Image, true, ""));
                ui.label(RichText::new(self.word).size(sizes.lead).color(self.colour));
                ui.label(RichText::new(self.count).color(palette.quiet));
            });
            let headline = RichText::new(self.headline).size(sizes.headline);
            ui.label(headline.color(palette.ink));
            content(ui);
        });
        let rect = shown.response.rect;
        let stripe = Rect::from_min_size(rect.min, vec2(STRIPE, rect.height()));
        ui.painter().rect_filled(stripe, 3.0, self.colour);
    }
}

pub fn ground(palette: &Palette) -> Frame {
    let line = Stroke::new(1.0, palette.grid);
    let frame = Frame::new().fill(palette.panel).stroke(line);
    frame.corner_radius(8).inner_margin(Margin::same(INNER))
}

/// Message that something is missing, with a button if there is a way to get it; true when the button was clicked.
pub fn empty(
    ui: &mut Ui,
    icon: MaterialIcon,
    (missing, below): (&str, &str),
    button: Option<&str>,
) -> bool {
    let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
    ui.vertical_centered(|ui| {
        ui.add_space((ui.available_height() / 4.0).max(0.0));
        ui.set_max_width(EMPTY);
        let icon = RichText::new(icon.codepoint).family(icon.font_family());
        let icon = ui.label(icon.size(2.0 * sizes.icon).color(palette.quiet));
        icon.widget_info(|| WidgetInfo::labeled(Role::Image, true, ""));
        ui.label(RichText::new(missing).size(sizes.lead).color(palette.ink));
        if !below.is_empty() {
            ui.label(RichText::new(below).color(palette.quiet));
        }
        button.is_some_and(|name| Face::new(Look::Secondary, name).show(ui).clicked())
    })
    .inner
}

/// A large button to choose something, with a line of text below its name.
pub fn choice(ui: &mut Ui, (name, below): (&str, &str), chosen: bool, size: [f32; 2]) -> Response {
    let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
    let enabled = ui.is_enabled();
    let (rect, response) = ui.allocate_exact_size(size.into(), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, enabled, chosen, name));
    let (fill, line) = match chosen {
        true => (palette.chosen, Stroke::new(2.0, palette.accent)),
        false if response.hovered() => (palette.hover, Stroke::new(1.0, palette.edge)),
        false => (palette.panel, Stroke::new(1.0, palette.grid)),
    };
    let painter = ui.painter();
    painter.rect(rect, 8.0, fill, line, eframe::egui::StrokeKind::Inside);
    let inner = rect.shrink2(vec2(f32::from(INNER), 4.0));
    let parts = [
        (name, sizes.body, palette.ink),
        (below, sizes.caption, palette.quiet),
    ];
    let parts = parts.into_iter().filter(|(text, ..)| !text.is_empty());
    let count = parts.clone().count() as f32;
    let high = inner.height() / count.max(1.0);
    for (place, (text, size, ink)) in (0u8..).zip(parts) {
        let top = inner.top() + high * f32::from(place);
        let area = Rect::from_x_y_ranges(inner.x_range(), top..=top + high);
        let font = eframe::egui::FontId::proportional(size);
        super::lane::cut_text(painter, area, text.to_owned(), font, ink);
    }
    super::focus_ring(ui, rect, &response);
    response
}

/// A name above its value.
pub fn fact(ui: &mut Ui, name: &str, value: &str) {
    let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
    ui.label(RichText::new(name).size(sizes.caption).color(palette.quiet));
    let value = RichText::new(value).color(palette.ink);
    ui.add(Label::new(value).truncate());
    ui.add_space(8.0);
}

/// A title above other widgets.
pub fn title(ui: &mut Ui, text: &str) {
    let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
    ui.label(RichText::new(text).size(sizes.title).color(palette.ink));
    ui.add_space(4.0);
}
