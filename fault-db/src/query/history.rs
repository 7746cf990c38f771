//! The history of one unit: parts that earlier faults pointed at, their repairs, and which entries of a log
//! read from the unit are stored already.

use std::collections::{BTreeMap, BTreeSet};

use super::faults::json;
use crate::backend::{Row, SqlResult, from_row, values};
use crate::error::StoreError;
use crate::history::graph_sql::standing;
use crate::id::Id;
use crate::store::Store;
use crate::values::record::LOG_SOURCE;
use crate::values::record::REPAIR;
use crate::values::record::{RepairRecord, part_name};

/// Greatest difference, µs, of the times that two readings of a log give one entry: the unit's clock and this
/// computer's drift, and an answer takes time. The same event after another power-up comes later than this.
pub const SAME_ENTRY_US: i64 = 5_000_000;

/// The history of one part in a unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PartHistory {
    /// Runs since the part's last repair in which a fault pointed at the part.
    pub runs: u32,
    /// Last repair of the part.
    pub repair: Option<PartRepair>,
}

/// The last repair of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartRepair {
    /// Time of the repair, µs since 1970.
    pub at_us: i64,
    /// Whether the part was replaced; otherwise it was worked on.
    pub replaced: bool,
    /// The faults for which the part was repaired, this time or earlier: number, and the part that the fault names.
    pub faults: BTreeSet<(i64, String)>,
    /// Whether one of these faults came back after its repair.
    pub came_back: bool,
}

struct Seen {
    run: i64,
    of_log: bool,
    code: i64,
    lru: String,
    at_us: i64,
    message: String,
}

/// A repair of a part for a fault.
struct Repaired {
    code: i64,
    lru: String,
    at_us: i64,
    repair: RepairRecord,
}

impl Store {
    /// The history of each part of a unit, from `since_us` until `before_us`. The run `but` is left out, and
    /// so are entries of an imported log that another run reports, too.
    pub fn part_history(
        &self,
        unit: &str,
        (since_us, before_us): (i64, i64),
        but: Option<Id>,
    ) -> Result<BTreeMap<String, PartHistory>, StoreError> {
        let (seen, repairs) = self.ask("reading a unit's history", |_| {
            let seen = self.seen_before(unit, (since_us, before_us), but)?;
            Ok((seen, self.repairs_before(unit, (since_us, before_us))?))
        })?;
        let mut parts: BTreeMap<String, PartHistory> = BTreeMap::new();
        for (part, repairs) in by_part(repairs) {
            let repair = part_repair(&repairs, &seen);
            parts.entry(part).or_default().repair = repair;
        }
        let mut runs: BTreeMap<&str, BTreeSet<i64>> = BTreeMap::new();
        for fault in &seen {
            let part = parts.get(&fault.lru);
            let repaired = part.and_then(|part| part.repair.as_ref());
            if repaired.is_none_or(|repair| fault.at_us > repair.at_us) {
                runs.entry(&fault.lru).or_default().insert(fault.run);
            }
        }
        for (part, runs) in runs {
            parts.entry(part.to_owned()).or_default().runs = runs.len() as u32;
        }
        Ok(parts)
    }

    fn seen_before(
        &self,
        unit: &str,
        (since_us, before_us): (i64, i64),
        but: Option<Id>,
    ) -> SqlResult<Vec<Seen>> {
        let row = |row: Row<'_>| {
            Ok(from_row!(row => Seen:
                run, _, code, lru, at_us, message;
                of_log: row.get::<&str>(1)?.starts_with(LOG_SOURCE)
            ))
        };
        // No run has an empty id, so without `but` no run is left out.
        let but = but.map_or_else(Vec::new, |id| id.as_bytes().to_vec());
        let all = self.backend.select(
            "SELECT r.seq, r.source, f.code, f.lru, o.at_us, o.message
             FROM unit u JOIN run r ON r.unit = u.seq
             JOIN fault_occurrence o ON o.run = r.seq JOIN fault f ON f.seq = o.fault
             WHERE u.serial = ?1 AND r.started_at_us < ?3
                AND r.id <> ?4
                AND o.at_us >= ?2 AND o.at_us < ?3
             ORDER BY r.seq, o.seq",
            &values![unit, since_us, before_us, &but[..]],
            row,
        )?;
        let told: Vec<bool> = all
            .iter()
            .map(|seen| seen.of_log && told_before(seen, &all))
            .collect();
        let kept = all.into_iter().zip(told).filter(|(_, told)| !told);
        Ok(kept.map(|(seen, _)| seen).collect())
    }

    fn repairs_before(
        &self,
        unit: &str,
        (since_us, before_us): (i64, i64),
    ) -> SqlResult<Vec<Repaired>> {
        self.backend.select(
            concat!(
                "SELECT f.code, f.lru, e.at_us, e.body
                 FROM unit u JOIN fault f ON f.unit = u.seq JOIN fault_event e ON e.fault = f.seq
                 WHERE u.serial = ?1 AND e.kind = ?2 AND e.at_us >= ?3 AND e.at_us < ?4",
                standing!("e"),
                " ORDER BY e.at_us, e.seq"
            ),
            &values![unit, REPAIR, since_us, before_us],
            |row| {
                Ok(from_row!(row => Repaired:
                    code, lru, at_us;
                    repair: json(row, 3)?
                ))
            },
        )
    }

    /// Whether the unit has a stored occurrence of this fault with this message, at about the time `at_us`, or at any
    /// time if `None`.
    pub fn knows_occurrence(
        &self,
        unit: &str,
        (code, message): (i64, &str),
        at_us: Option<i64>,
    ) -> Result<bool, StoreError> {
        let from_us = at_us.map_or(i64::MIN, |at| at.saturating_sub(SAME_ENTRY_US));
        let until_us = at_us.map_or(i64::MAX, |at| at.saturating_add(SAME_ENTRY_US));
        self.has(
            "looking for a fault",
            "SELECT 1 FROM unit u JOIN fault f ON f.unit = u.seq
                 JOIN fault_occurrence o ON o.fault = f.seq
                 WHERE u.serial = ?1 AND f.code = ?2 AND o.at_us BETWEEN ?3 AND ?4
                    AND o.message = ?5 LIMIT 1",
            &values![unit, code, from_us, until_us, message],
        )
    }

    /// Whether an occurrence has this id.
    pub fn has_occurrence(&self, id: Id) -> Result<bool, StoreError> {
        let known = "SELECT 1 FROM fault_occurrence WHERE id = ?1";
        self.has("looking for an occurrence", known, &values![id])
    }

    /// Whether a trace has this id.
    pub fn has_trace(&self, id: Id) -> Result<bool, StoreError> {
        let known = "SELECT 1 FROM trace WHERE id = ?1";
        self.has("looking for a trace", known, &values![id])
    }

    /// The freeze frame of the entry of a unit's log that was imported last, as JSON.
    pub fn last_logged(&self, unit: &str) -> Result<Option<String>, StoreError> {
        self.first(
            "looking for a unit's log",
            "SELECT o.freeze_json FROM unit u JOIN run r ON r.unit = u.seq
                JOIN fault_occurrence o ON o.run = r.seq
             WHERE u.serial = ?1 AND r.source LIKE ?2
             ORDER BY r.started_at_us DESC, o.seq DESC LIMIT 1",
            &values![unit, format!("{LOG_SOURCE}%")],
            |row| row.get(0),
        )
    }

    /// The spans in which the unit itself, on a port, was under test: start and end, µs UTC. An interrupted run lasted
    /// until its last step.
    pub fn tested_spans(&self, unit: &str) -> Result<Vec<(i64, i64)>, StoreError> {
        self.select(
            "listing a unit's runs",
            "SELECT r.started_at_us, coalesce(r.finished_at_us, r.started_at_us
                        + coalesce((SELECT max(s.started_bench_us + s.bench_time_us)
                            FROM step s WHERE s.run = r.seq), 0))
                     FROM unit u JOIN run r ON r.unit = u.seq
                     WHERE u.serial = ?1 AND r.source <> 'sim' AND r.source NOT LIKE ?2
                     ORDER BY r.started_at_us",
            &values![unit, format!("{LOG_SOURCE}%")],
            |row| Ok((row.get(0)?, row.get(1)?)),
        )
    }
}

/// Whether another run reports this occurrence, too: any test, or a log that was imported earlier.
fn told_before(seen: &Seen, all: &[Seen]) -> bool {
    all.iter().any(|other| {
        other.run != seen.run
            && (!other.of_log || other.run < seen.run)
            && other.code == seen.code
            && other.message == seen.message
            && other.at_us.abs_diff(seen.at_us) <= SAME_ENTRY_US.unsigned_abs()
    })
}

/// Repairs by part; the names of parts are compared in the form that `part_name` gives.
fn by_part(repairs: Vec<Repaired>) -> BTreeMap<String, Vec<Repaired>> {
    let mut parts: BTreeMap<String, Vec<Repaired>> = BTreeMap::new();
    for repaired in repairs {
        let part = part_name(&repaired.repair.part);
        parts.entry(part).or_default().push(repaired);
    }
    parts
}

/// The last of a part's repairs, which are in order of time. A fault came back if it was seen after the last repair
/// made for it.
fn part_repair(repairs: &[Repaired], seen: &[Seen]) -> Option<PartRepair> {
    let last = repairs.last()?;
    let mut repaired_at: BTreeMap<(i64, String), i64> = BTreeMap::new();
    for repaired in repairs {
        repaired_at.insert((repaired.code, repaired.lru.clone()), repaired.at_us);
    }
    let came_back = seen.iter().any(|fault| {
        let of_fault = repaired_at.get(&(fault.code, fault.lru.clone()));
        of_fault.is_some_and(|repaired| fault.at_us > *repaired)
    });
    Some(PartRepair {
        at_us: last.at_us,
        replaced: last.repair.serial_new.is_some() || last.repair.serial_old.is_some(),
        faults: repaired_at.into_keys().collect(),
        came_back,
    })
}
