//! What every page has at hand.

use std::time::Instant;

use fault_db::Id;

use super::library::Library;
use super::settings::Settings;
use super::units::Units;
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
    /// To a fault.
    Fault(Id),
    /// To the procedures, to run this step.
    RunStep {
        /// Procedure, as `atp/overspeed`.
        procedure: String,
        /// Step by its name; none = all of them.
        step: Option<String>,
    },
}

/// What the person is told, the latest last.
#[derive(Debug, Default)]
pub struct Messages(Vec<Message>);

/// One thing told.
#[derive(Debug)]
pub struct Message {
    /// In the language chosen when it happened.
    pub text: String,
    /// What the machine says of it, in its own words.
    pub detail: String,
    /// Something went wrong.
    pub bad: bool,
    /// When.
    pub at: Instant,
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
        &self.0
    }

    /// The person has read them.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    fn push(&mut self, text: String, detail: String, bad: bool) {
        if self.0.len() == KEPT {
            self.0.remove(0);
        }
        self.0.push(Message {
            text,
            detail,
            bad,
            at: Instant::now(),
        });
    }
}
