//! The only writer of standard output and standard error.
//!
//! Control characters in printed text are escaped. An output error stops nothing:
//! a run goes on without a reader.

use std::borrow::Cow;
use std::io::{self, ErrorKind, IsTerminal, Write};

use protocol::display_text;

use crate::failure::{Failure, FileTrouble};
use crate::platform;
use crate::table::cut;
use crate::terminal::{Terminal, coloured};

/// Longest line, in columns.
const WIDEST: usize = 10_000;

/// Answers with text for people. A reader that has gone away (`| head`) has read enough.
///
/// # Errors
/// Standard output does not take it.
pub fn answer(text: &str) -> Result<(), Failure> {
    document(&shown(text))
}

/// Text for people as standard output takes it.
pub fn shown(text: &str) -> String {
    coloured(&readable(text), Terminal::get().colours_answers).into_owned()
}

/// Answers with a whole document, JSON or CSV, as it stands.
///
/// # Errors
/// Standard output does not take it.
pub fn document(text: &str) -> Result<(), Failure> {
    let mut out = stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::bench(FileTrouble::Unanswered(error.to_string())))
        }
        _ => Ok(()),
    }
}

/// Standard output is a file that begins with what is answered, not a pipe or a terminal.
pub fn begins_file() -> bool {
    let about = platform::same_file(&stdout()).and_then(|file| file.metadata());
    about.is_ok_and(|about| about.is_file() && about.len() == 0)
}

/// Prints a note on stderr; an output error is ignored.
pub fn note(text: &str) {
    let _ = writeln!(stderr().lock(), "{}", noted(&readable(text)));
}

/// The text as standard error takes it, in colour or not.
pub fn noted(text: &str) -> Cow<'_, str> {
    coloured(text, Terminal::get().colours_notes)
}

/// Progress can be drawn: notes go to a terminal.
pub fn draws() -> bool {
    stderr().is_terminal()
}

/// The text without control characters, its lines cut to [`WIDEST`].
fn readable(text: &str) -> String {
    let text = display_text::lines(text);
    let lines: Vec<_> = text.split('\n').map(|line| cut(line, WIDEST)).collect();
    lines.join("\n")
}

/// Standard output, for this file and for a stream of lines that is its only content.
#[expect(clippy::disallowed_methods, reason = "the one place that writes to it")]
pub fn stdout() -> io::Stdout {
    io::stdout()
}

/// Standard error, for this file and for what asks the terminal behind it about itself.
#[expect(clippy::disallowed_methods, reason = "the one place that writes to it")]
pub fn stderr() -> io::Stderr {
    io::stderr()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_text_has_no_control_characters_and_a_limited_width() {
        assert_eq!(readable("a\x1b[2J\nb\u{202e}"), "a\\x1b[2J\nb\\u{202e}");
        let wide = readable(&"\u{ac00}".repeat(100_000));
        assert!(wide.ends_with('…'));
        assert_eq!(wide.chars().count(), WIDEST / 2);
    }
}
