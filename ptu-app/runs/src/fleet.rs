//! The depot's record of its trains, `fleet.toml`: which unit each one should have.

use std::collections::BTreeMap;
use std::sync::Arc;

use btu_rig::rig::UnitRecord;
use serde::Deserialize;

use crate::data::ScriptsDirectory;
use crate::failure::{Failure, FileTrouble, Why};
use crate::run::{check_serial, software_version};

/// The file's name in the scripts directory.
const FLEET: &str = "fleet.toml";

#[derive(Default, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FleetFile {
    #[serde(default)]
    trains: Vec<Train>,
}

#[derive(Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
struct Train {
    number: String,
    serial: String,
    software: String,
    unit_config: String,
    line: String,
}

/// All records, with the checksums of the files that they name; none if there is no such file.
///
/// # Errors
/// The file is wrong, a train or a unit stands in it twice, or a file that it names is missing or wrong.
pub fn unit_records(directory: &ScriptsDirectory) -> Result<Arc<[UnitRecord]>, Failure> {
    if !directory.has(FLEET) {
        return Ok(Arc::new([]));
    }
    let wrong = |why| Failure::usage(FileTrouble::Wrong(directory.shown(FLEET), why));
    let fleet: FleetFile =
        toml::from_str(&directory.text(FLEET)?).map_err(|error| wrong(Why::of(error)))?;
    let mut files = Files::default();
    let mut records: Vec<UnitRecord> = Vec::with_capacity(fleet.trains.len());
    for train in fleet.trains {
        let number = train.number.clone();
        let record = files.record(directory, train).map_err(|why| {
            why.because_of(FileTrouble::OfTrain(directory.shown(FLEET), number.clone()))
        })?;
        let twice = records
            .iter()
            .find(|other| other.train == record.train || other.serial == record.serial);
        if let Some(other) = twice {
            let (one, serial) = (&other.train, &other.serial);
            let why = match other.train == record.train {
                true => Why::TrainTwice(number),
                false => Why::UnitTwice(serial.clone(), one.clone(), number),
            };
            return Err(wrong(why));
        }
        records.push(record);
    }
    Ok(records.into())
}

/// Records of the units with this configuration and line, by their check sums: the units that an embedded unit can
/// stand for.
///
/// # Errors
/// As [`unit_records`].
pub fn records_of_embedded(
    directory: &ScriptsDirectory,
    config_crc: u32,
    line_crc: u32,
) -> Result<Arc<[UnitRecord]>, Failure> {
    let records = unit_records(directory)?;
    let fits = |record: &&UnitRecord| record.config.1 == config_crc && record.tdb_crc == line_crc;
    Ok(records.iter().filter(fits).cloned().collect())
}

/// Checksums of the files named so far.
#[derive(Default)]
struct Files {
    configs: BTreeMap<String, (String, u32)>,
    lines: BTreeMap<String, u32>,
}

impl Files {
    fn record(
        &mut self,
        directory: &ScriptsDirectory,
        train: Train,
    ) -> Result<UnitRecord, Failure> {
        if !self.configs.contains_key(&train.unit_config) {
            let config = directory.unit_config(&train.unit_config)?;
            let named = (config.content.name, config.crc);
            self.configs.insert(train.unit_config.clone(), named);
        }
        if !self.lines.contains_key(&train.line) {
            let crc = directory.line(&train.line)?.crc;
            self.lines.insert(train.line.clone(), crc);
        }
        if train.number.trim().is_empty() {
            return Err(Failure::usage(FileTrouble::NoTrainNumber));
        }
        check_serial(&train.serial)?;
        Ok(UnitRecord {
            software: software_version(&train.software).map_err(Failure::usage)?,
            config: self.configs[&train.unit_config].clone(),
            tdb_crc: self.lines[&train.line],
            train: train.number,
            serial: train.serial,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::scripts;

    fn records(fleet: &str) -> Result<Arc<[UnitRecord]>, Failure> {
        let folder = tempfile::tempdir().expect("a folder");
        for part in ["units", "lines"] {
            std::fs::create_dir(folder.path().join(part)).expect("a folder");
        }
        for file in ["units/sg100.toml", "lines/line8.toml"] {
            let text = scripts().text(file).expect("read");
            std::fs::write(folder.path().join(file), text).expect("written");
        }
        std::fs::write(folder.path().join(FLEET), fleet).expect("written");
        let directory = ScriptsDirectory::find(Some(folder.path()))?;
        unit_records(&directory)
    }

    fn train(number: &str, serial: &str, software: &str, config: &str) -> String {
        format!(
            "[[trains]]\nnumber = \"{number}\"\nserial = \"{serial}\"\nsoftware = \"{software}\"\n\
             unit_config = \"{config}\"\nline = \"line8\"\n"
        )
    }

    #[test]
    fn a_record_has_the_checksums_of_the_files_it_names() {
        let read = records(&train("301", "SG-1", "0.1.0", "sg100")).expect("records");
        let config = scripts().unit_config("sg100").expect("a configuration");
        assert_eq!(
            read[..],
            [UnitRecord {
                train: "301".into(),
                serial: "SG-1".into(),
                software: [0, 1, 0],
                config: (config.content.name, config.crc),
                tdb_crc: scripts().line("line8").expect("a line").crc,
            }]
        );
    }

    #[test]
    fn a_wrong_record_is_named() {
        let good = train("301", "SG-1", "0.1.0", "sg100");
        for (other, said) in [
            (
                train("301", "SG-2", "0.1.0", "sg100"),
                "train 301 stands in it twice",
            ),
            (
                train("302", "SG-1", "0.1.0", "sg100"),
                "unit SG-1 stands in it for trains 301 and 302",
            ),
            (
                train("302", "SG-2", "0.1", "sg100"),
                "train 302: \"0.1\" is not a version",
            ),
            (
                train("302", "SG-2", "0.1.0", "sg10"),
                "train 302: no unit configuration \"sg10\"",
            ),
            (train("", "SG-2", "0.1.0", "sg100"), "its number is empty"),
            (
                train("302", "", "0.1.0", "sg100"),
                "train 302: a serial number is 1 to 16",
            ),
            ("[[train]]\n".to_owned(), "train"),
        ] {
            let failure = records(&format!("{good}{other}")).expect_err("refused");
            assert!(failure.to_string().contains(said), "{failure}");
        }
    }
}
