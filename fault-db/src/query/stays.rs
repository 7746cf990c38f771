//! The stays of units in trains and of parts in units, and the spans of time that they make of a life.

use serde::Serialize;

use super::faults::json;
use super::filter::Conditions;
use super::note_filter::repaired_with;
use crate::backend::{SqlResult, values};
use crate::history::graph_sql::standing;
use crate::store::Store;
use crate::values::record::{REPAIR, RepairRecord, part_name};

/// A time for which a unit was in a train, or a part in a unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stay {
    /// Serial number of the unit.
    pub unit: String,
    /// Number of the train, or name of the part.
    pub place: String,
    /// Start of the stay, µs since 1970; `None`: before anything was stored.
    pub from_us: Option<i64>,
    /// End of the stay, µs since 1970; `None`: the stay lasts.
    pub until_us: Option<i64>,
    /// Runs of the unit in this time.
    pub runs: u32,
}

/// A unit in a span of time.
pub(super) struct Span {
    pub unit: i64,
    pub serial: String,
    pub from_us: i64,
    pub until_us: i64,
    /// Restricts the span to what concerns the part of this name.
    pub part: Option<String>,
}

impl Store {
    /// The trains a unit was in, and the one span of its whole life.
    pub(super) fn stays_of_unit(&self, serial: &str) -> SqlResult<(Vec<Stay>, Vec<Span>)> {
        let found = self.backend.first(
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

    /// The stays of units in a train, with a span for each.
    pub(super) fn stays_in_train(&self, train: &str) -> SqlResult<(Vec<Stay>, Vec<Span>)> {
        let units = self.backend.select(
            "SELECT DISTINCT u.seq, u.serial FROM run r JOIN unit u ON u.seq = r.unit
             WHERE r.train = ?1 AND r.train <> '' ORDER BY u.serial",
            &values![train],
            |row| Ok((row.get::<i64>(0)?, row.get::<String>(1)?)),
        )?;
        let (mut stays, mut spans) = (Vec::new(), Vec::new());
        for (unit, serial) in units {
            let in_trains = self.trains_of(unit, &serial)?.into_iter();
            for stay in in_trains.filter(|stay| stay.place == train) {
                // The run at the end of the stay is the first in the next train.
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
        let runs = self.backend.select(
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

    /// The stays of a part in units, by the repairs that put it in and took it out, with a span for each.
    pub(super) fn stays_of_part(&self, serial: &str) -> SqlResult<(Vec<Stay>, Vec<Span>)> {
        let mut all = Conditions::default();
        let faults = repaired_with(&self.backend, serial, &mut all);
        let sql = format!(
            "SELECT e.at_us, u.seq, u.serial, e.body
             FROM fault_event e JOIN fault f ON f.seq = e.fault JOIN unit u ON u.seq = f.unit
             WHERE e.kind = '{REPAIR}' AND e.fault IN ({faults}){} ORDER BY e.at_us, e.seq",
            standing!("e")
        );
        let repairs = self.backend.select(&sql, all.values(), |row| {
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
            // A repair of a case is stored at each of its faults, each time with the same text.
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

    pub(super) fn runs_in(&self, stay: &Stay) -> SqlResult<u32> {
        let (from_us, until_us) = (
            stay.from_us.unwrap_or(i64::MIN),
            stay.until_us.unwrap_or(i64::MAX),
        );
        let counted = self.backend.first(
            "SELECT count(*) FROM run r JOIN unit u ON u.seq = r.unit
             WHERE u.serial = ?1 AND r.started_at_us >= ?2 AND r.started_at_us < ?3",
            &values![stay.unit.as_str(), from_us, until_us],
            |row| row.get(0),
        )?;
        Ok(counted.unwrap_or_default())
    }
}
