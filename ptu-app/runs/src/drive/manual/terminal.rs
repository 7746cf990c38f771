//! The terminal while somebody drives by keys: bytes as they are typed, and one line that is written
//! over and over.

use std::io::{IsTerminal, stdin};

use crate::failure::Failure;
use crate::platform::{KeyTerminal, columns};
use crate::stdio;
use crate::table::cut;

/// Width of a terminal that does not say, columns.
const USUAL_COLUMNS: usize = 80;

/// The terminal, which gets its settings back when this is dropped.
pub struct Terminal {
    keys: KeyTerminal,
}

impl Terminal {
    /// Takes keys as they are typed, without waiting for a line or showing them. Ctrl-C still
    /// interrupts.
    ///
    /// # Errors
    /// There is no terminal.
    pub fn open() -> Result<Self, Failure> {
        if !stdin().is_terminal() || !stdio::draws() {
            return Err(Failure::usage(
                "--manual keys needs a terminal; drive a sequence instead, as --manual figure5",
            ));
        }
        let keys = KeyTerminal::open()
            .map_err(|error| Failure::bench(format!("cannot set the terminal: {error}")))?;
        Ok(Self { keys })
    }

    /// What was typed since it was last asked.
    pub fn typed(&self) -> Vec<u8> {
        self.keys.typed()
    }

    /// Writes a line in place of the last, as far as it fits.
    pub fn show(&self, line: &str) {
        let columns = columns().unwrap_or(USUAL_COLUMNS);
        // What cannot be shown does not stop the train.
        stdio::redraw(&cut(line, columns - 1));
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        stdio::redraw("");
    }
}
