//! For unit tests: what is shipped, what was logged, and a value but for one change.

use alloc::vec::Vec;
use std::sync::LazyLock;

use protocol::config::UnitConfig;
use protocol::event::Event;
use protocol::line::Line;

use crate::kernel::EventLog;

pub fn with<T>(mut value: T, change: impl FnOnce(&mut T)) -> T {
    change(&mut value);
    value
}

pub fn sg100() -> UnitConfig {
    UnitConfig::from_toml(include_str!("../../scripts/units/sg100.toml")).unwrap()
}

pub fn seoul34() -> UnitConfig {
    UnitConfig::from_toml(include_str!("../../scripts/units/seoul34.toml")).unwrap()
}

pub fn line8() -> &'static Line {
    static LINE: LazyLock<Line> =
        LazyLock::new(|| Line::from_toml(include_str!("../../scripts/lines/line8.toml")).unwrap());
    &LINE
}

/// Codes and parameters of all that is in a log.
pub fn logged(log: &EventLog) -> Vec<(u16, i32)> {
    let entries = (0..log.next_index()).filter_map(|index| log.entries().at_or_after(index));
    entries.map(|entry| (entry.code, entry.parameter)).collect()
}

/// Parameters with which an event is in a log.
pub fn parameters(log: &EventLog, event: Event) -> Vec<i32> {
    let of_event = |(code, parameter)| (code == event.definition().code).then_some(parameter);
    logged(log).into_iter().filter_map(of_event).collect()
}
