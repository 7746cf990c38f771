//! Confirmed repairs of all units: what diagnosis learns from the depot.
//!
//! A repair is confirmed when its fault is verified or closed and has not come back.

use std::collections::{BTreeMap, BTreeSet};

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

/// Confirmed repairs of a part. Work on one unit at one time for several faults is one repair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConfirmedRepairs {
    /// Of this part.
    pub repairs: u32,
    /// Of any part, where a diagnosis had attributed the fault to this one.
    pub named: u32,
    /// Of these, of the part itself.
    pub right: u32,
}

impl Store {
    /// The confirmed repairs of each part before a time, in units of a type (their configuration's name).
    pub fn confirmed_repairs(
        &self,
        before_us: i64,
        unit_type: &str,
    ) -> Result<BTreeMap<String, ConfirmedRepairs>, StoreError> {
        let repairs = self.select(
            "counting the confirmed repairs",
            concat!(
                "SELECT r.unit, r.at_us, r.part, (SELECT d.body FROM fault_event d
                    WHERE d.fault = r.fault AND d.kind = 'diagnosed' AND d.at_us <= r.at_us
                    ORDER BY d.at_us DESC, d.seq DESC LIMIT 1) ",
                confirmed!()
            ),
            &values![before_us, unit_type],
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
        Ok(counted)
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
}
