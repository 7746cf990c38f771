//! Confirmed repairs of all units: what diagnosis learns from the depot.
//!
//! A repair is confirmed when its fault is verified or closed and has not come back.

use std::collections::BTreeMap;

use super::faults::json;
use crate::backend::values;
use crate::error::StoreError;
use crate::id::Id;
use crate::record::{CauseRecord, part_name};
use crate::store::Store;

/// Confirmed repairs `r` before `?1` of units of type `?2`: the text from `FROM` on.
macro_rules! confirmed {
    () => {
        "FROM repair r JOIN fault f ON f.seq = r.fault JOIN unit u ON u.seq = r.unit
         WHERE f.state IN ('verified', 'closed') AND r.back_at_us IS NULL AND r.at_us < ?1 AND u.config_name = ?2"
    };
}

/// How often a part was found by a diagnosis and something was then repaired.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NamedAndRepaired {
    /// Confirmed repairs of faults that were attributed to the part.
    pub named: u32,
    /// Those of the part itself.
    pub right: u32,
}

impl Store {
    /// How often each part was repaired before a time, in units of a type (their configuration's name), and the repair is
    /// confirmed. Work on one unit at one time for several faults is one repair.
    pub fn confirmed_repairs(
        &self,
        before_us: i64,
        unit_type: &str,
    ) -> Result<BTreeMap<String, u32>, StoreError> {
        let counted = self.select(
            "counting the confirmed repairs",
            concat!(
                "SELECT part, count(*) FROM (SELECT DISTINCT r.part, r.unit, r.at_us ",
                confirmed!(),
                ") confirmed GROUP BY part"
            ),
            &values![before_us, unit_type],
            |row| Ok((row.get::<String>(0)?, row.get::<i64>(1)?)),
        )?;
        let count = |(part, count)| (part, u32::try_from(count).unwrap_or(u32::MAX));
        Ok(counted.into_iter().map(count).collect())
    }

    /// The runs in which faults with a confirmed repair showed last before it, each with the part that was repaired; of
    /// `most` repairs, the last ones.
    pub fn confirmed_cases(
        &self,
        before_us: i64,
        unit_type: &str,
        most: u32,
    ) -> Result<Vec<(String, Id)>, StoreError> {
        let found = self.select(
            "looking for confirmed cases",
            concat!(
                "SELECT r.part, (SELECT x.id FROM fault_occurrence o JOIN run x ON x.seq = o.run
                    WHERE o.fault = r.fault AND o.at_us <= r.at_us AND x.verdict = 'failed'
                    ORDER BY o.at_us DESC, o.seq DESC LIMIT 1) ",
                confirmed!(),
                " ORDER BY r.at_us DESC, r.event DESC LIMIT ?3"
            ),
            &values![before_us, unit_type, i64::from(most)],
            |row| Ok((row.get::<String>(0)?, row.get::<Option<Id>>(1)?)),
        )?;
        let found = found
            .into_iter()
            .filter_map(|(part, run)| Some((part, run?)));
        let mut cases: Vec<_> = found.collect();
        cases.sort();
        cases.dedup();
        Ok(cases)
    }

    /// Of the confirmed repairs of faults that a diagnosis had attributed to a part: how often that part was repaired.
    pub fn named_and_repaired(
        &self,
        before_us: i64,
        unit_type: &str,
    ) -> Result<BTreeMap<String, NamedAndRepaired>, StoreError> {
        let mut repairs = self.select(
            "comparing diagnoses with repairs",
            concat!(
                "SELECT r.unit, r.at_us, r.part, (SELECT d.body FROM fault_event d
                    WHERE d.fault = r.fault AND d.kind = 'diagnosed' AND d.at_us <= r.at_us
                    ORDER BY d.at_us DESC, d.seq DESC LIMIT 1) ",
                confirmed!()
            ),
            &values![before_us, unit_type],
            |row| {
                let diagnosed = match row.get::<Option<&str>>(3)? {
                    Some(_) => Some(json::<CauseRecord>(row, 3)?),
                    None => None,
                };
                let named = diagnosed.map(|cause| part_name(&cause.part));
                Ok((
                    row.get::<i64>(0)?,
                    row.get::<i64>(1)?,
                    row.get::<String>(2)?,
                    named,
                ))
            },
        )?;
        repairs.sort();
        repairs.dedup();
        let mut counted: BTreeMap<String, NamedAndRepaired> = BTreeMap::new();
        for (.., part, named) in repairs {
            if let Some(named) = named {
                let is_right = named == part;
                let counts = counted.entry(named).or_default();
                counts.named += 1;
                counts.right += u32::from(is_right);
            }
        }
        Ok(counted)
    }
}
