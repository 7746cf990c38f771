//! Colours with a meaning, for the light and the dark window. A word or a shape stands beside each coloured mark.

use btu_rig::procedure::Verdict;
use eframe::egui::{Color32, Context, Stroke, Theme, Ui, Visuals};

/// Colours of the window.
#[derive(Clone, Copy, Debug)]
pub struct Palette {
    /// Dark window.
    pub dark: bool,
    /// Background of pages.
    pub ground: Color32,
    /// Background of bar, rails and cards.
    pub panel: Color32,
    /// Background of dialogs and passing messages.
    pub raised: Color32,
    /// Background of input fields.
    pub well: Color32,
    pub control: Color32,
    pub hover: Color32,
    /// Lines behind curves and between parts.
    pub grid: Color32,
    pub edge: Color32,
    /// Text colour of the greatest contrast with the background.
    pub ink: Color32,
    pub second: Color32,
    /// Text colour of labels.
    pub quiet: Color32,
    /// Colour of a choice, an acting button and the first curve.
    pub accent: Color32,
    /// Background of the primary button, whose text is white.
    pub fill: Color32,
    /// Background of a chosen entry.
    pub chosen: Color32,
    pub bad: Color32,
    pub bad_ground: Color32,
    /// Colour of what could not be tested or needs a look.
    pub warn: Color32,
    pub warn_ground: Color32,
    pub good: Color32,
    /// Colour of an armed unit, more conspicuous than all others.
    pub armed: Color32,
    /// Colours of curves, in the order they are added; distinct for the common kinds of colour blindness.
    pub curves: [Color32; 6],
}

const DARK: Palette = Palette {
    dark: true,
    ground: rgb(0x131619),
    panel: rgb(0x1A1E22),
    raised: rgb(0x22272D),
    well: rgb(0x0E1114),
    control: rgb(0x2D343B),
    hover: rgb(0x384049),
    grid: rgb(0x333A42),
    edge: rgb(0x78838F),
    ink: rgb(0xECEFF2),
    second: rgb(0xBAC2CB),
    quiet: rgb(0x929BA6),
    accent: rgb(0x74B4FF),
    fill: rgb(0x1F6FC9),
    chosen: rgb(0x1D3450),
    bad: rgb(0xFF7A70),
    bad_ground: rgb(0x3B1F1F),
    warn: rgb(0xF0B648),
    warn_ground: rgb(0x37290F),
    good: rgb(0x63CB8E),
    armed: rgb(0xC62828),
    curves: [
        rgb(0x56B4E9),
        rgb(0xE69F00),
        rgb(0x00BE8C),
        rgb(0xF0E442),
        rgb(0xE08CBE),
        rgb(0xFF783C),
    ],
};

const LIGHT: Palette = Palette {
    dark: false,
    ground: rgb(0xEEF0F3),
    panel: rgb(0xFAFBFC),
    raised: rgb(0xFFFFFF),
    well: rgb(0xFFFFFF),
    control: rgb(0xE4E8EC),
    hover: rgb(0xD5DBE1),
    grid: rgb(0xD3D9DF),
    edge: rgb(0x78828D),
    ink: rgb(0x161B20),
    second: rgb(0x414A54),
    quiet: rgb(0x5B6570),
    accent: rgb(0x0B5CB5),
    fill: rgb(0x0B5CB5),
    chosen: rgb(0xD6E6F8),
    bad: rgb(0xB3221B),
    bad_ground: rgb(0xFBE6E4),
    warn: rgb(0x805200),
    warn_ground: rgb(0xFBEFD5),
    good: rgb(0x156A39),
    armed: rgb(0xBF1F1F),
    curves: [
        rgb(0x0072B2),
        rgb(0xB46E00),
        rgb(0x00825F),
        rgb(0x8C7800),
        rgb(0xAA4682),
        rgb(0xC85000),
    ],
};

/// A colour from its code 0xRRGGBB.
const fn rgb(code: u32) -> Color32 {
    let [_, red, green, blue] = code.to_be_bytes();
    Color32::from_rgb(red, green, blue)
}

/// Gives the window its look: text large enough to be read at arm's length.
pub fn set(context: &Context) {
    for (theme, palette) in [(Theme::Dark, DARK), (Theme::Light, LIGHT)] {
        context.set_visuals_of(theme, visuals(theme, &palette));
    }
    context.all_styles_mut(|style| {
        style.spacing.item_spacing = [8.0, 5.0].into();
        style.spacing.button_padding = [8.0, 3.5].into();
        // No animations: each would repaint the window many times for a movement nobody notices.
        style.animation_time = 0.0;
    });
}

/// Colours of what the toolkit paints by itself.
fn visuals(theme: Theme, palette: &Palette) -> Visuals {
    let mut visuals = theme.default_visuals();
    // The window is cleared with its background colour already; painting it again under each panel costs time.
    visuals.panel_fill = Color32::TRANSPARENT;
    visuals.window_fill = palette.raised;
    visuals.window_stroke = Stroke::new(1.0, palette.grid);
    visuals.extreme_bg_color = palette.well;
    visuals.faint_bg_color = palette.panel;
    visuals.hyperlink_color = palette.accent;
    visuals.selection.bg_fill = palette.chosen;
    visuals.selection.stroke = Stroke::new(1.0, palette.ink);
    let widgets = &mut visuals.widgets;
    for (widget, ground, line, ink) in [
        (
            &mut widgets.noninteractive,
            palette.panel,
            palette.grid,
            palette.second,
        ),
        (
            &mut widgets.inactive,
            palette.control,
            palette.edge,
            palette.ink,
        ),
        (
            &mut widgets.hovered,
            palette.hover,
            palette.edge,
            palette.ink,
        ),
        (
            &mut widgets.active,
            palette.chosen,
            palette.accent,
            palette.ink,
        ),
        (
            &mut widgets.open,
            palette.control,
            palette.edge,
            palette.ink,
        ),
    ] {
        (widget.bg_fill, widget.weak_bg_fill) = (ground, ground);
        widget.bg_stroke = Stroke::new(1.0, line);
        widget.fg_stroke.color = ink;
        widget.corner_radius = 6.into();
        widget.expansion = 0.0;
    }
    visuals
}

/// The window's ground, below all that is drawn.
pub fn ground(visuals: &Visuals) -> Color32 {
    Palette::of_mode(visuals.dark_mode).ground
}

impl Palette {
    /// Palette of the window as it is.
    pub fn of(ui: &Ui) -> Self {
        Self::of_mode(ui.visuals().dark_mode)
    }

    fn of_mode(dark: bool) -> Self {
        if dark { DARK } else { LIGHT }
    }

    /// A verdict's colour.
    pub fn verdict(&self, verdict: Verdict) -> Color32 {
        match verdict {
            Verdict::Passed => self.good,
            Verdict::Failed => self.bad,
            Verdict::Error | Verdict::Inconclusive | Verdict::Aborted => self.warn,
            Verdict::Skipped => self.quiet,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast of two colours (WCAG 2, relative luminance).
    fn contrast(one: Color32, other: Color32) -> f64 {
        let luminance = |colour: Color32| {
            let part = |value: u8| {
                let share = f64::from(value) / 255.0;
                match share <= 0.04045 {
                    true => share / 12.92,
                    false => ((share + 0.055) / 1.055).powf(2.4),
                }
            };
            0.2126 * part(colour.r()) + 0.7152 * part(colour.g()) + 0.0722 * part(colour.b())
        };
        let (one, other) = (luminance(one) + 0.05, luminance(other) + 0.05);
        one.max(other) / one.min(other)
    }

    /// Goal: every text can be read, in a dark cab and in the sun. Method: contrast of each text colour, and of edges,
    /// with each background on which they are used.
    #[test]
    fn every_ink_has_contrast_on_every_ground_it_stands_on() {
        for palette in [DARK, LIGHT] {
            let Palette {
                ground,
                panel,
                raised,
                ..
            } = palette;
            let inks = [
                palette.ink,
                palette.second,
                palette.quiet,
                palette.accent,
                palette.bad,
                palette.warn,
                palette.good,
            ];
            let pairs = inks
                .iter()
                .flat_map(|ink| [ground, panel, raised].map(|ground| (*ink, ground)));
            let others = [
                (palette.ink, palette.control),
                (palette.ink, palette.hover),
                (palette.ink, palette.chosen),
                (palette.ink, palette.well),
                (palette.bad, palette.bad_ground),
                (palette.warn, palette.warn_ground),
                (Color32::WHITE, palette.fill),
                (Color32::WHITE, palette.armed),
            ];
            for (ink, ground) in pairs.chain(others) {
                let contrast = contrast(ink, ground);
                assert!(contrast >= 4.5, "{ink:?} on {ground:?}: {contrast:.2}");
            }
            assert!(contrast(palette.edge, palette.panel) >= 3.0);
        }
    }
}
