//! Troubles as a window says them, without commands, or as the command line does.

use std::sync::Arc;

use btu_rig::procedure::Procedure;
use ptu_runs::failure::Failure;
use ptu_runs::places::{Places, Teller};
use ptu_runs::stdio;
use ptu_runs::words::{Say, TextStyle};

use super::super::{Language, Words};
use super::condition;

impl Words {
    /// Sentence on a trouble, and the next move.
    pub fn trouble(&self, what: &impl Say) -> String {
        what.say(self.style(false))
    }

    /// Sentence on a trouble, with the commands that help.
    pub fn told(&self, what: &impl Say) -> String {
        what.say(self.style(true))
    }

    /// The procedures as a bench does them, told in this language.
    pub fn fitted(&self, bench: &Places, procedures: Vec<Arc<Procedure>>) -> Vec<Arc<Procedure>> {
        let korean = self.language == Language::Korean;
        let teller = Teller {
            note: &|note| self.told(&note),
            signal: &|signal| self.signal(signal.name()).into_owned(),
            text: &|text| self.content(text).into_owned(),
            condition: &|seen| match korean {
                true => condition::korean(seen),
                false => seen.to_string(),
            },
        };
        bench.fit(procedures, &teller)
    }

    pub(in crate::words) fn style(&self, commands: bool) -> TextStyle {
        let korean = self.language == Language::Korean;
        TextStyle { korean, commands }
    }
}

/// Prints a failure on stderr, in the language that the command line asks for, with the commands that help.
pub fn tell(failure: &Failure) {
    let said = Words::shown().told(&failure.message);
    stdio::note(&format!("ptu: {said}"));
}
