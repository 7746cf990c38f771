//! The verbs of the script language, by subject.

mod bench;
mod cab;
mod conditions;
mod consist;
mod declare;
mod measures;
mod tester;
mod track;
mod units;

use super::item::Item;
use super::verb::Verb;
use crate::procedure::plan::Action;
use crate::stimulus::Stimulus;

/// All tables.
pub(super) static TABLES: [&[Verb]; 9] = [
    units::VERBS,
    bench::VERBS,
    track::VERBS,
    cab::VERBS,
    consist::VERBS,
    tester::VERBS,
    conditions::VERBS,
    measures::VERBS,
    declare::VERBS,
];

/// A stimulus that is done at once.
fn at_once(stimulus: Stimulus) -> Result<Item, String> {
    Ok(Item::Actions(vec![Action::Stimulus(stimulus)]))
}

/// A stimulus that takes its time, with or without waiting for its end.
fn with_wait(stimulus: Stimulus, wait: bool) -> Result<Item, String> {
    let mut actions = vec![Action::Stimulus(stimulus)];
    if wait {
        actions.push(Action::settle_after(&stimulus));
    }
    Ok(Item::Actions(actions))
}
