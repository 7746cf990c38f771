//! Keys of the terminal as they are typed, and what the terminal is like.

use std::io::{IsTerminal as _, Result, stdin};

use rustix::termios::{
    LocalModes, OptionalActions, SpecialCodeIndex, Termios, tcgetattr, tcgetpgrp, tcgetwinsize,
    tcsetattr,
};

use crate::stdio;

/// A special character that no key makes.
const NONE: u8 = 0;

/// The terminal, which gets its settings back when this is dropped.
pub struct KeyTerminal {
    before: Termios,
}

impl KeyTerminal {
    /// Takes keys as they are typed, without waiting for a line or showing them. Ctrl-C still interrupts.
    ///
    /// # Errors
    /// The terminal cannot be set.
    pub fn open() -> Result<Self> {
        let before = tcgetattr(stdin())?;
        let mut keys = before.clone();
        keys.local_modes -= LocalModes::ICANON | LocalModes::ECHO;
        // A read takes what there is, and does not wait.
        keys.special_codes[SpecialCodeIndex::VMIN] = 0;
        keys.special_codes[SpecialCodeIndex::VTIME] = 0;
        // A train cannot be put to sleep under way.
        keys.special_codes[SpecialCodeIndex::VSUSP] = NONE;
        tcsetattr(stdin(), OptionalActions::Now, &keys)?;
        Ok(Self { before })
    }

    /// What was typed since it was last asked.
    pub fn typed(&self) -> Vec<u8> {
        let mut bytes = [0; 64];
        // A terminal that has gone away types nothing more; the hang-up ends the program.
        let count = rustix::io::read(stdin(), &mut bytes).unwrap_or(0);
        bytes[..count].to_vec()
    }
}

impl Drop for KeyTerminal {
    fn drop(&mut self) {
        let _ = tcsetattr(stdin(), OptionalActions::Now, &self.before);
    }
}

/// Width of the terminal behind standard error, if it says.
pub fn columns() -> Option<usize> {
    let size = tcgetwinsize(stdio::stderr()).ok()?;
    Some(usize::from(size.ws_col)).filter(|columns| *columns > 0)
}

/// Whether reading standard input would not stop this process: it is no terminal, or this process is in front of it.
pub fn in_foreground() -> bool {
    let of_terminal = || tcgetpgrp(stdin());
    !stdin().is_terminal() || of_terminal().is_ok_and(|group| group == rustix::process::getpgrp())
}
