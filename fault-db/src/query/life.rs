//! The life of a unit, a train or a part by its serial number: where it was, and everything stored about it in order of time.
//!
//! All three are lives of units in spans of time. A unit's own is one span without ends. A train's are the *stays* of units
//! in it: from the first run of a unit in the train to its first run in another one. A part's are the stays in units: from
//! the repair that put it in to the one that took it out; of the unit's faults only those count that come from a part of this
//! name.

use std::collections::BTreeMap;

use serde::Serialize;

use super::faults::json;
use super::filter::Conditions;
use super::note_filter::repaired_with;
use crate::backend::{SqlResult, values};
use crate::error::StoreError;
use crate::history::graph_sql::standing;
use crate::id::Id;
use crate::store::Store;
use crate::values::record::{
    CAUSE, CauseRecord, DIAGNOSED, REPAIR, RepairRecord, Verdict, part_name,
};
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

/// The life of what has a serial number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Life {
    /// Kind of the thing.
    pub of: LifeOf,
    /// The serial number.
    pub serial: String,
    /// Stays, oldest first: trains of a unit, units of a train, units of a part.
    pub stays: Vec<Stay>,
    /// Stored events, oldest first.
    pub events: Vec<LifeEvent>,
}

/// A time for which a unit was in a train, or a part in a unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stay {
    /// Serial number of the unit.
    pub unit: String,
    /// Number of the train, or name of the part.
    pub place: String,
    /// Since when; `None`: it was there before anything was stored.
    pub from_us: Option<i64>,
    /// End of the stay; `None`: it lasts.
    pub until_us: Option<i64>,
    /// Runs of the unit in this time.
    pub runs: u32,
}

/// Something that is stored about it.
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
    /// The train it was in; empty if not given.
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
    /// The repair, if it is one.
    pub repair: Option<RepairRecord>,
    /// The part it comes from, if it says that.
    pub cause: Option<CauseRecord>,
    /// The faults, of one case where they are several.
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
    /// The part it comes from, or points at.
    pub part: String,
}

/// A unit in a span of time.
struct Span {
    unit: i64,
    serial: String,
    from_us: i64,
    until_us: i64,
    /// Only what concerns the part of this name.
    part: Option<String>,
}

impl Store {
    /// The lives of everything that has this serial number: a unit, a train, a part; none if nothing has it.
    ///
    /// # Errors
    /// The file or the server cannot be read.
    pub fn lives(&self, serial: &str) -> Result<Vec<Life>, StoreError> {
        let read = || -> SqlResult<_> {
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
        };
        read().map_err(|error| self.failed("reading a life", error))
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

    /// The trains a unit was in, and its whole life.
    fn stays_of_unit(&self, serial: &str) -> SqlResult<(Vec<Stay>, Vec<Span>)> {
        let found = self.backend().first(
            "SELECT seq FROM unit WHERE serial = ?1",
            &values![serial],
            |row| row.get(0),
        )?;
        let Some(unit) = found else {
            return Ok((Vec::new(), Vec::new()));
        };
        let span = Span {
            unit,
            serial: serial.to_owned(),
            from_us: i64::MIN,
            until_us: i64::MAX,
            part: None,
        };
        Ok((self.trains_of(unit, serial)?, vec![span]))
    }

    /// The units that were in a train.
    fn stays_in_train(&self, train: &str) -> SqlResult<(Vec<Stay>, Vec<Span>)> {
        let units = self.backend().select(
            "SELECT DISTINCT u.seq, u.serial FROM run r JOIN unit u ON u.seq = r.unit
             WHERE r.train = ?1 AND r.train <> '' ORDER BY u.serial",
            &values![train],
            |row| Ok((row.get::<i64>(0)?, row.get::<String>(1)?)),
        )?;
        let (mut stays, mut spans) = (Vec::new(), Vec::new());
        for (unit, serial) in units {
            let in_trains = self.trains_of(unit, &serial)?.into_iter();
            for stay in in_trains.filter(|stay| stay.place == train) {
                // At its end the unit is in the next train already.
                let until_us = stay.until_us.map_or(i64::MAX, |until_us| until_us - 1);
                spans.push(Span {
                    unit,
                    serial: serial.clone(),
                    from_us: stay.from_us.unwrap_or(i64::MIN),
                    until_us,
                    part: None,
                });
                stays.push(stay);
            }
        }
        stays.sort_by_key(|stay| stay.from_us);
        Ok((stays, spans))
    }

    /// The trains a unit was in one after the other.
    fn trains_of(&self, unit: i64, serial: &str) -> SqlResult<Vec<Stay>> {
        let runs = self.backend().select(
            "SELECT r.train, r.started_at_us FROM run r WHERE r.unit = ?1 AND r.train <> ''
             ORDER BY r.started_at_us, r.id",
            &values![unit],
            |row| Ok((row.get::<String>(0)?, row.get::<i64>(1)?)),
        )?;
        let mut stays: Vec<Stay> = Vec::new();
        for (train, at_us) in runs {
            match stays.last_mut() {
                Some(last) if last.place == train => continue,
                Some(last) => last.until_us = Some(at_us),
                None => {}
            }
            stays.push(Stay {
                unit: serial.to_owned(),
                place: train,
                from_us: Some(at_us),
                until_us: None,
                runs: 0,
            });
        }
        Ok(stays)
    }

    /// The units a part was in, by the repairs that put it in and took it out.
    fn stays_of_part(&self, serial: &str) -> SqlResult<(Vec<Stay>, Vec<Span>)> {
        let mut all = Conditions::default();
        let faults = repaired_with(self.backend(), serial, &mut all);
        let sql = format!(
            "SELECT e.at_us, u.seq, u.serial, e.body
             FROM fault_event e JOIN fault f ON f.seq = e.fault JOIN unit u ON u.seq = f.unit
             WHERE e.kind = '{REPAIR}' AND e.fault IN ({faults}){} ORDER BY e.at_us, e.seq",
            standing!("e")
        );
        let repairs = self.backend().select(&sql, all.values(), |row| {
            let repair: RepairRecord = json(row, 3)?;
            Ok((
                row.get::<i64>(0)?,
                row.get::<i64>(1)?,
                row.get::<String>(2)?,
                repair,
            ))
        })?;
        let mut stays: Vec<(i64, Stay)> = Vec::new();
        for (at_us, unit, unit_serial, repair) in repairs {
            let is_it = |number: &Option<String>| number.as_deref() == Some(serial);
            let part = part_name(&repair.part);
            let is_open = |(in_unit, stay): &&mut (i64, Stay)| {
                *in_unit == unit && stay.place == part && stay.until_us.is_none()
            };
            let stay = |from_us, until_us| Stay {
                unit: unit_serial.clone(),
                place: part.clone(),
                from_us,
                until_us,
                runs: 0,
            };
            let ended_now = |(in_unit, stay): &(i64, Stay)| {
                *in_unit == unit && stay.place == part && stay.until_us == Some(at_us)
            };
            // A repair of a case is written at each of its faults, and says the same each time.
            if is_it(&repair.serial_old) && !stays.iter().any(ended_now) {
                match stays.iter_mut().rev().find(is_open) {
                    Some((_, open)) => open.until_us = Some(at_us),
                    None => stays.push((unit, stay(None, Some(at_us)))),
                }
            }
            if is_it(&repair.serial_new) && !stays.iter_mut().any(|stay| is_open(&stay)) {
                stays.push((unit, stay(Some(at_us), None)));
            }
        }
        let spans = stays.iter().map(|(unit, stay)| Span {
            unit: *unit,
            serial: stay.unit.clone(),
            from_us: stay.from_us.unwrap_or(i64::MIN),
            until_us: stay.until_us.unwrap_or(i64::MAX),
            part: Some(stay.place.clone()),
        });
        let spans = spans.collect();
        Ok((stays.into_iter().map(|(_, stay)| stay).collect(), spans))
    }

    fn runs_in(&self, stay: &Stay) -> SqlResult<u32> {
        let (from_us, until_us) = (
            stay.from_us.unwrap_or(i64::MIN),
            stay.until_us.unwrap_or(i64::MAX),
        );
        let counted = self.backend().first(
            "SELECT count(*) FROM run r JOIN unit u ON u.seq = r.unit
             WHERE u.serial = ?1 AND r.started_at_us >= ?2 AND r.started_at_us < ?3",
            &values![stay.unit.as_str(), from_us, until_us],
            |row| row.get(0),
        )?;
        Ok(counted.unwrap_or_default())
    }

    fn runs_of(&self, span: &Span) -> SqlResult<Vec<LifeEvent>> {
        self.backend().select(
            "SELECT r.started_at_us, r.id, r.verdict, r.operator, r.source, r.train,
                (SELECT count(DISTINCT o.fault) FROM fault_occurrence o WHERE o.run = r.seq)
             FROM run r WHERE r.unit = ?1 AND r.started_at_us >= ?2 AND r.started_at_us <= ?3
             ORDER BY r.started_at_us, r.id",
            &values![span.unit, span.from_us, span.until_us],
            |row| {
                Ok(LifeEvent {
                    at_us: row.get(0)?,
                    unit: span.serial.clone(),
                    what: LifeWhat::Run(LifeRun {
                        id: row.get(1)?,
                        verdict: row.get(2)?,
                        operator: row.get(3)?,
                        source: row.get(4)?,
                        train: row.get(5)?,
                        faults: row.get(6)?,
                    }),
                })
            },
        )
    }

    /// Events of faults in a span; what was written at several faults at once is one.
    fn fault_events_of(&self, span: &Span) -> SqlResult<Vec<LifeEvent>> {
        let mut together: BTreeMap<(i64, String, String, String), LifeFault> = BTreeMap::new();
        self.backend().each(
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
                let (kind, body): (String, String) = (row.get(1)?, row.get(3)?);
                let repair: Option<RepairRecord> =
                    (kind == REPAIR).then(|| json(row, 3)).transpose()?;
                let is_cause = matches!(&*kind, CAUSE | DIAGNOSED);
                let cause: Option<CauseRecord> = is_cause.then(|| json(row, 3)).transpose()?;
                let fault = NamedFault {
                    id: row.get(4)?,
                    code: row.get(5)?,
                    code_name: row.get(6)?,
                    part: row.get(7)?,
                };
                let named = repair.as_ref().map_or(&fault.part, |repair| &repair.part);
                if (span.part.as_ref()).is_some_and(|part| part_name(named) != *part) {
                    return Ok(());
                }
                let (at_us, who): (i64, String) = (row.get(0)?, row.get(2)?);
                let findings = row.get(8)?;
                let key = (at_us, kind.clone(), who.clone(), body.clone());
                let of_case = together.entry(key).or_insert_with(|| LifeFault {
                    note: match repair.is_some() || is_cause {
                        true => String::new(),
                        false => body,
                    },
                    findings,
                    kind,
                    who,
                    repair,
                    cause,
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
