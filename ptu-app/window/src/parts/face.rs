//! Buttons, and states that look like buttons: an icon, words, and beside a disabled one the reason.

use std::borrow::Cow;

use eframe::egui::response::Flags;
use eframe::egui::{
    Color32, FontId, Galley, Key, Modifiers, Rect, Response, Role, Sense, Shape, Stroke,
    StrokeKind, Ui, Vec2, WidgetInfo, pos2, vec2,
};
use egui_material_icons::MaterialIcon;

use super::{ActionPlace, key_pressed};
use crate::{Palette, Sizes};

/// Gap between the icon and words of a face, and between its edge and its content, points.
const GAP: f32 = 8.0;
/// Distance of the focus ring from the face, points.
const OUTSIDE: f32 = 2.0;
/// Length of the dashes of a dashed edge, points.
const DASH: f32 = 4.0;
/// Gap between two dashes, points.
const DASH_GAP: f32 = 4.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// The one button of a screen that is pressed first.
    Primary,
    Secondary,
    /// No background until the pointer is over the button.
    Quiet,
    /// The chosen one of a few.
    Chosen,
    /// Stops or ends something.
    Danger,
    /// Stops something that is under way now; also an armed unit.
    Acting,
    /// An outline without a background.
    Outlined,
    /// Says something and cannot be clicked.
    State,
    /// A state that needs a look and cannot be clicked.
    Warned,
    /// A state in practice (simulated unit); it cannot be clicked.
    Dashed,
}

/// A button or a state.
pub struct Face<'a> {
    look: Look,
    icon: Option<MaterialIcon>,
    text: Cow<'a, str>,
    small: Cow<'a, str>,
    end: Option<MaterialIcon>,
    name: Option<Cow<'a, str>>,
    why_not: Option<&'a str>,
    hint: Cow<'a, str>,
    ink: Option<Color32>,
}

/// Laid-out content of a face.
struct Laid {
    parts: Vec<std::sync::Arc<Galley>>,
    size: Vec2,
}

impl<'a> Face<'a> {
    pub fn new(look: Look, text: impl Into<Cow<'a, str>>) -> Self {
        Self {
            look,
            icon: None,
            text: text.into(),
            small: Cow::Borrowed(""),
            end: None,
            name: None,
            why_not: None,
            hint: Cow::Borrowed(""),
            ink: None,
        }
    }

    pub fn icon(mut self, icon: MaterialIcon) -> Self {
        self.icon = Some(icon);
        self
    }

    /// Adds an icon after the words.
    pub fn end(mut self, icon: MaterialIcon) -> Self {
        self.end = Some(icon);
        self
    }

    /// Adds small words after the others.
    pub fn small(mut self, small: impl Into<Cow<'a, str>>) -> Self {
        self.small = small.into();
        self
    }

    /// Sets the name for screen readers, where it differs from the text.
    pub fn named(mut self, name: impl Into<Cow<'a, str>>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// Disables the button if there is a reason, which is shown beside it.
    pub fn off(mut self, why_not: Option<&'a str>) -> Self {
        self.why_not = why_not;
        self
    }

    /// Disables the button for a reason that is shown while the pointer is over it, where there is
    /// no room beside it.
    pub fn because(mut self, why_not: Option<&'a str>) -> Self {
        if let Some(why) = why_not {
            (self.why_not, self.hint) = (Some(""), why.into());
        }
        self
    }

    /// Sets the text that is shown while the pointer is over the button.
    pub fn hint(mut self, hint: impl Into<Cow<'a, str>>) -> Self {
        self.hint = hint.into();
        self
    }

    /// Sets the colour of the letters, whatever the look.
    pub fn ink(mut self, ink: Color32) -> Self {
        self.ink = Some(ink);
        self
    }

    /// Width of the button, points.
    pub fn wide(&self, ui: &Ui) -> f32 {
        self.laid(ui, Color32::WHITE, Color32::WHITE).size.x
    }

    /// Shows the button, and beside a disabled one the reason.
    pub fn show(&self, ui: &mut Ui) -> Response {
        self.shown(ui, Sense::click(), &|_, _| 0.0)
    }

    /// Shows a button that is to be held down and fills meanwhile; true once it was held long enough.
    pub fn held(&self, ui: &mut Ui, place: &ActionPlace) -> bool {
        let done = std::cell::Cell::new(false);
        // A widget that senses only clicks does not stay down for long.
        self.shown(ui, Sense::click_and_drag(), &|ui, response| {
            let share = place.held(ui, response);
            done.set(share >= 1.0);
            share
        });
        done.get()
    }

    fn shown(&self, ui: &mut Ui, sense: Sense, held: &dyn Fn(&Ui, &Response) -> f32) -> Response {
        let palette = Palette::of(ui);
        let is_state = matches!(self.look, Look::State | Look::Warned | Look::Dashed);
        let on = self.why_not.is_none() && ui.is_enabled();
        let sense = match on && !is_state {
            true => sense,
            false => Sense::hover(),
        };
        let (ink, quiet) = self.inks(&palette, on);
        let ink = self.ink.unwrap_or(ink);
        let laid = self.laid(ui, ink, quiet);
        let (rect, mut response) = ui.allocate_exact_size(laid.size, sense);
        let by_key = || key_pressed(ui.ctx(), Modifiers::COMMAND, Key::Enter);
        if self.look == Look::Primary && on && by_key() {
            response.flags |= Flags::FAKE_PRIMARY_CLICKED;
        }
        let role = if is_state { Role::Label } else { Role::Button };
        let name = self.name.as_ref().unwrap_or(&self.text);
        response.widget_info(|| match self.look {
            Look::Chosen => WidgetInfo::selected(role, on, true, &**name),
            _ => WidgetInfo::labeled(role, on, &**name),
        });
        let share = if on { held(ui, &response) } else { 0.0 };
        self.paint(ui, rect, (&response, on, share), &palette);
        let mut x = match is_state && self.look == Look::State {
            true => rect.left(),
            false => rect.left() + padding(ui),
        };
        for part in laid.parts {
            let at = pos2(x, rect.center().y - part.size().y / 2.0);
            x += part.size().x + GAP;
            ui.painter().galley(at, part, ink);
        }
        match self.why_not {
            Some(why) if !why.is_empty() => {
                ui.small(why);
            }
            _ => {}
        }
        match self.hint.is_empty() {
            true => response,
            false => response.on_hover_text(&*self.hint),
        }
    }

    fn paint(
        &self,
        ui: &Ui,
        rect: Rect,
        (response, on, share): (&Response, bool, f32),
        palette: &Palette,
    ) {
        let over = on && response.hovered();
        let none = Color32::TRANSPARENT;
        let (ground, line) = match (self.look, on) {
            (Look::State, _) => (none, none),
            (Look::Warned, _) => (palette.warn_ground, none),
            (Look::Dashed, _) => (none, none),
            (Look::Quiet, false) => (none, none),
            (_, false) => (none, palette.grid),
            (Look::Primary, true) if over => {
                (palette.fill.lerp_to_gamma(palette.accent, 0.2), none)
            }
            (Look::Primary, true) => (palette.fill, none),
            (Look::Acting, true) => (palette.armed, palette.armed),
            (Look::Chosen, true) => (palette.chosen, none),
            (Look::Danger, true) if over => (palette.bad_ground, palette.bad),
            (Look::Danger, true) => (none, palette.bad),
            (Look::Secondary, true) if !over => (palette.control, none),
            (Look::Outlined, true) if !over => (none, palette.edge),
            (Look::Outlined, true) => (palette.hover, palette.edge),
            (Look::Quiet, true) if !over => (none, none),
            (_, true) => (palette.hover, none),
        };
        let painter = ui.painter();
        let stroke = Stroke::new(1.0, line);
        painter.rect(rect, 6.0, ground, stroke, StrokeKind::Inside);
        if share > 0.0 {
            let wide = vec2(rect.width() * share, rect.height());
            let filled = Rect::from_min_size(rect.min, wide);
            painter.rect_filled(filled, 6.0, palette.armed);
        }
        if self.look == Look::Dashed {
            let dashed = Stroke::new(1.0, palette.edge);
            painter.extend(dashed_outline(rect.shrink(0.5), dashed, DASH));
        }
        focus_ring(ui, rect, response);
    }

    fn inks(&self, palette: &Palette, on: bool) -> (Color32, Color32) {
        match self.look {
            Look::State => (palette.second, palette.quiet),
            Look::Dashed => (palette.second, palette.quiet),
            Look::Warned => (palette.warn, palette.warn),
            _ if !on => (palette.quiet, palette.quiet),
            Look::Primary | Look::Acting => (Color32::WHITE, Color32::WHITE),
            Look::Danger => (palette.bad, palette.bad),
            Look::Secondary | Look::Outlined | Look::Chosen => (palette.ink, palette.quiet),
            Look::Quiet => (palette.second, palette.quiet),
        }
    }

    fn laid(&self, ui: &Ui, ink: Color32, quiet: Color32) -> Laid {
        let sizes = Sizes::of(ui);
        let painter = ui.painter();
        let icon = |icon: MaterialIcon| {
            let font = FontId::new(sizes.icon, icon.font_family());
            painter.layout_no_wrap(icon.codepoint.to_owned(), font, ink)
        };
        let words = |text: &Cow<'_, str>, size, ink| {
            let font = FontId::proportional(size);
            (!text.is_empty()).then(|| painter.layout_no_wrap(text.to_string(), font, ink))
        };
        let parts = [
            self.icon.map(icon),
            words(&self.text, sizes.body, ink),
            words(&self.small, sizes.caption, quiet),
            self.end.map(icon),
        ];
        let parts: Vec<_> = parts.into_iter().flatten().collect();
        let around = match self.look {
            Look::State => 0.0,
            _ => 2.0 * padding(ui),
        };
        let gaps = GAP * parts.len().saturating_sub(1) as f32;
        let wide = parts.iter().map(|part| part.size().x).sum::<f32>() + gaps + around;
        let high = ui.spacing().interact_size.y;
        Laid {
            parts,
            size: vec2(wide.ceil(), high),
        }
    }
}

/// Outline of a rectangle in dashes that are `dash` points long.
pub fn dashed_outline(edge: Rect, stroke: Stroke, dash: f32) -> Vec<Shape> {
    let corners = [
        edge.left_top(),
        edge.right_top(),
        edge.right_bottom(),
        edge.left_bottom(),
        edge.left_top(),
    ];
    Shape::dashed_line(&corners, stroke, dash, DASH_GAP)
}

/// Area of one entry of a choice, with `name` for screen readers; its background shows whether the entry is chosen
/// or pointed at, a ring that it has the keyboard focus.
pub fn selectable(ui: &mut Ui, size: Vec2, (name, chosen): (&str, bool)) -> (Rect, Response) {
    let palette = Palette::of(ui);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let enabled = ui.is_enabled();
    response.widget_info(|| WidgetInfo::selected(Role::Button, enabled, chosen, name));
    let ground = match chosen {
        true => palette.chosen,
        false if response.hovered() => palette.hover,
        false => Color32::TRANSPARENT,
    };
    ui.painter().rect_filled(rect, 6.0, ground);
    focus_ring(ui, rect.shrink(3.0), &response);
    (rect, response)
}

/// Draws a ring around a widget that has the keyboard focus.
pub fn focus_ring(ui: &Ui, rect: Rect, response: &Response) {
    if response.has_focus() {
        let stroke = Stroke::new(2.0, Palette::of(ui).accent);
        let painter = ui.painter();
        painter.rect_stroke(rect.expand(OUTSIDE), 8.0, stroke, StrokeKind::Outside);
    }
}

fn padding(ui: &Ui) -> f32 {
    Sizes::of(ui).body * 0.75
}
