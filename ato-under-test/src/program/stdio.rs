//! All that the program tells: where the unit is on standard output, everything else on standard error.
//! Control characters in text that others wrote reach no terminal.

use std::io::{self, ErrorKind, Write};

use protocol::display_text;

/// Prints where the unit can be reached; a reader that has gone is no error.
///
/// # Errors
/// Standard output does not take it.
#[expect(clippy::disallowed_methods, reason = "the one place that writes to it")]
pub fn place(place: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match writeln!(out, "{}", display_text::line(place)).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            let why = format!("telling where the unit is: {error}");
            Err(io::Error::new(error.kind(), why))
        }
        _ => Ok(()),
    }
}

/// Prints a remark; a reader that has gone is no error.
#[expect(clippy::disallowed_methods, reason = "the one place that writes to it")]
pub fn note(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", display_text::lines(text));
}
