//! Density of the window's layout: large for an operator at arm's length, or dense for an engineer.

use eframe::egui::{Context, Id, Style, TextStyle, Ui};
use serde::{Deserialize, Serialize};

/// The reader that the window is laid out for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Density {
    /// Large text and buttons; no names that occur only in scripts.
    Operator,
    /// Shows as much as there is room for.
    #[default]
    Engineer,
}

impl Density {
    /// Sizes of this density; they do not grow with the window.
    pub const fn sizes(self) -> Sizes {
        match self {
            Self::Operator => Sizes {
                caption: 14.0,
                body: 18.0,
                lead: 20.0,
                title: 24.0,
                headline: 34.0,
                icon: 22.0,
                target: 48.0,
                bar: 56.0,
                footer: 80.0,
                density: self,
            },
            Self::Engineer => Sizes {
                caption: 12.0,
                body: 14.0,
                lead: 16.0,
                title: 20.0,
                headline: 28.0,
                icon: 18.0,
                target: 28.0,
                bar: 40.0,
                footer: 56.0,
                density: self,
            },
        }
    }

    /// Sets the sizes of the window.
    pub fn keep(self, context: &Context) {
        let sizes = self.sizes();
        if context.data(|data| data.get_temp(id())) != Some(sizes) {
            context.data_mut(|data| data.insert_temp(id(), sizes));
            context.all_styles_mut(|style| sizes.set(style));
        }
    }
}

/// Sizes, points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Size of text that explains another text.
    pub caption: f32,
    pub body: f32,
    /// Size of a page's main text.
    pub lead: f32,
    pub title: f32,
    pub headline: f32,
    pub icon: f32,
    /// Height of buttons and rows.
    pub target: f32,
    /// Height of the bar above the pages.
    pub bar: f32,
    /// Height of the foot of a page.
    pub footer: f32,
    pub density: Density,
}

impl Sizes {
    /// Present sizes of the window.
    pub fn of(ui: &Ui) -> Self {
        let kept = ui.data(|data| data.get_temp(id()));
        kept.unwrap_or_else(|| Density::default().sizes())
    }

    fn set(self, style: &mut Style) {
        for (text, size) in [
            (TextStyle::Body, self.body),
            (TextStyle::Button, self.body),
            (TextStyle::Monospace, self.body - 1.0),
            (TextStyle::Small, self.caption),
            (TextStyle::Heading, self.title),
        ] {
            if let Some(font) = style.text_styles.get_mut(&text) {
                font.size = size;
            }
        }
        style.spacing.interact_size.y = self.target;
    }
}

fn id() -> Id {
    Id::unique("sizes")
}
