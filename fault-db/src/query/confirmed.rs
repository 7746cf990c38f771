//! Confirmed repairs of all units, from which diagnosis learns.
//!
//! A repair is confirmed when a run has proved it and its fault has not come back. A state that a person set to
//! verified is a claim, from which nothing is learnt.

use std::collections::{BTreeMap, BTreeSet};

use super::faults::json;
use super::runs::RunSummary;
use crate::backend::values;
use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;
use crate::values::record::{CauseRecord, part_name};

/// Which confirmed repairs count.
#[derive(Clone, Copy, Debug)]
pub struct RepairsOf<'a> {
    /// Confirmed before this time, µs since 1970.
    pub before_us: i64,
    /// Type of the units: the name of their configuration.
    pub unit_type: &'a str,
    /// Whether practice counts, too: faults of simulated units, and injected faults.
    pub practice: bool,
}

/// SQL: whether fault `f` was seen by a run of practice, by the rule of [`is_practice`].
macro_rules! practised {
    () => {
        "EXISTS (SELECT 1 FROM fault_occurrence o JOIN run x ON x.seq = o.run
            WHERE o.fault = f.seq AND (x.source = 'sim' OR x.source LIKE 'lockstep:%' OR x.injected IS NOT NULL))"
    };
}

/// SQL from `FROM` on: confirmed repairs `r`, each with the event `c` by which a run confirmed it, for [`RepairsOf`].
/// Of all repairs since a fault was opened the last counts; none counts if several parts were changed at once, as
/// nobody knows which of them helped.
macro_rules! confirmed {
    () => {
        concat!(
            "FROM fault_event c JOIN fault f ON f.seq = c.fault JOIN unit u ON u.seq = f.unit
             JOIN repair r ON r.fault = c.fault AND r.event = (SELECT max(x.event) FROM repair x
                WHERE x.fault = c.fault AND x.event < c.seq)
             WHERE c.kind = 'confirmed' AND f.state IN ('verified', 'closed') AND r.back_at_us IS NULL
                AND c.at_us < ?1 AND u.config_name = ?2 AND (?3 = 1 OR NOT ",
            practised!(),
            ") AND NOT EXISTS (SELECT 1 FROM repair other WHERE other.fault = r.fault AND other.part <> r.part
                AND other.opened_at_us = r.opened_at_us AND other.event < c.seq AND other.back_at_us IS NULL)"
        )
    };
}

/// Confirmed repairs of a part. All that one run confirms of one part of a unit is one repair, for however many faults
/// and however often it was recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConfirmedRepairs {
    /// Repairs of this part.
    pub repairs: u32,
    /// Repairs (of any part) of faults that a diagnosis had attributed to this part before.
    pub named: u32,
    /// Repairs counted in `named` in which this part itself was repaired.
    pub right: u32,
    /// Units in which a fault came back after a repair of this part.
    pub in_vain: u32,
}

/// A run that shows a fault which a confirmed repair removed.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ConfirmedCase {
    /// The part that was repaired.
    pub part: String,
    /// The last failed run before the repair that saw the fault.
    pub run: Id,
    /// Serial number of the unit.
    pub unit: String,
}

impl RunSummary {
    /// Whether the run was practice.
    pub fn is_practice(&self) -> bool {
        is_practice(&self.source, self.injected.as_deref())
    }
}

/// Whether a run is practice: on a simulated unit, or with injected faults.
pub fn is_practice(source: &str, injected: Option<&str>) -> bool {
    source == "sim" || source.starts_with("lockstep:") || injected.is_some()
}

impl Store {
    /// The confirmed repairs of each part.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn confirmed_repairs(
        &self,
        of: RepairsOf<'_>,
    ) -> Result<BTreeMap<String, ConfirmedRepairs>, StoreError> {
        const DOING: &str = "counting the confirmed repairs";
        let values = values![of.before_us, of.unit_type, i64::from(of.practice)];
        let repairs = self.select(
            DOING,
            concat!(
                "SELECT r.unit, c.at_us, r.part, (SELECT d.body FROM fault_event d
                    WHERE d.fault = r.fault AND d.kind = 'diagnosed' AND d.at_us <= r.at_us
                    ORDER BY d.at_us DESC, d.seq DESC LIMIT 1) ",
                confirmed!()
            ),
            &values,
            |row| {
                let named = match row.get::<Option<&str>>(3)? {
                    Some(_) => Some(part_name(&json::<CauseRecord>(row, 3)?.part)),
                    None => None,
                };
                let (unit, at_us): (i64, i64) = (row.get(0)?, row.get(1)?);
                Ok(((unit, at_us, row.get::<String>(2)?), named))
            },
        )?;
        let mut counted: BTreeMap<String, ConfirmedRepairs> = BTreeMap::new();
        let repairs: BTreeSet<_> = repairs.into_iter().collect();
        let each: BTreeSet<_> = repairs.iter().map(|(repair, _)| repair).collect();
        for (.., part) in each {
            counted.entry(part.clone()).or_default().repairs += 1;
        }
        for ((.., part), named) in &repairs {
            if let Some(named) = named {
                let counts = counted.entry(named.clone()).or_default();
                counts.named += 1;
                counts.right += u32::from(named == part);
            }
        }
        let in_vain = self.select(
            DOING,
            concat!(
                "SELECT DISTINCT r.part, r.unit FROM repair r JOIN fault f ON f.seq = r.fault JOIN unit u ON u.seq = r.unit
                 WHERE r.back_at_us < ?1 AND u.config_name = ?2 AND (?3 = 1 OR NOT ",
                practised!(),
                ")"
            ),
            &values,
            |row| row.get::<String>(0),
        )?;
        for part in in_vain {
            counted.entry(part).or_default().in_vain += 1;
        }
        Ok(counted)
    }

    /// For each of the last `most` confirmed repairs, the last failed run before it that saw the fault; sorted.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn confirmed_cases(
        &self,
        of: RepairsOf<'_>,
        most: u32,
    ) -> Result<Vec<ConfirmedCase>, StoreError> {
        let found = self.select(
            "looking for confirmed cases",
            concat!(
                "SELECT r.part, (SELECT x.id FROM fault_occurrence o JOIN run x ON x.seq = o.run
                    WHERE o.fault = r.fault AND o.at_us <= r.at_us AND x.verdict = 'failed'
                    ORDER BY o.at_us DESC, o.seq DESC LIMIT 1), u.serial ",
                confirmed!(),
                " ORDER BY c.at_us DESC, r.event DESC LIMIT ?4"
            ),
            &values![
                of.before_us,
                of.unit_type,
                i64::from(of.practice),
                i64::from(most)
            ],
            |row| {
                let (part, unit) = (row.get(0)?, row.get(2)?);
                let run = row.get::<Option<Id>>(1)?;
                Ok(run.map(|run| ConfirmedCase { part, run, unit }))
            },
        )?;
        let mut cases: Vec<_> = found.into_iter().flatten().collect();
        cases.sort();
        cases.dedup();
        Ok(cases)
    }
}
