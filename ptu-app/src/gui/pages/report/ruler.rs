//! How high texts are. Most fit a line; that is told by the widths of their letters alone, so that a
//! sheet of thousands of cells is measured in a few milliseconds.

use eframe::egui::{Color32, FontId, Ui};

/// Letters whose widths are known beforehand.
const KNOWN: usize = 128;
/// Letters placed beside each other may take a little more than their widths.
const SPARE: f32 = 0.97;

/// Measures texts.
pub struct Ruler<'a> {
    ui: &'a Ui,
    sizes: Vec<Size>,
}

struct Size {
    size: f32,
    line: f32,
    widths: [f32; KNOWN],
}

impl<'a> Ruler<'a> {
    /// Of the window's letters.
    pub fn new(ui: &'a Ui) -> Self {
        Self {
            ui,
            sizes: Vec::new(),
        }
    }

    /// Height of a text in letters of this size when it is so wide, points.
    pub fn height(&mut self, text: &str, size: f32, width: f32) -> f32 {
        let place = self.sizes.iter().position(|known| known.size == size);
        let place = place.unwrap_or_else(|| {
            self.sizes.push(Size::new(self.ui, size));
            self.sizes.len() - 1
        });
        match self.sizes.get(place) {
            Some(known) if !text.contains('\n') && known.width(text) < width * SPARE => known.line,
            _ => {
                let font = FontId::proportional(size);
                let painter = self.ui.painter();
                let laid = painter.layout(text.to_owned(), font, Color32::PLACEHOLDER, width);
                laid.size().y
            }
        }
    }
}

impl Size {
    fn new(ui: &Ui, size: f32) -> Self {
        let font = FontId::proportional(size);
        ui.fonts_mut(|fonts| {
            let mut widths = [0.0; KNOWN];
            for (letter, width) in (0u8..).zip(&mut widths) {
                *width = fonts.glyph_width(&font, char::from(letter));
            }
            Self {
                size,
                line: fonts.row_height(&font),
                widths,
            }
        })
    }

    /// At least as wide as the text is: letters not known beforehand count as wide as they are high.
    fn width(&self, text: &str) -> f32 {
        let letters = text.chars();
        letters
            .map(|letter| {
                self.widths
                    .get(letter as usize)
                    .copied()
                    .unwrap_or(self.size)
            })
            .sum()
    }
}
