//! Sentences that are made of data, one match for each kind: what is added to the data does not compile without its words.

pub(super) mod condition;
mod diagnosis;
mod drive;
mod finding;

use std::borrow::Cow;

use btu_rig::procedure::finding::{Finding, Findings};
use ptu_runs::stored;

use super::{Language, Words, names};

impl Words {
    /// What was found in one place, as a sentence.
    pub fn findings(&self, all: &Findings) -> String {
        match self.language {
            Language::English => names::english(&all.to_string()).into_owned(),
            Language::Korean => finding::findings(all),
        }
    }

    /// One finding.
    pub fn finding(&self, one: &Finding) -> String {
        match self.language {
            Language::English => names::english(&one.to_string()).into_owned(),
            Language::Korean => finding::korean(one),
        }
    }

    /// What was found, as it is stored: `message` where its data are none, or of another version.
    pub fn found<'a>(&self, data: &Option<String>, message: &'a str) -> Cow<'a, str> {
        let all = stored::findings(data);
        match all.is_empty() {
            true => self.content(message),
            false => Cow::Owned(self.findings(&all)),
        }
    }
}
