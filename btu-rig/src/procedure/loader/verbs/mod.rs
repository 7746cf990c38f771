//! The verbs of the script language, by subject.

/// A verb of the table.
macro_rules! verb {
    ($name:literal, $params:expr, $make:expr) => {
        Verb {
            name: $name,
            params: $params,
            make: $make,
        }
    };
}

/// A verb that makes a stimulus, which is done at once.
macro_rules! stimulus {
    ($name:literal, $params:expr, |$args:pat_param| $stimulus:expr) => {
        verb!($name, $params, |$args| super::at_once($stimulus))
    };
}

/// A verb that makes a stimulus to be switched on and off.
macro_rules! switch {
    ($name:literal, |$on:ident| $stimulus:expr) => {
        verb!($name, &[needs("on", ParamType::Bool)], |args| {
            let $on = args.flag("on", true);
            super::at_once($stimulus)
        })
    };
}

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
