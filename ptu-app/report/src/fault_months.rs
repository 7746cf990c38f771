//! Counts of faults month by month, as `ptu faults stats --by month` and the window's statistics show them.

use std::collections::BTreeMap;

use fault_db::{FaultStat, StatQuery, Store};
use ptu_runs::clock;
use ptu_runs::failure::Failure;

use crate::distances::Distances;

/// A month in local time, or the part of the month that lies in the span.
pub struct Month {
    /// Name of the month, as 2026-03.
    pub name: String,
    /// Beginning and end, µs since 1970.
    pub span_us: std::ops::Range<i64>,
    /// Counts of the month; a quiet month has zeros.
    pub stat: FaultStat,
}

/// Counts for each month, in local time, of the span, the oldest first; empty if there is nothing to count in any
/// month.
pub fn by_month(store: &Store, query: &StatQuery) -> Result<Vec<Month>, Failure> {
    let Some((first_us, last_us)) = store.history_span()? else {
        return Ok(Vec::new());
    };
    // The span is cut to the history. Later than now are only entries of a computer with a fast clock: months beyond
    // them, or before the history, have no counts.
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

/// Distance that trains with known readings ran in a month, and the faults first seen on them meanwhile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OnTheWay {
    /// Distance that all these trains ran, km.
    pub km: f64,
    pub trains: u32,
    /// Faults of these trains, counted as the faults of the month are.
    pub faults: u32,
}

impl OnTheWay {
    /// Faults for each 10 000 km; `None` if the trains did not move.
    pub fn per_10000_km(&self) -> Option<f64> {
        (self.km > 0.0).then(|| 1e4 * f64::from(self.faults) / self.km)
    }
}

/// Months with the distances of trains. A train counts, with its distance and its faults, from its first run or its
/// first reading, whichever is later, to its last reading: else there would be a distance without faults, or faults
/// without one.
pub fn on_the_way(
    store: &Store,
    query: &StatQuery,
    distances: &Distances,
) -> Result<BTreeMap<String, OnTheWay>, Failure> {
    let mut all: BTreeMap<String, OnTheWay> = BTreeMap::new();
    for (train, first_run_us) in store.first_runs_of_trains()? {
        let filter = &query.filter;
        if filter.train.as_ref().is_some_and(|only| *only != train) {
            continue;
        }
        let Some(known) = distances.span_us(&train) else {
            continue;
        };
        let since_us = known
            .start
            .max(first_run_us)
            .max(filter.since_us.unwrap_or(i64::MIN));
        let until_us = known
            .end
            .min(query.now_us)
            .min(filter.until_us.unwrap_or(i64::MAX));
        for (name, since_us, until_us) in clock::months(since_us, until_us) {
            let of_month = all.entry(name).or_default();
            of_month.km += distances.km(&train, &(since_us..until_us));
            of_month.trains += 1;
        }
        let mut of_train = query.clone();
        of_train.filter.train = Some(train);
        of_train.filter.since_us = Some(since_us);
        of_train.filter.until_us = Some(until_us);
        for month in by_month(store, &of_train)? {
            if let Some(of_month) = all.get_mut(&month.name) {
                of_month.faults += month.stat.faults;
            }
        }
    }
    Ok(all)
}
