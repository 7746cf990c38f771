//! A test sheet as PDF on A4: blocks → pieces → pages → PDF. The same run gives the same bytes.

mod draw;
mod flow;
mod font;
mod item;
mod layout;
mod plot;
mod table;

use font::Letters;
use item::{INSIDE, Ink, Item, MARGIN};

use super::block::Block;
use super::{Sheet, blocks};
use crate::words::{Words, fill};
use ptu_bench::failure::Failure;

/// Base lines of header and footer, and the size of their words.
const HEADER: f32 = 32.0;
const FOOTER: f32 = item::HEIGHT - 26.0;
const SIZE: f32 = 7.4;

/// The document.
///
/// # Errors
/// The shipped font does not serve, or the document cannot be made of it.
pub fn pdf(sheet: &Sheet, words: &Words) -> Result<Vec<u8>, Failure> {
    let letters = Letters::new()?;
    let pages = pages(sheet, &blocks(sheet, words), words, &letters);
    draw::document(&pages, sheet, words, &letters)
}

/// All pages with header and footer.
fn pages(sheet: &Sheet, blocks: &[Block], words: &Words, letters: &Letters) -> Vec<Vec<Item>> {
    let mut pages = flow::pages(&layout::pieces(blocks, letters));
    let run = &sheet.run.run;
    let of = pages.len();
    let right = |text: &str, y: f32| {
        let x = MARGIN + INSIDE - letters.width(text, SIZE);
        Item::text(x, y, SIZE, Ink::Soft, text)
    };
    for (number, page) in (1..).zip(&mut pages) {
        let unit = format!("{}   {}", words.report.sheet, run.unit_serial);
        let numbered = fill(words.report.page, &[("n", &number), ("of", &of)]);
        // A serial number from a file may be of any length.
        let unit = letters.lines(&unit, SIZE, INSIDE * 0.7).swap_remove(0);
        page.push(Item::text(MARGIN, HEADER, SIZE, Ink::Soft, &unit));
        page.push(right(&format!("ptu {}", run.app_version), HEADER));
        page.push(Item::rule(MARGIN, HEADER + 5.0, INSIDE, Ink::Grid));
        page.push(Item::rule(MARGIN, FOOTER - 11.0, INSIDE, Ink::Grid));
        page.push(Item::text(
            MARGIN,
            FOOTER,
            SIZE,
            Ink::Soft,
            &run.id.to_string(),
        ));
        page.push(right(&numbered, FOOTER));
    }
    pages
}

#[cfg(test)]
pub(super) fn laid_out(sheet: &Sheet, words: &Words) -> Vec<Vec<Item>> {
    let letters = Letters::new().expect("the font");
    pages(sheet, &blocks(sheet, words), words, &letters)
}

#[cfg(test)]
pub(super) use item::{HEIGHT, Item as PageItem, WIDTH};
