//! The terminal while somebody drives by keys: bytes as they are typed, and one line that is written
//! over and over.

use std::io::{IsTerminal, stdin};

use rustix::termios::{
    LocalModes, OptionalActions, SpecialCodeIndex, Termios, tcgetattr, tcgetwinsize, tcsetattr,
};

use crate::failure::Failure;
use crate::stdio;
use crate::table::cut;

/// Width of a terminal that does not say, columns.
const USUAL_COLUMNS: usize = 80;
/// A special character that no key makes.
const NONE: u8 = 0;

/// The terminal, which gets its settings back when this is dropped.
pub struct Terminal {
    before: Termios,
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
        let cannot = |error| Failure::bench(format!("cannot set the terminal: {error}"));
        let before = tcgetattr(stdin()).map_err(cannot)?;
        let mut keys = before.clone();
        keys.local_modes -= LocalModes::ICANON | LocalModes::ECHO;
        // A read takes what there is, and does not wait.
        keys.special_codes[SpecialCodeIndex::VMIN] = 0;
        keys.special_codes[SpecialCodeIndex::VTIME] = 0;
        // A train cannot be put to sleep under way.
        keys.special_codes[SpecialCodeIndex::VSUSP] = NONE;
        tcsetattr(stdin(), OptionalActions::Now, &keys).map_err(cannot)?;
        Ok(Self { before })
    }

    /// What was typed since it was last asked.
    pub fn typed(&self) -> Vec<u8> {
        let mut bytes = [0; 64];
        // A terminal that has gone away types nothing more; the hang-up ends the program.
        let count = rustix::io::read(stdin(), &mut bytes).unwrap_or(0);
        bytes[..count].to_vec()
    }

    /// Writes a line in place of the last, as far as it fits.
    pub fn show(&self, line: &str) {
        let columns = tcgetwinsize(stdio::stderr()).map_or(0, |size| usize::from(size.ws_col));
        let columns = if columns == 0 { USUAL_COLUMNS } else { columns };
        // What cannot be shown does not stop the train.
        stdio::redraw(&cut(line, columns - 1));
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        stdio::redraw("");
        let _ = tcsetattr(stdin(), OptionalActions::Now, &self.before);
    }
}
