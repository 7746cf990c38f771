//! How large the window's frame and the page of a case are: for an operator who reads and touches at arm's length, or as
//! dense as an engineer's pages.

use eframe::egui::{Context, Id, TextStyle, Ui};
use serde::{Deserialize, Serialize};

/// Width of the window for which an operator's sizes are given, and the least and greatest share of them, points.
const WIDTH: f32 = 1280.0;
const SHARE: [f32; 2] = [0.8, 1.5];

/// Who the window is laid out for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Density {
    /// Large text and targets, which grow with the window; nothing that only scripts name.
    Operator,
    /// As much as there is room for.
    #[default]
    Engineer,
}

impl Density {
    /// The other one.
    pub fn other(self) -> Self {
        match self {
            Self::Operator => Self::Engineer,
            Self::Engineer => Self::Operator,
        }
    }

    fn sizes(self, width: f32) -> Sizes {
        let share = (width / WIDTH).clamp(SHARE[0], SHARE[1]);
        match self {
            Self::Operator => Sizes {
                headline: 32.0 * share,
                text: 18.0 * share,
                body: 18.0 * share,
                target: 48.0 * share,
                lowest: 48.0 * share,
                density: self,
            },
            Self::Engineer => Sizes {
                headline: 24.0,
                text: 17.0,
                body: 14.5,
                target: 48.0,
                lowest: 24.0,
                density: self,
            },
        }
    }

    /// The sizes of this window from now on.
    pub fn keep(self, context: &Context) {
        let sizes = self.sizes(context.content_rect().width());
        context.data_mut(|data| data.insert_temp(id(), sizes));
    }
}

/// Sizes, points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// What is read first.
    pub headline: f32,
    /// What the page is about.
    pub text: f32,
    /// All other text.
    pub body: f32,
    /// Height of what the way of a case goes over.
    pub target: f32,
    /// Height of all else that can be clicked.
    pub lowest: f32,
    /// Whose they are.
    pub density: Density,
}

impl Sizes {
    /// Of the window as it is.
    pub fn of(ui: &Ui) -> Self {
        let kept = ui.data(|data| data.get_temp(id()));
        kept.unwrap_or_else(|| Density::default().sizes(WIDTH))
    }

    /// Gives all that follows in `ui` these sizes.
    pub fn set(self, ui: &mut Ui) {
        let style = ui.style_mut();
        for text in [TextStyle::Body, TextStyle::Button] {
            if let Some(font) = style.text_styles.get_mut(&text) {
                font.size = self.body;
            }
        }
        style.spacing.interact_size.y = self.lowest;
    }
}

fn id() -> Id {
    Id::unique("sizes")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_operators_sizes_follow_the_width_and_an_engineers_do_not() {
        let of = |density: Density, width| density.sizes(width).lowest;
        assert_eq!(of(Density::Operator, 1280.0), 48.0);
        assert!(of(Density::Operator, 1920.0) > 70.0);
        assert!(of(Density::Operator, 600.0) > 38.0, "still to be hit");
        for width in [600.0, 1280.0, 1920.0] {
            assert_eq!(of(Density::Engineer, width), 24.0);
        }
    }
}
