//! What went wrong, as a window says it, without commands, or as the command line does.

use ptu_runs::failure::Failure;
use ptu_runs::stdio;
use ptu_runs::words::{Manner, Say};

use super::super::{Language, Words};

impl Words {
    /// Why something could not be done, and the next move.
    pub fn trouble(&self, what: &impl Say) -> String {
        what.say(self.manner(false))
    }

    /// Why something could not be done, with the commands that help.
    pub fn told(&self, what: &impl Say) -> String {
        what.say(self.manner(true))
    }

    pub(in crate::words) fn manner(&self, commands: bool) -> Manner {
        let korean = self.language == Language::Korean;
        Manner { korean, commands }
    }
}

/// Prints a failure on stderr, in the language that the command line asks for, with the commands that help.
pub fn tell(failure: &Failure) {
    let said = Words::shown().told(&failure.message);
    stdio::note(&format!("ptu: {said}"));
}
