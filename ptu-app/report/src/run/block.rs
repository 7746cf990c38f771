//! The blocks of a test sheet, which page and PDF are made from.

use super::code::Code;
use crate::limits::places;
use crate::plot::Plot;

/// How good news is. A tone always stands beside words: colour alone says nothing on a copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// Neither.
    Plain,
    Soft,
    /// Passed.
    Good,
    /// Did not pass.
    Bad,
}

/// A piece of the sheet.
#[derive(Clone, Debug)]
pub enum Block {
    /// Head of the sheet and what stands below it.
    Title(String, String),
    Heading(String),
    /// Heading of a part of a section, and the words beside the heading.
    Subheading(String, String),
    /// The verdict, and what stands beside it.
    Verdict(Tone, String, String),
    /// Names and values; an empty value is a line to write on.
    Facts(Vec<(String, String)>),
    Text(Tone, String),
    Table(Table),
    Plot(Box<Plot>),
    /// The next block begins a page.
    NewPage,
    /// A code for a scanner, and what is done with it.
    Code(Box<Code>, String),
    /// Lines to sign on: who, and the word for the date.
    Signatures(Vec<String>, String),
}

/// Where cells of a column stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    /// Numbers, at the right end of the cell.
    Right,
}

#[derive(Clone, Debug)]
pub struct Column {
    pub name: String,
    /// Share of the table's width.
    pub share: f32,
    pub align: Align,
}

/// A table whose heading, if it has one, is repeated on every page.
#[derive(Clone, Debug, Default)]
pub struct Table {
    pub columns: Vec<Column>,
    pub rows: Vec<Row>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKind {
    /// Stands for itself or begins a group.
    Head,
    /// Belongs to the row above.
    Detail,
}

#[derive(Clone, Debug)]
pub struct Row {
    pub kind: RowKind,
    /// Cells of the row, each with the number of columns it covers.
    pub cells: Vec<(Cell, usize)>,
}

#[derive(Clone, Debug)]
pub enum Cell {
    /// Words, a number or a verdict.
    Text(Tone, String),
    /// A value between its limits.
    Gauge(Option<Gauge>),
}

/// A value between its limits, as shares of a bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauge {
    pub band: (f64, f64),
    pub value: f64,
    pub good: bool,
}

impl Gauge {
    /// The gauge; `None` without a value or without any limit. On a side without a limit the band fills the bar.
    pub fn of(value: Option<f64>, low: Option<f64>, high: Option<f64>, good: bool) -> Option<Self> {
        let (value, from, to) = places(value, low, high)?;
        let from = low.map_or(0.0, |_| from);
        let to = high.map_or(1.0, |_| to);
        Some(Self {
            band: (from, to),
            value,
            good,
        })
    }
}

impl Table {
    /// A table of words; its columns by name and share of the width.
    pub fn of_words<'a>(
        columns: impl IntoIterator<Item = (&'a str, f32)>,
        rows: impl IntoIterator<Item = Row>,
    ) -> Self {
        let columns = columns.into_iter();
        Self {
            columns: columns
                .map(|(name, share)| Column::new(name, share, Align::Left))
                .collect(),
            rows: rows.into_iter().collect(),
        }
    }

    pub fn has_headings(&self) -> bool {
        self.columns.iter().any(|column| !column.name.is_empty())
    }
}

impl Column {
    pub fn new(name: &str, share: f32, align: Align) -> Self {
        Self {
            name: sentence(name),
            share,
            align,
        }
    }
}

/// A wording as a sentence of its own, with a capital at its beginning.
pub fn sentence(wording: &str) -> String {
    let mut letters = wording.chars();
    let first = letters.next().map(|first| first.to_uppercase());
    first.into_iter().flatten().chain(letters).collect()
}

impl Row {
    /// A row of one cell a column.
    pub fn new(kind: RowKind, cells: impl IntoIterator<Item = Cell>) -> Self {
        let cells = cells.into_iter().map(|cell| (cell, 1)).collect();
        Self { kind, cells }
    }

    /// A row of words, one cell a column.
    pub fn words(cells: impl IntoIterator<Item = String>) -> Self {
        let cell = |text| Cell::Text(Tone::Plain, text);
        Self::new(RowKind::Head, cells.into_iter().map(cell))
    }
}
