//! The life of a unit, a train or a part by its serial number: where it was, and everything stored about it in order of time.
//!
//! Each is made of units in spans of time. A unit's own life is one span without ends. A train's life is the *stays* of
//! units in the train: from a unit's first run there to its first run in another train. A part's life is its stays in
//! units: from the repair that put the part in to the repair that took it out; of the unit's faults only those count
//! that come from a part of this name.

use std::collections::BTreeMap;

use serde::Serialize;

use super::faults::Said;
use super::stays::{Span, Stay};
use crate::backend::{SqlResult, from_row, values};
use crate::error::StoreError;
use crate::history::graph_sql::standing;
use crate::id::Id;
use crate::store::Store;
use crate::values::record::{CauseRecord, RepairRecord, Verdict, part_name};
use crate::values::text_enum::text_enum;

text_enum! {
    /// Kind of thing that has the serial number.
    LifeOf {
        /// A unit.
        Unit = "unit",
        /// A train that units are in.
        Train = "train",
        /// A part that repairs put in or took out.
        Part = "part",
    }
}

/// The life of a thing with a serial number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Life {
    /// Whether the serial number is of a unit, a train or a part.
    pub of: LifeOf,
    /// The serial number.
    pub serial: String,
    /// Stays, oldest first: trains of a unit, units of a train, units of a part.
    pub stays: Vec<Stay>,
    /// Stored events, oldest first.
    pub events: Vec<LifeEvent>,
}

/// A stored event in the life of a unit, train or part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LifeEvent {
    /// When, µs since 1970.
    pub at_us: i64,
    /// Serial number of the unit.
    pub unit: String,
    /// A run or an event of faults.
    #[serde(flatten)]
    pub what: LifeWhat,
}

/// A run or an event of faults.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LifeWhat {
    /// A run, an imported log or a pulled record.
    Run(LifeRun),
    /// An event of a fault, or of several of one case at once.
    Fault(Box<LifeFault>),
}

/// A run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LifeRun {
    /// The run.
    pub id: Id,
    /// Verdict; `None` if the run is not over.
    pub verdict: Option<Verdict>,
    /// Name of the tester.
    pub operator: String,
    /// Where the unit was.
    pub source: String,
    /// The train the unit was in; empty if not given.
    pub train: String,
    /// Number of faults seen.
    pub faults: u32,
}

/// An event of a fault.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LifeFault {
    /// The kind of the event, as in [`FaultEvent`](crate::FaultEvent).
    pub kind: String,
    /// Name of the person; empty for the program itself.
    pub who: String,
    /// The text; empty for a repair and for a cause.
    pub note: String,
    /// Findings behind the text as data, for an occurrence.
    pub findings: Option<String>,
    /// The repair, if the event is one.
    pub repair: Option<RepairRecord>,
    /// The part that the fault comes from, if the event says so.
    pub cause: Option<CauseRecord>,
    /// The fault, or several faults of one case.
    pub faults: Vec<NamedFault>,
}

/// A fault by its names.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedFault {
    /// The fault.
    pub id: Id,
    /// Code of the fault.
    pub code: i64,
    /// Name of the code.
    pub code_name: String,
    /// The part that the fault comes from, or else points at.
    pub part: String,
}

impl Store {
    /// The lives of everything with this serial number: a unit, a train, a part; empty if nothing has it.
    ///
    /// # Errors
    /// The file or the server cannot be read.
    pub fn lives(&self, serial: &str) -> Result<Vec<Life>, StoreError> {
        self.ask("reading a life", |_| {
            let found = [
                (LifeOf::Unit, self.stays_of_unit(serial)?),
                (LifeOf::Train, self.stays_in_train(serial)?),
                (LifeOf::Part, self.stays_of_part(serial)?),
            ];
            let mut lives = Vec::new();
            for (of, (stays, spans)) in found {
                if !spans.is_empty() {
                    lives.push(self.life((of, serial), stays, &spans)?);
                }
            }
            Ok(lives)
        })
    }

    fn life(
        &self,
        (of, serial): (LifeOf, &str),
        mut stays: Vec<Stay>,
        spans: &[Span],
    ) -> SqlResult<Life> {
        for stay in &mut stays {
            stay.runs = self.runs_in(stay)?;
        }
        let mut events = Vec::new();
        for span in spans {
            if span.part.is_none() {
                events.extend(self.runs_of(span)?);
            }
            events.extend(self.fault_events_of(span)?);
        }
        events.sort_by_key(|event: &LifeEvent| event.at_us);
        events.dedup();
        Ok(Life {
            of,
            serial: serial.to_owned(),
            stays,
            events,
        })
    }

    fn runs_of(&self, span: &Span) -> SqlResult<Vec<LifeEvent>> {
        self.backend.select(
            "SELECT r.started_at_us, r.id, r.verdict, r.operator, r.source, r.train,
                (SELECT count(DISTINCT o.fault) FROM fault_occurrence o WHERE o.run = r.seq)
             FROM run r WHERE r.unit = ?1 AND r.started_at_us >= ?2 AND r.started_at_us <= ?3
             ORDER BY r.started_at_us, r.id",
            &values![span.unit, span.from_us, span.until_us],
            |row| {
                Ok(LifeEvent {
                    at_us: row.get(0)?,
                    unit: span.serial.clone(),
                    what: LifeWhat::Run(from_row!(row => LifeRun:
                        _, id, verdict, operator, source, train, faults
                    )),
                })
            },
        )
    }

    /// Events of a unit's faults in a span; an event written at several faults at once counts as one.
    fn fault_events_of(&self, span: &Span) -> SqlResult<Vec<LifeEvent>> {
        let mut together: BTreeMap<(i64, String, String, String), LifeFault> = BTreeMap::new();
        self.backend.each(
            concat!(
                "SELECT e.at_us, e.kind, e.who, e.body, f.id, f.code, f.code_name, coalesce(f.cause, f.lru),
                    (SELECT o.findings FROM fault_occurrence o
                     WHERE o.fault = f.seq AND o.at_us = e.at_us AND o.message = e.body LIMIT 1)
                 FROM fault f JOIN fault_event e ON e.fault = f.seq
                 WHERE f.unit = ?1 AND e.at_us >= ?2 AND e.at_us <= ?3 AND e.kind <> 'withdrawn'",
                standing!("e"),
                " ORDER BY e.at_us, f.code, f.lru, e.id"
            ),
            &values![span.unit, span.from_us, span.until_us],
            |row| {
                let said = Said::read(row, 1, 3)?;
                let fault = from_row!(row => NamedFault: _, _, _, _, id, code, code_name, part);
                let named = said.repair.as_ref().map_or(&fault.part, |repair| &repair.part);
                if (span.part.as_ref()).is_some_and(|part| part_name(named) != *part) {
                    return Ok(());
                }
                let (kind, who): (String, String) = (row.get(1)?, row.get(2)?);
                let findings = row.get(8)?;
                let key = (row.get(0)?, kind.clone(), who.clone(), row.get(3)?);
                let of_case = together.entry(key).or_insert_with(|| LifeFault {
                    kind,
                    who,
                    note: said.note,
                    findings,
                    repair: said.repair,
                    cause: said.cause,
                    faults: Vec::new(),
                });
                if of_case.faults.iter().all(|known| known.id != fault.id) {
                    of_case.faults.push(fault);
                }
                Ok(())
            },
        )?;
        let events = together.into_iter().map(|((at_us, ..), fault)| LifeEvent {
            at_us,
            unit: span.serial.clone(),
            what: LifeWhat::Fault(Box::new(fault)),
        });
        Ok(events.collect())
    }
}
