//! Sentences that are made of data, one match for each kind: a kind that is added does not compile without its words.

mod both;
mod conclusion;
pub(super) mod condition;
mod damage;
mod diagnosis;
mod drive;
mod finding;
mod reasons;
mod trouble;

pub use trouble::tell;

use std::borrow::Cow;

use btu_rig::procedure::finding::{Finding, Findings};
use btu_rig::procedure::plan::Action;
use btu_rig::procedure::{StepResult, event_text};
use fault_db::{StepKind, StepRecord};
use protocol::event::Event;
use ptu_runs::bench_worker::outside_place;
use ptu_runs::stored;

use super::{Language, Words};

impl Words {
    /// Findings in one place, as a sentence.
    pub fn findings(&self, all: &Findings) -> String {
        match self.language {
            Language::English => format!("{all:#}"),
            Language::Korean => finding::findings(all),
        }
    }

    pub fn finding(&self, one: &Finding) -> String {
        match self.language {
            Language::English => format!("{one:#}"),
            Language::Korean => finding::korean(one),
        }
    }

    /// Condition that an action waits for, as text.
    pub fn awaited(&self, action: &Action) -> String {
        match (action, self.language) {
            (Action::Until { condition, .. }, Language::English) => format!("{condition:#}"),
            (Action::Until { condition, .. }, Language::Korean) => condition::korean(condition),
            (Action::Settle { .. }, Language::Korean) => "동작 또는 요청의 완료".to_owned(),
            (Action::Settle { .. }, Language::English) => "the motion or request to end".to_owned(),
            (Action::Wait(span), Language::Korean) => format!("{span} 경과"),
            (other, _) => other.to_string(),
        }
    }

    /// A step by its name and its turn, with a word if the result is an attempt or a repetition, which does not count.
    pub fn step(&self, name: &str, [turn, turns]: [u32; 2], kind: StepKind) -> String {
        let mut said = self.content(name).into_owned();
        if turns > 1 {
            said += &format!(" ({turn}/{turns})");
        }
        match kind {
            StepKind::Attempt => said + &format!(" ({})", self.common.attempt),
            StepKind::Again => said + &format!(" ({})", self.common.run_again),
            StepKind::Step | StepKind::Outside => said,
        }
    }

    /// Name of a record: a step, or the place of a failure outside steps.
    pub fn record(&self, of: &StepRecord) -> String {
        match stored::outside_of(of) {
            Some(place) => self.common.outside(place).to_owned(),
            None => self.step(&of.name, [of.turn, of.turns], of.kind),
        }
    }

    /// Name of a step of a run that is under way, as in [`Self::record`].
    pub fn result(&self, of: &StepResult) -> String {
        match outside_place(of) {
            Some(place) => self.common.outside(place).to_owned(),
            None => self.step(&of.name, [of.turn, of.turns], stored::kind(of.kind)),
        }
    }

    /// Parameter of an event as text; empty for an event without one.
    pub fn parameter(&self, event: Event, number: i32) -> String {
        match self.language {
            Language::English => event_text::parameter(event, number),
            Language::Korean => condition::parameter(event, number),
        }
    }

    /// Finding as stored: `message` where it has no data, or data of another version.
    pub fn found<'a>(&self, data: &Option<String>, message: &'a str) -> Cow<'a, str> {
        let all = stored::findings(data);
        match all.is_empty() {
            true => self.content(message),
            false => Cow::Owned(self.findings(&all)),
        }
    }
}
