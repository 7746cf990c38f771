//! Tables on pages: each row is a piece, and its cells wrap.

use super::font::FontMetrics;
use super::item::{INSIDE, Ink, Item, MARGIN, Piece};
use crate::run::block::{Align, Cell, Column, Gauge, Row, RowKind, Table, Tone};

/// Size of text in tables, and distance from line to line.
const SIZE: f32 = 7.6;
const LINE: f32 = 10.0;
/// Free above and below a row's words, and between columns.
const ABOVE: f32 = 2.2;
const BETWEEN: f32 = 8.0;
/// Indent of details.
const INDENT: f32 = 10.0;
/// Width and height of a bar.
const BAR: (f32, f32) = (64.0, 5.0);
/// A cell's lines at most, so that a row never is longer than a page.
const MOST_LINES: usize = 40;

/// The heading and the rows.
pub fn pieces(table: &Table, letters: &FontMetrics) -> Vec<Piece> {
    let names = table.columns.iter();
    let names = names.map(|column| Cell::Text(Tone::Soft, column.name.clone()));
    let heading = Row::new(RowKind::Head, names);
    let mut pieces = Vec::new();
    if table.has_headings() {
        let mut top = row(&heading, &table.columns, letters);
        top.items
            .push(Item::rule(MARGIN, top.height, INSIDE, Ink::Rule));
        top.repeated = true;
        top.with_next = true;
        pieces.push(top);
    }
    for (place, one) in table.rows.iter().enumerate() {
        let mut piece = row(one, &table.columns, letters);
        if one.kind == RowKind::Head && place > 0 {
            piece
                .items
                .insert(0, Item::rule(MARGIN, 0.0, INSIDE, Ink::Grid));
        }
        let next = table.rows.get(place + 1);
        // The first row of details stands on the page of its step's name.
        piece.with_next =
            one.kind == RowKind::Head && next.is_some_and(|next| next.kind == RowKind::Detail);
        piece.under_repeated = table.has_headings();
        pieces.push(piece);
    }
    pieces
}

fn row(row: &Row, columns: &[Column], letters: &FontMetrics) -> Piece {
    let mut items = Vec::new();
    let mut lines = 1;
    let (mut place, mut x) = (0, MARGIN);
    for (cell, span) in &row.cells {
        let covered = columns.iter().skip(place).take(*span);
        let width: f32 = covered.map(|column| column.share * INSIDE).sum();
        let first = place == 0 && row.kind == RowKind::Detail;
        let from = if first { x + INDENT } else { x };
        let inside = (x + width - from - BETWEEN).max(SIZE);
        let align = columns
            .get(place)
            .map_or(Align::Left, |column| column.align);
        match cell {
            Cell::Text(tone, text) => {
                let mut split = letters.lines(text, SIZE, inside);
                if split.len() > MOST_LINES {
                    split.truncate(MOST_LINES);
                    split.push("…".into());
                }
                lines = lines.max(split.len());
                let base = |number| ABOVE + LINE * (number as f32 + 0.78);
                let all = (0..).map(base).zip(split).collect();
                items.push(match align {
                    Align::Left => Item::lines(from, SIZE, ink(*tone), all),
                    Align::Right => Item::lines(from + inside, SIZE, ink(*tone), all).ending(),
                });
            }
            Cell::Gauge(Some(gauge)) => items.extend(bar(gauge, from, inside.min(BAR.0))),
            Cell::Gauge(None) => {}
        }
        place += span;
        x += width;
    }
    Piece {
        items,
        height: lines as f32 * LINE + 2.0 * ABOVE,
        ..Piece::default()
    }
}

/// Bar with the limits as a band, and the value as a mark: a disc inside, a square outside.
fn bar(gauge: &Gauge, x: f32, width: f32) -> Vec<Item> {
    let at = |share: f64| x + share as f32 * width;
    let middle = ABOVE + LINE / 2.0;
    let (from, to) = (at(gauge.band.0), at(gauge.band.1));
    let value = at(gauge.value);
    vec![
        Item::rule(x, middle, width, Ink::Rule),
        Item::Area(
            from,
            middle - BAR.1 / 2.0,
            (to - from).max(0.7),
            BAR.1,
            Ink::Band,
        ),
        if gauge.good {
            Item::Disc(value, middle, 2.0, Ink::Good)
        } else {
            Item::Area(value - 1.8, middle - 3.6, 3.6, 7.2, Ink::Bad)
        },
    ]
}

/// Ink of words in this tone.
pub fn ink(tone: Tone) -> Ink {
    match tone {
        Tone::Plain => Ink::Black,
        Tone::Soft => Ink::Soft,
        Tone::Good => Ink::Good,
        Tone::Bad => Ink::Bad,
    }
}
