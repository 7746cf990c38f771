//! Counts of the fault history, computed on the query thread.

use std::collections::BTreeMap;
use std::path::Path;

use fault_db::{FaultFilter, FaultStat, StatKey, StatQuery, Store};

use crate::DataPaths;
use crate::parts::look_back::since_us;
use ptu_report::distances::Distances;
use ptu_report::fault_months::{Month, OnTheWay, by_month, on_the_way};
use ptu_report::naming::PartNames;
use ptu_runs::clock;
use ptu_runs::failure::{Failure, Trouble};

/// A repair after which the fault is seen again within this many days did not hold.
pub const BACK_WITHIN_DAYS: u32 = 30;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Asked {
    /// Serial number; none = all units.
    pub unit: Option<String>,
    /// Days to look back; none = all there is.
    pub days: Option<i64>,
    /// File with readings of odometers; empty = none.
    pub distances: String,
}

pub struct Counted {
    pub asked: Asked,
    /// Cases by cause, the most frequent first.
    pub causes: Vec<FaultStat>,
    pub all: FaultStat,
    /// Faults by month, the oldest first.
    pub months: Vec<Month>,
    /// Distances that the trains ran in each month, or why they cannot be read; none for a single unit.
    pub on_the_way: Option<Result<BTreeMap<String, OnTheWay>, Trouble>>,
    pub parts: PartNames,
}

impl Counted {
    /// Counts as `ptu faults stats` and `ptu faults stats --by month` do.
    pub fn read(paths: &DataPaths, asked: Asked) -> Result<Self, Failure> {
        let parts = PartNames::of(&paths.scripts);
        let mut counted = Self {
            asked,
            causes: Vec::new(),
            all: FaultStat::default(),
            months: Vec::new(),
            on_the_way: None,
            parts,
        };
        if !paths.is_there() {
            return Ok(counted);
        }
        let store = paths.read()?;
        if !is_known(&store, counted.asked.unit.as_deref())? {
            return Ok(counted);
        }
        let now_us = clock::now_us();
        let mut query = StatQuery {
            by: StatKey::Cause,
            filter: FaultFilter {
                unit: counted.asked.unit.clone(),
                since_us: since_us(counted.asked.days, now_us),
                ..FaultFilter::default()
            },
            now_us,
            back_within_days: BACK_WITHIN_DAYS,
        };
        (counted.causes, counted.all) = store.stats_and_total(&query)?;
        counted.causes.retain(|cause| cause.faults > 0);
        query.by = StatKey::All;
        counted.months = by_month(&store, &query)?;
        let asked = &counted.asked;
        if asked.unit.is_none() && !asked.distances.is_empty() {
            counted.on_the_way = match Distances::read(Path::new(&asked.distances)) {
                Ok(known) => Some(Ok(on_the_way(&store, &query, &known)?)),
                Err(why) => Some(Err(why.message)),
            };
        }
        Ok(counted)
    }
}

/// Whether the history has this unit; true without a unit.
pub fn is_known(store: &Store, unit: Option<&str>) -> Result<bool, Failure> {
    let Some(unit) = unit else { return Ok(true) };
    Ok(store.known_units()?.iter().any(|known| known == unit))
}
