//! Aligned text tables; widths are counted in terminal columns.

use std::borrow::Cow;

use protocol::display_text;
use unicode_width::{UnicodeWidthChar as _, UnicodeWidthStr as _};

/// Widest cell, in columns; of the last column, which nothing stands behind, as wide as the longest note.
const WIDEST: usize = 200;
const WIDEST_LAST: usize = 2 * fault_db::limits::MOST_TEXT;

/// A table being filled.
pub struct Table {
    rows: Vec<Vec<String>>,
    right: Vec<usize>,
}

impl Table {
    /// A table with these headings.
    pub fn new(headings: &[&str]) -> Self {
        let headings = headings.iter().map(|heading| cell(heading, WIDEST));
        Self {
            rows: vec![headings.collect()],
            right: Vec::new(),
        }
    }

    /// Puts the cells of these columns, counted from 0, at the right: numbers.
    pub fn right(mut self, columns: impl IntoIterator<Item = usize>) -> Self {
        self.right = columns.into_iter().collect();
        self
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        let last = self.rows[0].len().saturating_sub(1);
        let widest = |column| if column < last { WIDEST } else { WIDEST_LAST };
        let cells = cells.into_iter().enumerate();
        let row = cells.map(|(column, text)| cell(&text, widest(column)));
        self.rows.push(row.collect());
    }

    /// The text, columns two spaces apart.
    pub fn render(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |i: usize| {
            self.rows
                .iter()
                .filter_map(|row| row.get(i))
                .map(|cell| cell.width())
                .max()
        };
        let widths: Vec<_> = (0..columns).map(|i| width(i).unwrap_or(0)).collect();
        let line = |row: &Vec<String>| {
            let cells: Vec<_> = row
                .iter()
                .zip(&widths)
                .enumerate()
                .map(
                    |(column, (cell, width))| match self.right.contains(&column) {
                        true => format!("{}{cell}", space(cell, *width)),
                        false => padded(cell, *width),
                    },
                )
                .collect();
            cells.join("  ").trim_end().to_owned()
        };
        self.rows.iter().map(line).collect::<Vec<_>>().join("\n")
    }
}

/// The text on one line, filled up with spaces to this width, in columns.
pub fn padded(text: &str, width: usize) -> String {
    format!("{text}{}", space(text, width))
}

/// A text that others wrote, as it may stand in a table.
pub fn cell(text: &str, widest: usize) -> String {
    cut(&display_text::line(text), widest).into_owned()
}

/// The text, with … in place of what is beyond this width, in columns.
pub fn cut(text: &str, widest: usize) -> Cow<'_, str> {
    // No letter is wider than its bytes are many.
    if text.len() <= widest || text.width() <= widest {
        return Cow::Borrowed(text);
    }
    let mut left = widest.saturating_sub(1);
    let fits = |letter: &char| {
        let width = letter.width().unwrap_or(0);
        let fits = width <= left;
        left = left.saturating_sub(width);
        fits
    };
    Cow::Owned(text.chars().take_while(fits).chain(['…']).collect())
}

fn space(text: &str, width: usize) -> String {
    " ".repeat(width.saturating_sub(text.width()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_below_each_other_in_korean_too() {
        let mut table = Table::new(&["PART", "N", "NOTE"]).right([1]);
        table.row(["relay".into(), "1".into(), "swapped".into()]);
        table.row(["계전기".into(), "12".into(), "교체함".into()]);
        assert_eq!(
            table.render(),
            "PART     N  NOTE\nrelay    1  swapped\n계전기  12  교체함"
        );
    }

    #[test]
    fn a_long_cell_is_cut() {
        let mut table = Table::new(&["FIRST", "LAST"]);
        table.row(["x".repeat(80_000), "한".repeat(80_000)]);
        let line = table.render().lines().last().expect("a row").to_owned();
        let (first, last) = line.split_once("  ").expect("two cells");
        assert_eq!(first, format!("{}…", "x".repeat(WIDEST - 1)));
        assert!(
            last.ends_with('…') && last.width() < WIDEST_LAST,
            "no half letters"
        );
    }

    #[test]
    fn a_cell_is_one_line_without_control_characters() {
        let mut table = Table::new(&["A\x1bB", "C"]);
        table.row(["\x1b[31mred".into(), "two\nlines".into()]);
        assert_eq!(table.render(), "A\\x1bB       C\n\\x1b[31mred  two\\nlines");
    }

    #[test]
    fn cut_text_has_the_requested_width_or_one_column_less() {
        assert_eq!(cut("abcdef", 6), "abcdef");
        assert_eq!(cut("abcdef", 5), "abcd…");
        assert_eq!(cut("가나다", 6), "가나다");
        assert_eq!(cut("가나다", 5), "가나…");
        assert_eq!(cut("가나다", 4), "가…");
    }
}
