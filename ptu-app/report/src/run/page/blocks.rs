//! Lays blocks out as pieces that are not divided between pages.

use super::font::FontMetrics;
use super::item::{INSIDE, Ink, Item, MARGIN, Piece};
use super::{plot, table};
use crate::run::block::{Block, Tone};
use crate::run::code::Code;

/// Size of running text, and distance from line to line.
const SIZE: f32 = 8.2;
const LINE: f32 = 11.2;
/// Width of the names of facts.
const NAMES: f32 = 130.0;

/// Edge of a code for a scanner: 34 mm.
const CODE: f32 = 96.0;

/// Length of a line to write on.
const BLANK: f32 = 170.0;

/// All blocks, in order.
pub fn pieces(blocks: &[Block], letters: &FontMetrics) -> Vec<Piece> {
    blocks.iter().flat_map(|one| block(one, letters)).collect()
}

fn block(block: &Block, letters: &FontMetrics) -> Vec<Piece> {
    match block {
        Block::Title(title, below) => {
            let mut all = words(title, 19.0, 24.0, Ink::Black, 2.0, letters);
            all.extend(words(below, SIZE, LINE, Ink::Soft, 6.0, letters));
            all
        }
        Block::Heading(text) => vec![heading(text)],
        Block::Subheading(text, end) => vec![subheading(text, end, letters)],
        Block::Verdict(tone, verdict, beside) => vec![framed(*tone, verdict, beside, letters)],
        Block::Facts(facts) => {
            let mut all: Vec<_> = facts.iter().map(|(n, v)| fact(n, v, letters)).collect();
            if let Some(last) = all.last_mut() {
                last.height += 6.0;
            }
            all
        }
        Block::Text(tone, text) => {
            let mut all = words(text, SIZE, LINE, table::ink(*tone), 4.0, letters);
            // The line above a plot stays with it.
            if let Some(last) = all.last_mut() {
                last.with_next = *tone == Tone::Soft;
            }
            all
        }
        Block::Table(of) => {
            let mut all = table::pieces(of, letters);
            if let Some(last) = all.last_mut() {
                last.height += 8.0;
            }
            all
        }
        Block::Plot(of) => vec![plot::piece(of)],
        Block::Code(code, below) => vec![scanned(code, below, letters)],
        Block::NewPage => vec![Piece {
            on_new_page: true,
            ..Piece::default()
        }],
        Block::Signatures(who, date) => vec![signatures(who, date)],
    }
}

/// Lines of running words, each a piece; `below` is free after the last.
fn words(
    text: &str,
    size: f32,
    line: f32,
    ink: Ink,
    below: f32,
    letters: &FontMetrics,
) -> Vec<Piece> {
    let lines = letters.lines(text, size, INSIDE).into_iter().enumerate();
    let mut all: Vec<_> = lines
        .map(|(number, words)| Piece {
            items: vec![Item::lines(MARGIN, size, ink, vec![(line * 0.78, words)])],
            height: line,
            goes_on: number > 0,
            ..Piece::default()
        })
        .collect();
    if let Some(last) = all.last_mut() {
        last.height += below;
    }
    all
}

fn heading(text: &str) -> Piece {
    Piece {
        items: vec![
            Item::text(MARGIN, 24.0, 12.5, Ink::Black, text).strong(),
            Item::rule(MARGIN, 29.0, INSIDE, Ink::Rule),
        ],
        height: 34.0,
        with_next: true,
        ..Piece::default()
    }
}

fn subheading(text: &str, end: &str, letters: &FontMetrics) -> Piece {
    let size = 9.5;
    let beside = MARGIN + letters.width(text, size) + 10.0;
    Piece {
        items: vec![
            Item::text(MARGIN, 14.0, size, Ink::Black, text).strong(),
            Item::text(beside, 14.0, SIZE, Ink::Soft, end),
        ],
        height: 19.0,
        with_next: true,
        ..Piece::default()
    }
}

/// The verdict within a frame.
fn framed(tone: Tone, verdict: &str, beside: &str, letters: &FontMetrics) -> Piece {
    let ink = table::ink(tone);
    let (high, size) = (34.0, 17.0);
    let after = MARGIN + 24.0 + letters.width(verdict, size);
    Piece {
        items: vec![
            Item::frame((MARGIN, 0.0), (INSIDE, high), ink, 1.2),
            Item::text(MARGIN + 10.0, 23.0, size, ink, verdict).strong(),
            Item::text(after, 23.0, 10.0, Ink::Black, beside),
        ],
        height: high + 8.0,
        ..Piece::default()
    }
}

fn fact(name: &str, value: &str, letters: &FontMetrics) -> Piece {
    let names = letters.lines(name, SIZE, NAMES - 8.0);
    let values = letters.lines(value, SIZE, INSIDE - NAMES);
    let lines = names.len().max(values.len());
    let column = |lines: Vec<String>, x: f32, ink: Ink| {
        let base = |number| LINE * (number as f32 + 0.78);
        Item::lines(x, SIZE, ink, (0..).map(base).zip(lines).collect())
    };
    let said = match value {
        "" => Item::rule(MARGIN + NAMES, LINE * 0.9, BLANK, Ink::Black),
        _ => column(values, MARGIN + NAMES, Ink::Black),
    };
    Piece {
        items: vec![column(names, MARGIN, Ink::Soft), said],
        height: lines as f32 * LINE + 1.0,
        ..Piece::default()
    }
}

/// A code for a scanner, and beside it what is done with it.
fn scanned(code: &Code, beside: &str, letters: &FontMetrics) -> Piece {
    let dot = CODE / code.width as f32;
    let mut items = vec![Item::Drawing(MARGIN, 0.0, CODE, CODE, code.text.clone())];
    for (x, y, length) in &code.dark {
        let (x, y, length) = (*x as f32 * dot, *y as f32 * dot, *length as f32 * dot);
        items.push(Item::Area(MARGIN + x, y, length, dot, Ink::Black));
    }
    let left = CODE + 14.0;
    let lines = letters.lines(beside, SIZE, INSIDE - left);
    let base = |number| CODE / 2.0 + LINE * number as f32;
    let lines = (0..).map(base).zip(lines).collect();
    items.push(Item::lines(MARGIN + left, SIZE, Ink::Soft, lines));
    Piece {
        items,
        height: CODE + 4.0,
        ..Piece::default()
    }
}

fn signatures(who: &[String], date: &str) -> Piece {
    let each = INSIDE / who.len().max(1) as f32;
    let mut items = Vec::new();
    for (number, name) in who.iter().enumerate() {
        let left = MARGIN + number as f32 * each;
        for (from, share, text) in [(0.0, 0.56, name.as_str()), (0.62, 0.3, date)] {
            let x = left + from * each;
            items.push(Item::rule(x, 44.0, share * each, Ink::Black));
            items.push(Item::text(x, 54.0, SIZE, Ink::Soft, text));
        }
    }
    Piece {
        items,
        height: 60.0,
        ..Piece::default()
    }
}
