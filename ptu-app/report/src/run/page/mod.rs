//! A test sheet laid out on A4: blocks → pieces → pages of items with positions. The PDF and the window draw
//! the same pages.

mod blocks;
mod flow;
pub(super) mod font;
mod item;
mod plot;
mod table;

use std::collections::BTreeSet;

use font::FontMetrics;
use item::INSIDE;
pub use item::{DASH, HEIGHT, Ink, Item, MARGIN, Text, WIDTH};

use super::block::Block;
use super::{Paper, Printed};
use crate::plot::Plot;
use crate::words::{Words, fill};
use ptu_runs::failure::Failure;

/// Base lines of header and footer, and the size of their words.
const HEADER: f32 = 32.0;
const FOOTER: f32 = HEIGHT - 26.0;
const BELOW_FOOTER: f32 = FOOTER + 9.0;
const SIZE: f32 = 7.4;

/// Items of a page, in the order in which they are drawn.
pub type Page = Vec<Item>;

/// Largest size of the text across a page, and the share of the width between the margins that the text takes.
const ACROSS: (f32, f32) = (110.0, 0.96);

/// All pages with header and footer.
///
/// # Errors
/// The shipped font does not serve.
pub fn pages(sheet: &impl Printed, words: &Words) -> Result<Vec<Page>, Failure> {
    pages_of(&sheet.paper(words), words).map(|(pages, _)| pages)
}

/// Pages of a paper, and the letters that are written as codes.
pub(super) fn pages_of(
    paper: &Paper,
    words: &Words,
) -> Result<(Vec<Page>, BTreeSet<char>), Failure> {
    let letters = FontMetrics::new()?;
    let mut pages = flow::pages(&blocks::pieces(&paper.blocks, &letters));
    let (of, mut coded) = (pages.len(), BTreeSet::new());
    let right = |text: &str, y| Item::text(MARGIN + INSIDE, y, SIZE, Ink::Soft, text).ending();
    for (number, page) in (1..).zip(&mut pages) {
        if let Some(text) = &paper.across {
            page.splice(0..0, across(text, &letters));
        }
        let unit = format!("{}   {}", paper.name, paper.unit);
        let numbered = fill(words.report.page, &[("n", &number), ("of", &of)]);
        // A serial number from a file may be of any length.
        let unit = letters.lines(&unit, SIZE, INSIDE * 0.7).swap_remove(0);
        page.push(Item::text(MARGIN, HEADER, SIZE, Ink::Soft, unit.trim_end()));
        page.push(right(&paper.program, HEADER));
        page.push(Item::rule(MARGIN, HEADER + 5.0, INSIDE, Ink::Grid));
        page.push(Item::rule(MARGIN, FOOTER - 11.0, INSIDE, Ink::Grid));
        page.push(Item::text(MARGIN, FOOTER, SIZE, Ink::Soft, &paper.number));
        page.push(right(&numbered, FOOTER));
        let of_page = write_codes(page, &letters);
        if !of_page.is_empty() {
            let note = words.report.codes;
            page.push(Item::text(MARGIN, BELOW_FOOTER, SIZE, Ink::Soft, note));
        }
        coded.extend(of_page);
    }
    Ok((pages, coded))
}

/// Writes letters that the font lacks as their codes; returns these letters.
fn write_codes(page: &mut Page, letters: &FontMetrics) -> BTreeSet<char> {
    let mut lacking = BTreeSet::new();
    for item in page {
        let Item::Text(text) = item else { continue };
        for (_, line) in &mut text.lines {
            if let Some(coded) = letters.coded(line) {
                lacking.extend(line.chars().filter(|letter| letters.lacks(*letter)));
                *line = coded;
            }
        }
    }
    lacking
}

/// Plots below each other on a page that is `wide` points between its margins, with `scale` points to a unit of a plot;
/// and the height of all plots.
pub fn drawings(plots: &[Plot], wide: f32, scale: f32) -> (Page, f32) {
    let (mut page, mut height) = (Page::new(), 0.0);
    for plot in plots {
        let piece = plot::drawing(plot, wide, scale);
        page.extend(piece.items.into_iter().map(|item| item.lowered(height)));
        height += piece.height;
    }
    (page, height)
}

/// Number of pages that the blocks take; 0 if the shipped font cannot be used.
pub(super) fn count(blocks: &[Block]) -> usize {
    FontMetrics::new().map_or(0, |letters| {
        flow::pages(&blocks::pieces(blocks, &letters)).len()
    })
}

/// Large pale words behind the rest, twice, so that no part of a copy lacks them.
fn across(text: &str, letters: &FontMetrics) -> Vec<Item> {
    let (largest, share) = ACROSS;
    let size = (share * INSIDE / letters.width(text, 1.0)).min(largest);
    let left = (WIDTH - letters.width(text, size)) / 2.0;
    let place = |share: f32| Item::text(left, share * HEIGHT, size, Ink::Grid, text);
    vec![place(0.36), place(0.74)]
}
