//! Counts of faults month by month, as `ptu faults stats --by month` and the window's statistics show them.

use fault_db::{FaultStat, StatQuery, Store};
use ptu_bench::clock;
use ptu_bench::failure::Failure;

/// A local month of the span, or its part in it.
pub struct Month {
    /// Its name, as 2026-03.
    pub name: String,
    /// Beginning and end, µs since 1970.
    pub span_us: std::ops::Range<i64>,
    /// What is counted in it; a quiet month has zeros.
    pub stat: FaultStat,
}

/// Each local month of the span for itself, the oldest first. None if there is nothing to count in any of
/// them.
pub fn by_month(store: &Store, query: &StatQuery) -> Result<Vec<Month>, Failure> {
    let Some((first_us, last_us)) = store.history_span()? else {
        return Ok(Vec::new());
    };
    // Before the history there is nothing, and after now only what a computer with a fast clock recorded:
    // a span that reaches farther has no months there, and no count is another for it.
    let end_us = query.now_us.max(last_us.saturating_add(1));
    let since_us = query
        .filter
        .since_us
        .map_or(first_us, |since| since.max(first_us));
    let until_us = query
        .filter
        .until_us
        .map_or(end_us, |until| until.min(end_us));
    let months = clock::months(since_us, until_us);
    let spans: Vec<_> = months
        .iter()
        .map(|(_, since, until)| *since..*until)
        .collect();
    let counted = store.stats_of_spans(query, &spans)?;
    if counted.iter().all(Vec::is_empty) {
        return Ok(Vec::new());
    }
    let counted = months.into_iter().zip(counted);
    let counted = counted.map(|((name, since_us, until_us), counted)| Month {
        stat: FaultStat {
            key: name.clone(),
            ..counted.into_iter().next().unwrap_or_default()
        },
        name,
        span_us: since_us..until_us,
    });
    Ok(counted.collect())
}
