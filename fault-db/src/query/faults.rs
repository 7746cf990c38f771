//! Faults: the list, and one with its occurrences and events.

use rusqlite::types::Type;
use rusqlite::{Row, params};
use serde::Serialize;

use super::filter::Conditions;
use crate::error::StoreError;
use crate::fault_log::REPAIR;
use crate::fault_state::FaultState;
use crate::id::Id;
use crate::record::{FreezeSample, RepairRecord};
use crate::store::Store;

/// Which faults to list, last seen first; `None` does not restrict.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FaultFilter {
    /// Serial number of the unit.
    pub unit: Option<String>,
    /// Number (decimal, or hex after `0x`) or name of the fault.
    pub code: Option<String>,
    /// The part it points at.
    pub lru: Option<String>,
    /// How bad it is.
    pub severity: Option<String>,
    /// Where it stands.
    pub state: Option<FaultState>,
    /// Seen in this run.
    pub run: Option<Id>,
    /// Seen at this time or later.
    pub since_us: Option<i64>,
    /// First seen before this time.
    pub until_us: Option<i64>,
    /// At most so many.
    pub limit: Option<u32>,
}

/// A fault in a list: one row per unit, code and part until it is closed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultSummary {
    /// The fault.
    pub id: Id,
    /// Serial number of its unit.
    pub unit_serial: String,
    /// Its number.
    pub code: i64,
    /// Its name.
    pub code_name: String,
    /// The part it points at.
    pub lru: String,
    /// How bad it is.
    pub severity: String,
    /// Where it stands.
    pub state: FaultState,
    /// First seen.
    pub first_at_us: i64,
    /// Last seen.
    pub last_at_us: i64,
    /// Times seen.
    pub occurrences: u32,
    /// Its latest trace.
    pub trace_id: Option<Id>,
}

/// A fault with all that belongs to it but its traces' samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultDetail {
    /// The fault.
    pub fault: FaultSummary,
    /// Its occurrences, newest first, at most [`FaultDetail::MAX_OCCURRENCES`].
    pub occurrences: Vec<Occurrence>,
    /// What was done about it, oldest first.
    pub events: Vec<FaultEvent>,
}

impl FaultDetail {
    /// So many occurrences are read at most, whatever the fault's count.
    pub const MAX_OCCURRENCES: u32 = 1_000;
}

/// A fault seen once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Occurrence {
    /// The occurrence.
    pub id: Id,
    /// The run that saw it.
    pub run_id: Id,
    /// The step under way.
    pub step_index: Option<u32>,
    /// When.
    pub at_us: i64,
    /// When, on the bench's clock.
    pub bench_us: i64,
    /// What was seen.
    pub message: String,
    /// Its trace, if one was kept.
    pub trace_id: Option<Id>,
    /// All signals at that moment.
    pub freeze: Vec<FreezeSample>,
}

/// Something that happened to a fault.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultEvent {
    /// The event.
    pub id: Id,
    /// opened, recurred, acknowledged, repair, repaired, verified, closed, reopened or note.
    pub kind: String,
    /// When.
    pub at_us: i64,
    /// Who; empty for the tester itself.
    pub who: String,
    /// What was said; empty for a repair.
    pub note: String,
    /// The fault's state after it; none if it stayed.
    pub state: Option<FaultState>,
    /// The repair, if it is one.
    pub repair: Option<RepairRecord>,
}

const SELECT_FAULT: &str = "
    SELECT f.id, u.serial, f.code, f.code_name, f.lru, f.severity, f.state, f.first_at_us,
        f.last_at_us, f.occurrences,
        (SELECT t.id FROM fault_occurrence o JOIN trace t ON t.seq = o.trace
         WHERE o.fault = f.seq ORDER BY o.at_us DESC, o.seq DESC LIMIT 1),
        f.seq
    FROM fault f JOIN unit u ON u.seq = f.unit";

impl Store {
    /// Lists faults, last seen first.
    pub fn faults(&self, filter: &FaultFilter) -> Result<Vec<FaultSummary>, StoreError> {
        let mut conditions = Conditions::default();
        conditions.add("u.serial = ?", filter.unit.clone());
        match filter.code.as_deref().map(|code| (code, code_number(code))) {
            Some((_, Some(number))) => conditions.add("f.code = ?", Some(number)),
            Some((name, None)) => {
                conditions.add("f.code_name = ? COLLATE NOCASE", Some(name.to_owned()));
            }
            None => {}
        }
        conditions.add("f.lru = ? COLLATE NOCASE", filter.lru.clone());
        conditions.add("f.severity = ? COLLATE NOCASE", filter.severity.clone());
        conditions.add("f.state = ?", filter.state.map(|state| state.to_string()));
        conditions.add(
            "f.seq IN (SELECT o.fault FROM fault_occurrence o JOIN run r ON r.seq = o.run
                WHERE r.id = ?)",
            filter.run.map(|run| run.as_bytes().to_vec()),
        );
        conditions.add("f.last_at_us >= ?", filter.since_us);
        conditions.add("f.first_at_us < ?", filter.until_us);
        let order = "ORDER BY f.last_at_us DESC, f.seq DESC";
        let limit = filter.limit.map_or(-1, i64::from);
        let sql = format!("{SELECT_FAULT} {} {order} LIMIT {limit}", conditions.sql());
        let list = || -> rusqlite::Result<Vec<_>> {
            let mut select = self.conn.prepare_cached(&sql)?;
            select.query_map(conditions.params(), summary)?.collect()
        };
        list().map_err(|error| self.failed("listing faults", error))
    }

    /// One fault with its occurrences, freeze frames and events.
    pub fn fault(&self, id: Id) -> Result<FaultDetail, StoreError> {
        let select = format!("{SELECT_FAULT} WHERE f.id = ?1");
        let found = self.conn.prepare_cached(&select).and_then(|mut select| {
            let row = |row: &Row<'_>| Ok((summary(row)?, row.get::<_, i64>(11)?));
            select.query_row(params![id], row)
        });
        let (fault, seq) = found.map_err(|error| self.not_found("fault", id, error))?;
        let failed = |error| self.failed("reading a fault", error);
        let occurrences = self.occurrences(seq).map_err(failed)?;
        let events = self.events(seq).map_err(failed)?;
        Ok(FaultDetail {
            fault,
            occurrences,
            events,
        })
    }

    fn occurrences(&self, fault: i64) -> rusqlite::Result<Vec<Occurrence>> {
        let mut select = self.conn.prepare_cached(
            "SELECT o.id, r.id, o.step_index, o.at_us, o.bench_us, o.message, t.id, o.freeze_json
             FROM fault_occurrence o JOIN run r ON r.seq = o.run
             LEFT JOIN trace t ON t.seq = o.trace
             WHERE o.fault = ?1 ORDER BY o.at_us DESC, o.seq DESC LIMIT ?2",
        )?;
        let occurrences =
            select.query_map(params![fault, FaultDetail::MAX_OCCURRENCES], |row| {
                Ok(Occurrence {
                    id: row.get(0)?,
                    run_id: row.get(1)?,
                    step_index: row.get(2)?,
                    at_us: row.get(3)?,
                    bench_us: row.get(4)?,
                    message: row.get(5)?,
                    trace_id: row.get(6)?,
                    freeze: json(row, 7)?,
                })
            })?;
        occurrences.collect()
    }

    fn events(&self, fault: i64) -> rusqlite::Result<Vec<FaultEvent>> {
        let mut select = self.conn.prepare_cached(
            "SELECT id, kind, at_us, who, body, state FROM fault_event
             WHERE fault = ?1 ORDER BY at_us, seq",
        )?;
        let events = select.query_map([fault], |row| {
            let kind: String = row.get(1)?;
            let is_repair = kind == REPAIR;
            Ok(FaultEvent {
                id: row.get(0)?,
                at_us: row.get(2)?,
                who: row.get(3)?,
                note: if is_repair {
                    String::new()
                } else {
                    row.get(4)?
                },
                state: row.get(5)?,
                repair: if is_repair { Some(json(row, 4)?) } else { None },
                kind,
            })
        })?;
        events.collect()
    }
}

fn summary(row: &Row<'_>) -> rusqlite::Result<FaultSummary> {
    Ok(FaultSummary {
        id: row.get(0)?,
        unit_serial: row.get(1)?,
        code: row.get(2)?,
        code_name: row.get(3)?,
        lru: row.get(4)?,
        severity: row.get(5)?,
        state: row.get(6)?,
        first_at_us: row.get(7)?,
        last_at_us: row.get(8)?,
        occurrences: row.get(9)?,
        trace_id: row.get(10)?,
    })
}

fn code_number(code: &str) -> Option<i64> {
    match code.strip_prefix("0x") {
        Some(hex) => i64::from_str_radix(hex, 16).ok(),
        None => code.parse().ok(),
    }
}

pub(super) fn json<T: serde::de::DeserializeOwned>(
    row: &Row<'_>,
    column: usize,
) -> rusqlite::Result<T> {
    serde_json::from_str(row.get_ref(column)?.as_str()?).map_err(|error| {
        rusqlite::Error::FromSqlConversionFailure(column, Type::Text, Box::new(error))
    })
}
