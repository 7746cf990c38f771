//! A test sheet laid out on A4: blocks → pieces → pages of items with positions. The PDF and the window draw
//! the same pages.

mod blocks;
mod flow;
pub(super) mod font;
mod item;
mod plot;
mod table;

use font::FontMetrics;
pub use item::{DASH, HEIGHT, Ink, Item, Text, WIDTH};
use item::{INSIDE, MARGIN};

use super::{Sheet, content};
use crate::words::{Words, fill};
use ptu_bench::failure::Failure;

/// Base lines of header and footer, and the size of their words.
const HEADER: f32 = 32.0;
const FOOTER: f32 = HEIGHT - 26.0;
const SIZE: f32 = 7.4;

/// What is on a page, in the order in which it is drawn.
pub type Page = Vec<Item>;

/// All pages with header and footer.
///
/// # Errors
/// The shipped font does not serve.
pub fn pages(sheet: &Sheet, words: &Words) -> Result<Vec<Page>, Failure> {
    let letters = FontMetrics::new()?;
    let mut pages = flow::pages(&blocks::pieces(&content::blocks(sheet, words), &letters));
    let run = &sheet.run.run;
    let of = pages.len();
    let right = |text: &str, y| Item::text(MARGIN + INSIDE, y, SIZE, Ink::Soft, text).ending();
    for (number, page) in (1..).zip(&mut pages) {
        let unit = format!("{}   {}", words.report.sheet, run.unit_serial);
        let numbered = fill(words.report.page, &[("n", &number), ("of", &of)]);
        // A serial number from a file may be of any length.
        let unit = letters.lines(&unit, SIZE, INSIDE * 0.7).swap_remove(0);
        page.push(Item::text(MARGIN, HEADER, SIZE, Ink::Soft, unit.trim_end()));
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
    Ok(pages)
}
