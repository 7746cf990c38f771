//! Colours that carry a meaning, in light and dark. None stands alone: a word or a shape stands
//! beside it.

use btu_rig::procedure::Verdict;
use eframe::egui::{Color32, Context, TextStyle, Theme, Ui, Visuals};

use ptu_runs::stored::from_stored;

/// Colours of meaning.
#[derive(Clone, Copy, Debug)]
pub struct Palette {
    /// Dark window.
    pub dark: bool,
    pub good: Color32,
    pub bad: Color32,
    /// Could not be told, or wants a look.
    pub warn: Color32,
    pub quiet: Color32,
    /// What is chosen, and the first curve.
    pub accent: Color32,
    /// Ground of the button that is pressed first; white stands on it.
    pub fill: Color32,
    /// An armed unit: outranks everything else on the screen.
    pub armed: Color32,
    /// Lines behind curves.
    pub grid: Color32,
    /// Curves, in the order they are added; told apart with the common kinds of colour blindness.
    pub curves: [Color32; 6],
}

const DARK: Palette = Palette {
    dark: true,
    good: Color32::from_rgb(86, 196, 122),
    bad: Color32::from_rgb(255, 104, 94),
    warn: Color32::from_rgb(245, 184, 65),
    quiet: Color32::from_rgb(140, 148, 158),
    accent: Color32::from_rgb(90, 169, 255),
    fill: Color32::from_rgb(31, 111, 201),
    armed: Color32::from_rgb(214, 40, 40),
    grid: Color32::from_rgb(58, 62, 68),
    curves: [
        Color32::from_rgb(86, 180, 233),
        Color32::from_rgb(230, 159, 0),
        Color32::from_rgb(0, 190, 140),
        Color32::from_rgb(240, 228, 66),
        Color32::from_rgb(224, 140, 190),
        Color32::from_rgb(255, 120, 60),
    ],
};

const LIGHT: Palette = Palette {
    dark: false,
    good: Color32::from_rgb(24, 120, 60),
    bad: Color32::from_rgb(190, 30, 30),
    warn: Color32::from_rgb(160, 98, 0),
    quiet: Color32::from_rgb(100, 108, 116),
    accent: Color32::from_rgb(0, 92, 184),
    fill: Color32::from_rgb(11, 92, 181),
    armed: Color32::from_rgb(200, 20, 20),
    grid: Color32::from_rgb(214, 217, 221),
    curves: [
        Color32::from_rgb(0, 114, 178),
        Color32::from_rgb(180, 110, 0),
        Color32::from_rgb(0, 130, 95),
        Color32::from_rgb(140, 120, 0),
        Color32::from_rgb(170, 70, 130),
        Color32::from_rgb(200, 80, 0),
    ],
};

/// Height of what can be clicked, at least, points.
const LOWEST: f32 = 24.0;

/// Gives the window its look: text large enough to be read at arm's length.
pub fn set(context: &Context) {
    for theme in [Theme::Dark, Theme::Light] {
        let mut visuals = theme.default_visuals();
        let ink = if theme == Theme::Dark { 208 } else { 40 };
        visuals.widgets.noninteractive.fg_stroke.color = Color32::from_gray(ink);
        // The window is cleared with its ground: painted again under each panel it would cost time at each pixel.
        visuals.panel_fill = Color32::TRANSPARENT;
        context.set_visuals_of(theme, visuals);
    }
    context.all_styles_mut(|style| {
        for (text, size) in [
            (TextStyle::Body, 14.5),
            (TextStyle::Button, 14.5),
            (TextStyle::Monospace, 13.0),
            (TextStyle::Heading, 19.0),
            (TextStyle::Small, 11.5),
        ] {
            if let Some(font) = style.text_styles.get_mut(&text) {
                font.size = size;
            }
        }
        style.spacing.item_spacing = [8.0, 5.0].into();
        style.spacing.button_padding = [8.0, 3.5].into();
        // What can be clicked is at least so high.
        style.spacing.interact_size.y = LOWEST;
        // What cannot be seen moving need not be painted again and again.
        style.animation_time = 0.0;
    });
}

/// The window's ground, below all that is drawn.
pub fn ground(visuals: &Visuals) -> Color32 {
    let theme = if visuals.dark_mode {
        Theme::Dark
    } else {
        Theme::Light
    };
    theme.default_visuals().panel_fill
}

impl Palette {
    /// Of the window as it is.
    pub fn of(ui: &Ui) -> Self {
        if ui.visuals().dark_mode { DARK } else { LIGHT }
    }

    /// The strongest ink there is on the window's ground.
    pub fn ink(&self) -> Color32 {
        if self.dark {
            Color32::WHITE
        } else {
            Color32::BLACK
        }
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

    /// A stored verdict's colour.
    pub fn stored_verdict(&self, verdict: fault_db::Verdict) -> Color32 {
        self.verdict(from_stored(verdict))
    }
}
