//! Stores faults of a unit's log that are new to the history, as a run without steps.

use btu_rig::procedure::UnitEvent;
use fault_db::{
    FaultRecord, FreezeSample, Id, LOG_SOURCE, RunEnd, RunRecord, RunWriter, Store, StoreError,
    Verdict,
};
use protocol::Instant;
use protocol::signal::{Sample, Signal};

use super::read::{Entry, StoredPlace, StoredRead};
use crate::run::of_event;
use crate::stored::{fault_record, new_run};

/// Name of the freeze-frame sample with the power-up of an entry.
const POWER_UP: &str = "power_up";

/// Data of a reading that are stored beside its entries.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// Where the unit is: `serial:…`, `tcp:…`.
    pub endpoint: String,
    pub serial: String,
    /// Name of the unit configuration.
    pub config_name: String,
    /// SHA-256 of the configuration in hex; empty where the file is not at hand.
    pub unit_config_sha256: String,
    pub line: String,
    /// Name of the person who reads.
    pub operator: String,
    /// The train the unit is in, as the tester names it; empty if not given.
    pub train: String,
    /// When reading began, µs UTC.
    pub from_us: i64,
    /// When reading ended, µs UTC.
    pub until_us: i64,
    /// The link failed before the whole log was read.
    pub broken_off: bool,
}

impl Source {
    /// End of the run that a reading is stored as: a whole reading has the verdict `of_whole`, one that broke off is an
    /// error.
    pub(crate) fn end(&self, of_whole: Verdict) -> RunEnd {
        RunEnd {
            verdict: match self.broken_off {
                true => Verdict::Error,
                false => of_whole,
            },
            finished_at_us: self.until_us,
            bench_time_us: 0,
            wall_time_us: self.until_us - self.from_us,
        }
    }
}

/// Result of storing the faults of a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Imported {
    /// The run they are stored as; none when nothing is new.
    pub run: Option<Id>,
    /// New faults, in order.
    pub new: Vec<FaultRecord>,
    /// Number of faults that were stored before.
    pub known: usize,
}

/// Stores those of `faults` that the history does not have.
///
/// # Errors
/// The database fails; what was stored stays, and the next import adds the rest.
pub fn import(store: &Store, source: &Source, faults: &[Entry]) -> Result<Imported, StoreError> {
    let mut imported = Imported::default();
    let mut ids = Vec::new();
    for entry in faults {
        let record = record(entry, source.until_us);
        let what = (record.code, record.message.as_str());
        let id = entry
            .stored
            .map(|place| entry_id(&source.serial, entry, place));
        let is_known = match id {
            Some(id) if store.has_occurrence(id)? => true,
            // The fault may have been seen in a run; without a date only the id tells.
            Some(_) if entry.at_us.is_none() => false,
            _ => store.knows_occurrence(&source.serial, what, entry.at_us)?,
        };
        if is_known {
            imported.known += 1;
        } else {
            imported.new.push(record);
            ids.push(id);
        }
    }
    if imported.new.is_empty() {
        return Ok(imported);
    }
    let mut writer = RunWriter::begin(store, &run_record(source))?;
    for (record, id) in imported.new.iter().zip(ids) {
        match id {
            Some(id) => writer.logged_fault(id, record)?,
            None => writer.fault(record)?,
        };
    }
    writer.finish(&source.end(Verdict::Failed))?;
    imported.run = Some(writer.id());
    Ok(imported)
}

/// Id of the fault, equal on every laptop: made from the unit's serial number, power-up, number and content of the
/// entry. The content counts because a unit whose flash was exchanged numbers from the start again.
fn entry_id(serial: &str, entry: &Entry, place: StoredPlace) -> Id {
    let event = &entry.event;
    let parts = [
        serial.as_bytes(),
        &place.power_up.to_be_bytes(),
        &place.sequence.to_be_bytes(),
        &event.at_ms.to_be_bytes(),
        &event.code.to_be_bytes(),
        &event.parameter.to_be_bytes(),
    ];
    Id::of_content("unit log entry", &parts)
}

/// Note on the unit's stored memory, compared with earlier imports.
///
/// # Errors
/// The database fails.
pub fn against_history(
    store: &Store,
    serial: &str,
    read: &StoredRead,
) -> Result<Option<String>, StoreError> {
    let frozen = store.last_logged(serial)?;
    let frozen = frozen.and_then(|json| serde_json::from_str::<Vec<FreezeSample>>(&json).ok());
    let samples = frozen.unwrap_or_default();
    let before = samples.iter().find(|sample| sample.name == POWER_UP);
    let before = before.and_then(|sample| sample.value).unwrap_or(0.0);
    Ok((f64::from(read.power_up) < before).then(|| {
        format!(
            "the unit counts {} power-ups and had counted {before} before: its memory was exchanged or erased; \
             what was imported before is kept",
            read.power_up
        )
    }))
}

/// The run that a reading is stored as.
pub(crate) fn run_record(source: &Source) -> RunRecord {
    let (serial, config_name) = (source.serial.clone(), source.config_name.clone());
    let place = format!("{LOG_SOURCE}{}", source.endpoint);
    RunRecord {
        line: source.line.clone(),
        train: source.train.clone(),
        operator: source.operator.clone(),
        unit_config_sha256: source.unit_config_sha256.clone(),
        ..new_run(serial, config_name, place, source.from_us)
    }
}

/// The entry as a run would have stored it, on the unit's own clock, with the signals that the entry froze.
fn record(entry: &Entry, read_at_us: i64) -> FaultRecord {
    let event = &entry.event;
    let at = Instant::from_ms(u64::from(event.at_ms));
    let mut fault = of_event(event, at, &frozen(event));
    let freeze = &mut fault.freeze;
    freeze.retain(|sample| sample.value.is_some());
    let number = |name: &str, value: f64, unit: &str| FreezeSample {
        name: name.into(),
        value: Some(value),
        unit: unit.into(),
        label: None,
    };
    let dated_by = match (entry.at_us, entry.stored) {
        (Some(_), None) => "the unit's clock".to_owned(),
        (Some(_), Some(place)) => {
            let within = place.uncertainty_us.map_or_else(
                || "by a clock that is not known to be right".to_owned(),
                |us| format!("within {:.1} s", us as f64 / 1e6),
            );
            format!(
                "the unit's clock, as it was told in power-up {}, {within}",
                place.power_up
            )
        }
        (None, None) => "the time of reading".to_owned(),
        (None, Some(place)) => format!(
            "power-up {} and {:.3} s after it, when the unit had not been given the time: not later than this date",
            place.power_up,
            f64::from(event.at_ms) / 1000.0
        ),
    };
    if let Some(place) = entry.stored {
        freeze.extend([
            number(POWER_UP, f64::from(place.power_up), ""),
            number("log_sequence", f64::from(place.sequence), ""),
        ]);
    }
    freeze.extend([
        FreezeSample {
            label: Some(event.said()).filter(|said| !said.is_empty()),
            ..number("parameter", f64::from(event.parameter), "")
        },
        number("log_index", f64::from(event.index), ""),
        number("unit_time", f64::from(event.at_ms) / 1000.0, "s"),
        FreezeSample {
            name: "dated_by".into(),
            value: None,
            unit: String::new(),
            label: Some(dated_by),
        },
    ]);
    let not_after_us = entry.stored.and_then(|place| place.not_after_us);
    let at_us = entry.at_us.or(not_after_us).unwrap_or(read_at_us);
    let bench_us = fault.at.as_us() as i64;
    fault_record(fault, at_us, bench_us, None)
}

/// Signals that an entry has values of.
fn frozen(event: &UnitEvent) -> Sample {
    let mut sample = Sample::default();
    sample.set(Signal::Speed, event.speed.kmh());
    sample.set(Signal::Limit, event.limit.kmh());
    sample.set(Signal::Position, event.position_m);
    sample.set(Signal::Mode, f64::from(event.mode.code()));
    sample.set(Signal::EbCause, f64::from(event.eb_cause.code()));
    sample
}

#[cfg(test)]
mod tests;
