//! Faults: the list, and one with its occurrences and events.

use serde::Serialize;

use super::fault_filter::FaultFilter;
use super::filter::limit;
use crate::backend::{Row, SqlError, SqlResult, from_row, values};
use crate::error::StoreError;
use crate::history::cases::REST_OF_CASE;
use crate::id::Id;
use crate::store::Store;
use crate::values::event::{Correction, FaultEvent};
use crate::values::fault_state::FaultState;
use crate::values::record::{CAUSE, CauseRecord, DIAGNOSED, FreezeSample, REPAIR, RepairRecord};

/// A fault in a list: one row for each unit, code and part, until the fault is closed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultSummary {
    /// The fault.
    pub id: Id,
    /// Serial number of its unit.
    pub unit_serial: String,
    /// Code of the fault.
    pub code: i64,
    /// Name of the code.
    pub code_name: String,
    /// The part that the fault points at.
    pub lru: String,
    /// The part that the fault comes from, if a diagnosis or a person has attributed it.
    pub cause: Option<String>,
    /// Severity.
    pub severity: String,
    /// State of the fault.
    pub state: FaultState,
    /// First seen.
    pub first_at_us: i64,
    /// Last seen.
    pub last_at_us: i64,
    /// Number of occurrences.
    pub occurrences: u32,
    /// Latest trace of the fault.
    pub trace_id: Option<Id>,
    /// Last finding, in English.
    pub message: String,
    /// The findings behind `message` as data: JSON of the program.
    pub findings: Option<String>,
}

impl FaultSummary {
    /// The part that the fault counts for: the one it comes from, or else the one it points at.
    pub fn cause(&self) -> &str {
        self.cause.as_deref().unwrap_or(&self.lru)
    }
}

/// A fault with its occurrences and events.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultDetail {
    /// The fault.
    pub fault: FaultSummary,
    /// The other faults of the fault's case: of the same unit, not closed, and from the same part.
    pub case: Vec<FaultSummary>,
    /// Occurrences of the fault, newest first, at most [`FaultDetail::MAX_OCCURRENCES`].
    pub occurrences: Vec<Occurrence>,
    /// Events that are not withdrawn, oldest first.
    pub events: Vec<FaultEvent>,
    /// Withdrawn events, oldest first; they count for nothing.
    pub withdrawn: Vec<FaultEvent>,
}

impl FaultDetail {
    /// Greatest number of occurrences that are read of a fault.
    pub const MAX_OCCURRENCES: u32 = 200;

    /// All events of the fault, including withdrawn ones, oldest first.
    pub fn history(&self) -> Vec<&FaultEvent> {
        let mut events: Vec<_> = self.events.iter().chain(&self.withdrawn).collect();
        events.sort_by_key(|event| event.at_us);
        events
    }
}

/// An occurrence of a fault.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Occurrence {
    /// The occurrence.
    pub id: Id,
    /// The run that saw it.
    pub run_id: Id,
    /// The step under way, if any.
    pub step_index: Option<u32>,
    /// When, µs since 1970.
    pub at_us: i64,
    /// Bench time of the occurrence.
    pub bench_us: i64,
    /// Description, in English.
    pub message: String,
    /// The findings behind `message` as data: JSON of the program.
    pub findings: Option<String>,
    /// Trace of the occurrence, if one was kept.
    pub trace_id: Option<Id>,
    /// Freeze frame: all signals at that moment.
    pub freeze: Vec<FreezeSample>,
}

const SELECT_FAULT: &str = "
    SELECT x.id, u.serial, x.code, x.code_name, x.lru, x.severity, x.state, x.first_at_us,
        x.last_at_us, x.occurrences,
        (SELECT t.id FROM fault_occurrence o JOIN trace t ON t.seq = o.trace
         WHERE o.fault = x.seq AND o.trace IS NOT NULL ORDER BY o.at_us DESC, o.seq DESC LIMIT 1),
        x.seq, x.cause,
        last.message, last.findings
    FROM fault x JOIN unit u ON u.seq = x.unit LEFT JOIN fault_occurrence last ON last.seq =
        (SELECT o.seq FROM fault_occurrence o WHERE o.fault = x.seq
         ORDER BY o.at_us DESC, o.seq DESC LIMIT 1)";

impl Store {
    /// Lists faults, last seen first.
    pub fn faults(&self, filter: &FaultFilter) -> Result<Vec<FaultSummary>, StoreError> {
        let mut resolved = filter.resolve(self)?;
        resolved.estimate_frequency(self)?;
        let conditions = resolved.conditions_seen(&self.backend);
        let order = "ORDER BY x.last_at_us DESC, x.seq DESC";
        let limit = limit(filter.limit);
        let sql = format!("{SELECT_FAULT} {} {order} {limit}", conditions.sql());
        self.select("listing faults", &sql, conditions.values(), summary)
    }

    /// One fault with its occurrences, freeze frames and events.
    pub fn fault(&self, id: Id) -> Result<FaultDetail, StoreError> {
        const DOING: &str = "reading a fault";
        let select = format!("{SELECT_FAULT} WHERE x.id = ?1");
        let row = |row: Row<'_>| Ok((summary(row)?, row.get::<i64>(11)?));
        let found = self.first(DOING, &select, &values![id], row)?;
        let (fault, seq) = found.ok_or_else(|| StoreError::not_found("fault", id))?;
        let case = format!(
            "{SELECT_FAULT} WHERE x.seq IN (SELECT c.seq FROM {REST_OF_CASE}) ORDER BY x.seq"
        );
        let case = self.select(DOING, &case, &values![seq], summary)?;
        let occurrences = self.ask(DOING, |_| self.occurrences(seq))?;
        let events = self.ask(DOING, |_| self.events(seq))?.into_iter();
        let (withdrawn, events) = events.partition(|event| event.correction.is_some());
        Ok(FaultDetail {
            fault,
            case,
            occurrences,
            events,
            withdrawn,
        })
    }

    fn occurrences(&self, fault: i64) -> SqlResult<Vec<Occurrence>> {
        self.backend.select(
            "SELECT o.id, r.id, o.step_index, o.at_us, o.bench_us, o.message, o.findings, t.id, o.freeze_json
             FROM fault_occurrence o JOIN run r ON r.seq = o.run
             LEFT JOIN trace t ON t.seq = o.trace
             WHERE o.fault = ?1 ORDER BY o.at_us DESC, o.seq DESC LIMIT ?2",
            &values![fault, FaultDetail::MAX_OCCURRENCES],
            |row| {
                Ok(from_row!(row => Occurrence:
                    id, run_id, step_index, at_us, bench_us, message, findings, trace_id;
                    freeze: json(row, 8)?
                ))
            },
        )
    }

    /// All events of a fault. An event that several stores have withdrawn has the first of these corrections.
    fn events(&self, fault: i64) -> SqlResult<Vec<FaultEvent>> {
        let mut events = self.backend.select(
            "SELECT e.id, e.kind, e.at_us, e.who, e.body, e.state, w.at_us, w.who, w.body
             FROM fault_event e LEFT JOIN fault_event w ON w.kind = 'withdrawn' AND w.follows = e.id
             WHERE e.fault = ?1 AND e.kind <> 'withdrawn' ORDER BY e.at_us, e.seq, w.turn, w.id",
            &values![fault],
            |row| {
                let said = Said::read(row, 1, 4)?;
                Ok(from_row!(row => FaultEvent:
                    id, kind, at_us, who, _, state;
                    note: said.note,
                    repair: said.repair,
                    cause: said.cause,
                    correction: match row.get::<Option<i64>>(6)? {
                        Some(at_us) => Some(Correction {
                            at_us,
                            who: row.get(7)?,
                            note: row.get(8)?,
                        }),
                        None => None,
                    }
                ))
            },
        )?;
        events.dedup_by_key(|event| event.id);
        Ok(events)
    }
}

/// What the body of an event says: a repair, a cause, or else a text.
pub(super) struct Said {
    pub note: String,
    pub repair: Option<RepairRecord>,
    pub cause: Option<CauseRecord>,
}

impl Said {
    /// Reads the columns of an event's kind and body.
    pub fn read(row: Row<'_>, kind: usize, body: usize) -> SqlResult<Self> {
        let (mut repair, mut cause, mut note) = (None, None, String::new());
        match row.get(kind)? {
            REPAIR => repair = Some(json(row, body)?),
            CAUSE | DIAGNOSED => cause = Some(json(row, body)?),
            _ => note = row.get(body)?,
        }
        Ok(Self {
            note,
            repair,
            cause,
        })
    }
}

fn summary(row: Row<'_>) -> SqlResult<FaultSummary> {
    Ok(from_row!(row => FaultSummary:
        id, unit_serial, code, code_name, lru, severity, state, first_at_us, last_at_us,
        occurrences, trace_id, _, cause, _, findings;
        message: row.get::<Option<String>>(13)?.unwrap_or_default()
    ))
}

pub(super) fn json<T: serde::de::DeserializeOwned>(row: Row<'_>, column: usize) -> SqlResult<T> {
    serde_json::from_str(row.get(column)?).map_err(|error| SqlError::Value {
        column,
        reason: error.to_string(),
    })
}
