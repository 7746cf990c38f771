//! What every page has at hand.

use fault_db::Id;

use super::library::Library;
use super::settings::Settings;
use super::units::Units;
use crate::clock;
use crate::words::Words;

/// What every page has at hand.
pub struct Desk<'a> {
    /// Wordings in the language chosen.
    pub words: &'static Words,
    /// The database and the scripts.
    pub library: &'a Library,
    /// Units that are tested.
    pub units: &'a mut Units,
    /// What is kept between starts.
    pub settings: &'a mut Settings,
    /// What the person is told.
    pub messages: &'a mut Messages,
    /// Where the person wants to go; acted upon after the page is shown.
    pub go: &'a mut Vec<Go>,
}

/// A way from one page to another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Go {
    /// To a trace.
    Trace(Id),
    /// To a run's sheet.
    Report(Id),
    /// To the diagnosis of a run.
    Diagnosis(Id),
    /// To the procedures, to run this step.
    RunStep {
        /// Procedure, as `atp/overspeed`.
        procedure: String,
        /// Step by its name.
        step: String,
        /// The unit it is for, by its serial number.
        unit: String,
    },
}

/// What the person is told, the latest last.
#[derive(Debug, Default)]
pub struct Messages {
    all: Vec<Message>,
    /// The latest trouble, until the person has taken note of it.
    unread: Option<usize>,
}

/// One thing told.
#[derive(Debug)]
pub struct Message {
    /// In the language chosen when it happened.
    pub text: String,
    /// What the machine says of it, in its own words.
    pub detail: String,
    /// Something went wrong.
    pub bad: bool,
    /// When, µs since 1970.
    pub at_us: i64,
}

/// As many as are kept.
const KEPT: usize = 100;

impl Messages {
    /// Something went wrong.
    pub fn trouble(&mut self, text: impl Into<String>, detail: impl Into<String>) {
        self.push(text.into(), detail.into(), true);
    }

    /// Something worth knowing.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.push(text.into(), String::new(), false);
    }

    /// All, oldest first.
    pub fn all(&self) -> &[Message] {
        &self.all
    }

    /// The latest trouble the person has not taken note of.
    pub fn unread_trouble(&self) -> Option<&Message> {
        self.all.get(self.unread?)
    }

    /// The person has taken note of the trouble.
    pub fn take_note(&mut self) {
        self.unread = None;
    }

    /// The person has read them.
    pub fn clear(&mut self) {
        self.all.clear();
        self.unread = None;
    }

    fn push(&mut self, text: String, detail: String, bad: bool) {
        if self.all.len() == KEPT {
            self.all.remove(0);
            self.unread = self.unread.and_then(|place| place.checked_sub(1));
        }
        if bad {
            self.unread = Some(self.all.len());
        }
        self.all.push(Message {
            text,
            detail,
            bad,
            at_us: clock::now_us(),
        });
    }
}
