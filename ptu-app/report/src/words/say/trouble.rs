//! What went wrong, as a window says it, without commands, or as the command line does.

use ptu_runs::failure::{Failure, Trouble};
use ptu_runs::stdio;
use ptu_runs::words::{Manner, Say as _};

use super::super::{Language, Words};

impl Words {
    /// Why something could not be done, and the next move.
    pub fn trouble(&self, trouble: &Trouble) -> String {
        trouble.say(self.manner(false))
    }

    /// The same for who has a command line, with the commands that help.
    pub fn told(&self, trouble: &Trouble) -> String {
        trouble.say(self.manner(true))
    }

    pub(super) fn manner(&self, commands: bool) -> Manner {
        let korean = self.language == Language::Korean;
        Manner { korean, commands }
    }
}

/// Prints a failure on stderr, in the language that the command line asks for, with the commands that help.
pub fn tell(failure: &Failure) {
    let said = Words::shown().told(&failure.message);
    stdio::note(&format!("ptu: {said}"));
}
