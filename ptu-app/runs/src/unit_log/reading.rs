//! One reading of a unit on a port, for command line and window: opened, read, held against what was expected.

use fault_db::{Store, limits};
use protocol::Instant;

use super::{
    Entry, Imported, JudgedLog, LogRead, Source, against_history, import, judge, read_log,
};
use crate::clock::{ClockState, now_us};
use crate::data::ScriptsDirectory;
use crate::failure::{Failure, FieldTrouble};
use crate::link::{Endpoint, WireLink};
use crate::run::unit_text;
use crate::stop::Stop;

/// The unit that is asked for, and what it should be.
#[derive(Clone, Debug)]
pub struct AskedUnit {
    pub endpoint: Endpoint,
    /// Serial number that the unit should have.
    pub serial: Option<String>,
    /// Unit configuration of the unit, `units/NAME.toml`.
    pub unit_config: String,
    /// Line of the unit, `lines/NAME.toml`.
    pub line: String,
    /// Train that carries the unit, as the depot names it.
    pub train: String,
    /// Name of the person who reads.
    pub operator: String,
}

#[derive(Clone, Debug)]
pub struct UnitReading {
    pub read: LogRead,
    pub source: Source,
    /// State of this computer's clock when the log was read.
    pub clock: ClockState,
    pub warnings: Vec<String>,
}

/// A log and what became of it.
#[derive(Clone, Debug)]
pub struct ImportedLog {
    /// Faults, and why other entries are none.
    pub judged: JudgedLog,
    pub imported: Imported,
}

/// The stored name of a unit configuration that is not known here.
const UNKNOWN_CONFIG: &str = "unknown";

impl AskedUnit {
    /// Reads the unit's log; with `rows`, its stored run record, too.
    ///
    /// # Errors
    /// A name is wrong, the unit is not reached, or it is another one.
    pub fn read(
        &self,
        directory: &ScriptsDirectory,
        rows: bool,
        stop: &Stop,
    ) -> Result<UnitReading, Failure> {
        self.check()?;
        let config = directory.unit_config(&self.unit_config)?;
        let line = directory.line(&self.line)?;
        let from_us = now_us();
        let clock = ClockState::now();
        let mut link = WireLink::open(&self.endpoint)?;
        let mut pace = self.endpoint.pace(1);
        let read = read_log(
            &mut link,
            Instant::ZERO,
            rows,
            &mut pace,
            stop,
            (&now_us, clock.uncertainty_ms()),
        );
        let read =
            read.map_err(|why| Failure::bench(FieldTrouble::NotRead(self.endpoint.clone(), why)))?;
        let identity = &read.identity;
        unit_text::check_expected(&self.endpoint, identity, self.serial.as_deref())?;
        let mut warnings = Vec::new();
        if identity.tdb_crc != line.crc {
            warnings.push(format!(
                "the unit's track database is not that of {}; name its line with --line",
                line.name
            ));
        }
        let same_config = identity.config_crc == config.crc;
        if !same_config {
            warnings.push(format!(
                "the unit's configuration, {}, is not {} as it is here; name its own with --unit-config",
                unit_text::config_name(identity),
                config.name
            ));
        }
        warnings.extend(of_reading(&read));
        if clock == ClockState::NotSynchronised {
            warnings.push(
                "this computer's clock is not set by the network: dates by it may be wrong by any time; let it be \
                 set, and read again"
                    .to_owned(),
            );
        }
        let source = Source {
            endpoint: self.endpoint.to_string(),
            config_name: known_config(directory, unit_text::config_name(identity)),
            unit_config_sha256: if same_config {
                config.sha256
            } else {
                String::new()
            },
            line: line.content.name.clone(),
            train: self.train.clone(),
            operator: self.operator.clone(),
            from_us,
            until_us: now_us(),
            broken_off: read.broken_off.is_some(),
            serial: unit_text::serial(identity),
        };
        Ok(UnitReading {
            read,
            source,
            clock,
            warnings,
        })
    }

    fn check(&self) -> Result<(), Failure> {
        match &self.endpoint {
            Endpoint::Sim => return Err(Failure::usage(FieldTrouble::Simulated)),
            Endpoint::LockStep(_) => return Err(Failure::usage(FieldTrouble::LockStep)),
            Endpoint::Serial { .. } | Endpoint::Tcp(_) => {}
        }
        limits::name("the operator's name", &self.operator)?;
        limits::name("the train's name", &self.train)?;
        Ok(())
    }
}

impl UnitReading {
    /// Stores the faults of the log that are new; entries that are surely older than `since_us` are left out.
    ///
    /// # Errors
    /// The database fails.
    pub fn import(&mut self, store: &Store, since_us: Option<i64>) -> Result<ImportedLog, Failure> {
        if let Some(stored) = &self.read.stored {
            self.warnings
                .extend(against_history(store, &self.source.serial, stored)?);
        }
        let tested = store.tested_spans(&self.source.serial)?;
        let judged = judge(&self.read.entries, &tested, since_us);
        let is_unsure = |entry: &&Entry| {
            let date = entry.at_us.zip(since_us);
            !entry.is_sure && date.is_some_and(|(at_us, since_us)| at_us < since_us)
        };
        let unsure = judged.faults.iter().filter(is_unsure).count();
        if unsure > 0 {
            self.warnings.push(format!(
                "{unsure} faults are dated before the time asked for by a clock that is not known to be right: they \
                 are not left out"
            ));
        }
        let imported = import(store, &self.source, &judged.faults)?;
        Ok(ImportedLog { judged, imported })
    }

    /// Checks that all was read.
    ///
    /// # Errors
    /// Reading ended before; the error says why.
    pub fn complete(&self) -> Result<(), Failure> {
        match &self.read.broken_off {
            None => Ok(()),
            Some(why) => Err(Failure::bench(FieldTrouble::NotWhole(why.clone()))),
        }
    }
}

/// Name of the unit's configuration if it is known here; else a word for an unknown one.
fn known_config(directory: &ScriptsDirectory, told: String) -> String {
    match directory.unit_config_names().contains(&told) {
        true => told,
        false => UNKNOWN_CONFIG.to_owned(),
    }
}

/// Warnings about a read log.
fn of_reading(read: &LogRead) -> Vec<String> {
    let mut warnings = Vec::new();
    if read.overwritten > 0 {
        warnings.push(format!(
            "{} entries were overwritten or cleared in the unit before they could be read",
            read.overwritten
        ));
    }
    let is_undated = |entry: &&Entry| entry.at_us.is_none();
    let undated = read.entries.iter().filter(is_undated).count();
    if undated > 0 && read.stored.is_some() {
        warnings.push(format!(
            "{undated} entries are of power-ups in which the unit was not given the time: they have the power-up and \
             the time since then, and stand under the date that they are not later than"
        ));
    } else if undated > 0 {
        warnings.push(format!(
            "{undated} entries are of an earlier power-up, which nothing dates: they stand under the \
             time of reading"
        ));
    }
    if read.restarts > 0 {
        warnings.push("the unit was started again while its log was read".to_owned());
    }
    match &read.stored {
        Some(stored) => warnings.extend(stored.notes.iter().cloned()),
        None => warnings.push(
            "this unit has no stored log: it was read as far as it is kept since power-up"
                .to_owned(),
        ),
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::scripts;

    /// Goal: a name that a unit gives is stored, and later looked up, only if it is shipped. Method: names that lead
    /// to other files, one of which is there.
    #[test]
    fn a_configuration_that_is_not_shipped_is_unknown() {
        let scripts = scripts();
        assert!(scripts.has("units/../fleet.toml"));
        for told in [
            "../../etc/x",
            "../fleet",
            "/etc/x",
            "units/sg100",
            "sg100.toml",
            "SG100",
            "faults",
            "",
        ] {
            assert_eq!(
                known_config(&scripts, told.to_owned()),
                UNKNOWN_CONFIG,
                "{told}"
            );
        }
        assert_eq!(known_config(&scripts, "sg100".to_owned()), "sg100");
    }
}
