//! Display of answers and notes on a terminal: within its width, and in colour.

use std::borrow::Cow;
use std::sync::OnceLock;

static TERMINAL: OnceLock<Terminal> = OnceLock::new();
/// Where the colour of a style begins, its number after it, and where it ends: letters for private use, which become colours
/// when all else that could act on a terminal is spelled out.
const BEGIN: u32 = 0xf8f0;
const END: char = '\u{f8ff}';

/// The terminal that answers and notes are written to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Terminal {
    /// Width and height, if answers go to a terminal.
    pub size: Option<[usize; 2]>,
    pub colours_answers: bool,
    pub colours_notes: bool,
}

impl Terminal {
    /// Settings of the terminal; before they are set, no terminal.
    pub fn get() -> Self {
        TERMINAL.get().copied().unwrap_or_default()
    }

    /// Sets the terminal, once for the program.
    pub fn set(self) {
        let _ = TERMINAL.set(self);
    }
}

/// Whether colours are wanted where they are not asked for or refused, by the variables that programs agree on.
pub fn wants_colour(is_terminal: bool) -> bool {
    let suits = is_terminal && anstyle_query::term_supports_color();
    let wanted = suits && anstyle_query::clicolor() != Some(false);
    !anstyle_query::no_color() && (anstyle_query::clicolor_force() || wanted)
}

/// Kind of a word that has a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Verdict of what passed.
    Good,
    /// Verdict of what failed.
    Bad,
    /// Verdict of what could not be judged.
    Doubt,
    Part,
    Limit,
}

impl Style {
    const ALL: [Self; 5] = [Self::Good, Self::Bad, Self::Doubt, Self::Part, Self::Limit];

    /// Style of a verdict by its word in either language; none for another word.
    pub fn of_verdict(word: &str) -> Option<Self> {
        match word.trim_end() {
            "passed" | "합격" => Some(Self::Good),
            "failed" | "불합격" => Some(Self::Bad),
            "error" | "aborted" | "inconclusive" | "판정 불가" | "판정 보류" | "중단" => {
                Some(Self::Doubt)
            }
            _ => None,
        }
    }

    fn codes(self) -> &'static str {
        match self {
            Self::Good => "\x1b[32m",
            Self::Bad => "\x1b[1;31m",
            Self::Doubt => "\x1b[33m",
            Self::Part => "\x1b[1m",
            Self::Limit => "\x1b[36m",
        }
    }

    /// The text, marked if colours are shown.
    pub fn mark(self, text: &str) -> String {
        let terminal = Terminal::get();
        match terminal.colours_answers || terminal.colours_notes {
            true => self.marked(text),
            false => text.to_owned(),
        }
    }

    fn marked(self, text: &str) -> String {
        let begin = char::from_u32(BEGIN + self as u32).unwrap_or(END);
        format!("{begin}{text}{END}")
    }
}

/// A verdict in its colour.
pub fn verdict(word: &str) -> String {
    Style::of_verdict(word).map_or_else(|| word.to_owned(), |style| style.mark(word))
}

/// The text with colours in place of their marks, or without both.
pub fn coloured(text: &str, colours: bool) -> Cow<'_, str> {
    if !text.contains(END) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for letter in text.chars() {
        let place = u32::from(letter).wrapping_sub(BEGIN) as usize;
        match (letter, Style::ALL.get(place)) {
            (END, _) if colours => shown.push_str("\x1b[0m"),
            (_, Some(style)) if colours => shown.push_str(style.codes()),
            (END, _) | (_, Some(_)) => {}
            _ => shown.push(letter),
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_become_colours_or_nothing() {
        let style = Style::of_verdict("불합격").expect("a verdict");
        let text = format!("a {} b", style.marked("불합격"));
        assert_eq!(coloured(&text, true), "a \x1b[1;31m불합격\x1b[0m b");
        assert_eq!(coloured(&text, false), "a 불합격 b");
        assert_eq!(Style::Part.mark("tra"), "tra", "no terminal was set");
    }
}
