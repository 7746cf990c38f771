//! Aligned text tables; widths are counted in terminal columns.

use std::borrow::Cow;

use crate::terminal::{Style, Terminal};
use protocol::display_text;
use unicode_width::{UnicodeWidthChar as _, UnicodeWidthStr as _};

/// Widest cell, in terminal columns; in the last column, with nothing behind it, as wide as the longest note.
const WIDEST: usize = 200;
const WIDEST_LAST: usize = 2 * fault_db::limits::MOST_TEXT;

/// A cell with more words, or a longer one, is a sentence; a narrow terminal shows at least so much of it.
const WORDS_OF_NAME: usize = 3;
const LONGEST_NAME: usize = 40;
const LEAST_OF_SENTENCE: usize = 24;
/// Room for the sign that there are more columns.
const MORE: usize = 3;

pub struct Table {
    rows: Vec<Vec<String>>,
    right: Vec<usize>,
    styles: Vec<(usize, Option<Style>)>,
}

impl Table {
    pub fn new(headings: &[&str]) -> Self {
        let headings = headings.iter().map(|heading| cell(heading, WIDEST));
        Self {
            rows: vec![headings.collect()],
            right: Vec::new(),
            styles: Vec::new(),
        }
    }

    /// A table with these words in capitals as headings.
    pub fn headed(words: &[&str]) -> Self {
        let headings: Vec<_> = words.iter().map(|word| word.to_uppercase()).collect();
        Self::new(&headings.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// Puts the cells of these columns, counted from 0, at the right: numbers.
    pub fn right(mut self, columns: impl IntoIterator<Item = usize>) -> Self {
        self.right = columns.into_iter().collect();
        self
    }

    /// Colours the cells of a column that are verdicts.
    pub fn verdicts(mut self, column: usize) -> Self {
        self.styles.push((column, None));
        self
    }

    /// Colours the cells of these columns, which are parts.
    pub fn parts(mut self, columns: impl IntoIterator<Item = usize>) -> Self {
        let columns = columns.into_iter();
        self.styles.extend(columns.map(|i| (i, Some(Style::Part))));
        self
    }

    /// Colours the cells of these columns, which are limits.
    pub fn limits(mut self, columns: impl IntoIterator<Item = usize>) -> Self {
        let columns = columns.into_iter();
        self.styles.extend(columns.map(|i| (i, Some(Style::Limit))));
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

    /// The text, columns two spaces apart, within the width of the terminal that answers go to.
    pub fn render(&self) -> String {
        self.within(Terminal::get().size.map(|[columns, _]| columns))
    }

    fn within(&self, most: Option<usize>) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let mut shown: Vec<_> = (0..columns)
            .map(|i| (i, self.widest(i, |cell| cell.width())))
            .collect();
        let mut leaves_out = false;
        if let Some(most) = most.filter(|most| total(&shown) > *most) {
            leaves_out = self.narrow(&mut shown, most);
        }
        let line = |(place, row): (usize, &Vec<String>)| {
            let (mut line, mut below) = (String::new(), Vec::new());
            for (at, (column, width)) in shown.iter().enumerate() {
                let cell = row.get(*column).map_or("", String::as_str);
                let is_last = at + 1 == shown.len();
                let cell = match is_last && !leaves_out && cell.width() > *width {
                    true => {
                        let mut lines = wrapped(cell, *width).into_iter();
                        let first = lines.next().unwrap_or_default();
                        let indent = " ".repeat(total(&shown) - width);
                        below.extend(lines.map(|line| format!("\n{indent}{line}")));
                        Cow::Owned(first)
                    }
                    false => cut_between_words(cell, *width),
                };
                let mut styles = self.styles.iter().filter(|_| place > 0);
                let style = styles.find(|(of, _)| of == column);
                let style = style.and_then(|(_, style)| style.or_else(|| Style::of_verdict(&cell)));
                let gap = space(&cell, *width);
                let cell = style.map_or_else(|| cell.to_string(), |style| style.mark(&cell));
                line += &match self.right.contains(column) {
                    true => format!("{gap}{cell}  "),
                    false => format!("{cell}{gap}  "),
                };
            }
            if leaves_out && place == 0 {
                line.push('…');
            }
            line.trim_end().to_owned() + &below.concat()
        };
        let lines = self.rows.iter().enumerate().map(line);
        lines.collect::<Vec<_>>().join("\n")
    }

    fn widest(&self, column: usize, width: impl Fn(&str) -> usize) -> usize {
        let cells = self.rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| width(cell)).max().unwrap_or(0)
    }

    /// Leaves empty columns out, then those at the right for which there is no room, then cuts sentences; says whether
    /// anything was left out.
    fn narrow(&self, shown: &mut Vec<(usize, usize)>, most: usize) -> bool {
        let is_filled = |column: usize| {
            let mut rows = self.rows.iter().skip(1);
            rows.any(|row| row.get(column).is_some_and(|cell| !cell.is_empty()))
        };
        shown.retain(|(column, _)| is_filled(*column));
        let all = shown.len();
        let least = |column| self.widest(column, least_width);
        let fits = |shown: &[(usize, usize)]| {
            let least: Vec<_> = shown.iter().map(|(i, _)| (*i, least(*i))).collect();
            total(&least) + if shown.len() < all { MORE } else { 0 } <= most
        };
        while shown.len() > 1 && !fits(shown.as_slice()) {
            shown.pop();
        }
        let most = most - if shown.len() < all { MORE.min(most) } else { 0 };
        while let Some(excess) = total(shown).checked_sub(most).filter(|excess| *excess > 0) {
            let wide = shown
                .iter_mut()
                .filter(|(column, width)| *width > least(*column));
            let Some((column, width)) = wide.max_by_key(|(_, width)| *width) else {
                break;
            };
            *width = least(*column).max(width.saturating_sub(excess));
        }
        shown.len() < all
    }
}

/// Width of columns that stand two spaces apart.
fn total(columns: &[(usize, usize)]) -> usize {
    let widths: usize = columns.iter().map(|(_, width)| width + 2).sum();
    widths.saturating_sub(2)
}

/// The width that a cell keeps: a name its own, a sentence that of its beginning.
fn least_width(cell: &str) -> usize {
    match cell.width() {
        width @ ..=LONGEST_NAME if cell.split(' ').count() <= WORDS_OF_NAME => width,
        width => width.min(LEAST_OF_SENTENCE),
    }
}

/// The text on several lines of this width; a longer word has a line of its own.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.width() + 1 + word.width() <= width => *line += &format!(" {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The text, with … in place of the words that do not fit into this width.
fn cut_between_words(text: &str, widest: usize) -> Cow<'_, str> {
    if text.width() <= widest {
        return Cow::Borrowed(text);
    }
    let mut kept = String::new();
    for word in text.split_inclusive([' ', '/']) {
        if kept.width() + word.trim_end().width() >= widest {
            break;
        }
        kept += word;
    }
    match kept.trim_end() {
        "" => cut(text, widest),
        kept => Cow::Owned(format!("{kept}…")),
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
    fn a_narrow_terminal_shows_whole_names_and_the_words_that_fit() {
        let mut table = Table::new(&["ID", "MODE", "PART", "LAST"]);
        let mode = "hears every code rate 0.8 Hz too high";
        table.row(["atp_receiver.detuned", mode, "atp_receiver", "d"].map(String::from));
        assert_eq!(
            table.within(Some(64)),
            "ID                    MODE                       PART          …\n\
             atp_receiver.detuned  hears every code rate…     atp_receiver"
        );
        let narrow = "ID                    …\natp_receiver.detuned";
        assert_eq!(table.within(Some(30)), narrow);
        assert_eq!(table.within(Some(10)), narrow, "no name is cut");
        let mut table = Table::new(&["STEP", "NONE", "WHY"]);
        table.row(["one".into(), String::new(), mode.into()]);
        assert_eq!(
            table.within(Some(30)),
            "STEP  WHY\none   hears every code rate\n      0.8 Hz too high"
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
