//! Widths of letters, and line breaking by them.

use krilla::text::{GlyphId, KrillaGlyph};
use protocol::display_text;
use ttf_parser::Face;

use crate::fonts::PRETENDARD;
use ptu_runs::failure::{Failure, FileTrouble, Why};

/// The shipped font, measured.
pub struct FontMetrics {
    face: Face<'static>,
    per_em: f32,
    /// Glyph number and width of each ASCII letter, looked up once: most texts are made of these letters.
    ascii: [(u32, f32); 128],
}

impl FontMetrics {
    /// Reads the shipped font.
    ///
    /// # Errors
    /// The font cannot be read.
    pub fn new() -> Result<Self, Failure> {
        let face = Face::parse(PRETENDARD, 0)
            .map_err(|error| Failure::bench(FileTrouble::FontUnread(Why::of(error))))?;
        let per_em = f32::from(face.units_per_em());
        let ascii = [(0, 0.0); 128];
        let mut letters = Self {
            face,
            per_em,
            ascii,
        };
        letters.ascii = std::array::from_fn(|code| letters.look_up(code as u8 as char));
        Ok(letters)
    }

    /// Width of a text, in units of its size.
    fn em(&self, text: &str) -> f32 {
        text.chars().map(|letter| self.letter(letter).1).sum()
    }

    /// Width of a text on one line, pt.
    pub fn width(&self, text: &str, size: f32) -> f32 {
        self.em(text) * size
    }

    /// The text as glyphs side by side; a control character is a space.
    pub fn glyphs(&self, text: &str) -> Vec<KrillaGlyph> {
        let glyph = |(at, letter): (usize, char)| {
            let (id, advance) = self.letter(letter);
            let range = at..at + letter.len_utf8();
            KrillaGlyph::new(GlyphId::new(id), advance, 0.0, 0.0, 0.0, range, None)
        };
        text.char_indices().map(glyph).collect()
    }

    /// The text with a code in place of each letter that the font lacks; `None` if the font has all its letters.
    pub fn coded(&self, text: &str) -> Option<String> {
        let written = |letter: char| match self.lacks(letter) {
            true => code(letter),
            false => letter.to_string(),
        };
        let any = text.contains(|letter| self.lacks(letter));
        any.then(|| text.chars().map(written).collect())
    }

    /// The font has no such letter.
    pub fn lacks(&self, letter: char) -> bool {
        self.letter(letter).0 == 0
    }

    /// Number and width of a letter's glyph; of a letter that the font lacks 0, and the width of its code.
    fn letter(&self, letter: char) -> (u32, f32) {
        match self.ascii.get(letter as usize) {
            Some(known) => *known,
            None => self.look_up(letter),
        }
    }

    fn look_up(&self, letter: char) -> (u32, f32) {
        let letter = if letter.is_control() { ' ' } else { letter };
        let Some(id) = self.face.glyph_index(letter) else {
            return (0, self.em(&code(letter)));
        };
        let advance = self.face.glyph_hor_advance(id).unwrap_or_default();
        (u32::from(id.0), f32::from(advance) / self.per_em)
    }

    /// The text in lines no wider than `width`: broken at spaces, and words wider than a line anywhere. What
    /// cannot be seen is spelled. A line keeps the space or line feed at its end, which hangs over the edge.
    pub fn lines(&self, text: &str, size: f32, width: f32) -> Vec<String> {
        let mut lines = Vec::new();
        for paragraph in display_text::lines(text).replace('\t', " ").lines() {
            let mut line = String::new();
            for word in paragraph.split_inclusive(' ') {
                if self.width(&format!("{line}{}", word.trim_end()), size) <= width {
                    line += word;
                    continue;
                }
                if !line.is_empty() {
                    lines.push(std::mem::take(&mut line));
                }
                for letter in word.chars() {
                    let longer = self.width(&line, size) + self.letter(letter).1 * size;
                    if !line.is_empty() && letter != ' ' && longer > width {
                        lines.push(std::mem::take(&mut line));
                    }
                    line.push(letter);
                }
            }
            line.push('\n');
            lines.push(line);
        }
        let last = lines.pop().unwrap_or_default();
        lines.push(last.trim_end().to_owned());
        lines
    }
}

/// Text in place of a letter that the font lacks: Chinese, Japanese, pictures.
fn code(letter: char) -> String {
    format!("[U+{:04x}]", u32::from(letter))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_font_lacks_has_the_width_of_its_code_and_is_written_so() {
        let letters = FontMetrics::new().expect("the font");
        assert_eq!(letters.coded("가 A\n–"), None);
        let coded = letters.coded("가中b").expect("a code");
        assert_eq!(coded, "가[U+4e2d]b");
        assert!((letters.width("가中b", 8.0) - letters.width(&coded, 8.0)).abs() < 1e-3);
        assert_eq!(letters.coded(&coded), None);
    }

    #[test]
    fn lines_are_no_wider_than_asked_for_and_nothing_is_lost() {
        let letters = FontMetrics::new().expect("the font");
        let text = "비상제동 계전기가 늦게\n떨어진다 and 0123456789abcdef0123456789abcdef0123456789abcdef ends";
        for width in [30.0, 60.0, 200.0] {
            let lines = letters.lines(text, 8.0, width);
            for line in &lines {
                assert!(letters.width(line.trim_end(), 8.0) <= width, "{line}");
            }
            assert_eq!(lines.concat(), text);
        }
    }

    #[test]
    fn every_letter_of_the_catalogue_is_in_the_font() {
        let letters = FontMetrics::new().expect("the font");
        let special = "–−…→±×·°²³";
        for letter in special.chars().chain("가힣한글AZaz09".chars()) {
            assert_ne!(letters.letter(letter).0, 0, "{letter}");
        }
    }
}
