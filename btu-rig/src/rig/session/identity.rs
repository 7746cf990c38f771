//! Comparison of the unit's identity with its train's record.

use std::sync::Arc;

use protocol::display_text;
use protocol::message::Identity;
use protocol::signal::{Sample, Signal};

/// What the depot's records say of the unit of a train.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitRecord {
    /// The train, as the depot names it.
    pub train: String,
    pub serial: String,
    /// Software version: major, minor, patch.
    pub software: [u8; 3],
    /// Name and CRC-32 of the unit configuration.
    pub config: (String, u32),
    /// CRC-32 of the track database.
    pub tdb_crc: u32,
}

/// What is known of the unit that should be there.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExpectedIdentity {
    /// Records of all trains.
    pub records: Arc<[UnitRecord]>,
    /// The train that the unit is in, as the tester says; without it the unit's serial number finds the record.
    pub train: Option<String>,
    /// Serial number as the tester says; it counts more than the record's.
    pub serial: Option<String>,
    /// Software version as the tester says; it counts more than the record's.
    pub software: Option<[u8; 3]>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Compared {
    signal: Signal,
    /// `None` = nothing says what it should be.
    same: Option<bool>,
    /// Both sides of the comparison, or why there is only one.
    said: String,
}

/// Compares a unit with its record once it has said who it is.
#[derive(Debug, Default)]
pub struct IdentityCheck {
    expected: ExpectedIdentity,
    compared: Vec<Compared>,
}

impl IdentityCheck {
    pub fn new(expected: ExpectedIdentity) -> Self {
        Self {
            expected,
            compared: Vec::new(),
        }
    }

    /// Takes what the unit says.
    pub fn on_identity(&mut self, identity: &Identity) {
        self.compared = self.expected.compare(identity).into();
    }

    /// Sets the signals of the comparisons; none before the unit has told its identity.
    pub fn record(&self, sample: &mut Sample) {
        for compared in &self.compared {
            let outcome = compared.same.map_or(2, u8::from);
            sample.set(compared.signal, f64::from(outcome));
        }
    }

    /// Both sides of the comparison behind a signal.
    pub fn said(&self, signal: Signal) -> Option<&str> {
        let compared = self.compared.iter().find(|one| one.signal == signal);
        compared.map(|one| one.said.as_str())
    }
}

impl ExpectedIdentity {
    /// The record of the train, or why there is none.
    fn record(&self, serial: &str) -> Result<&UnitRecord, String> {
        let find = |is_it: &dyn Fn(&&UnitRecord) -> bool| self.records.iter().find(is_it);
        match &self.train {
            Some(train) => find(&|record| record.train == *train)
                .ok_or_else(|| format!("train {train} has no record")),
            None => find(&|record| record.serial == serial).ok_or_else(|| {
                format!("no train's record names unit {serial}, and the train is not stated")
            }),
        }
        .map_err(|why| format!("nothing says what it should be: {why}"))
    }

    fn compare(&self, identity: &Identity) -> [Compared; 4] {
        let serial = text(&identity.serial);
        let record = self.record(&serial);
        let recorded = |said: fn(&UnitRecord) -> String| match &record {
            Ok(record) => Ok((
                format!("the record of train {}", record.train),
                said(record),
            )),
            Err(why) => Err(why.clone()),
        };
        let stated = |said: Option<String>, recorded| {
            said.map_or(recorded, |said| Ok(("the tester".to_owned(), said)))
        };
        let config = (text(&identity.config), identity.config_crc);
        [
            Compared::new(
                Signal::IdentitySerial,
                serial,
                stated(
                    self.serial.clone(),
                    recorded(|record| record.serial.clone()),
                ),
            ),
            Compared::new(
                Signal::IdentitySoftware,
                version(identity.software),
                stated(
                    self.software.map(version),
                    recorded(|record| version(record.software)),
                ),
            ),
            Compared::new(
                Signal::IdentityConfig,
                with_checksum(&config),
                recorded(|record| with_checksum(&record.config)),
            ),
            Compared::new(
                Signal::IdentityLine,
                checksum(identity.tdb_crc),
                recorded(|record| checksum(record.tdb_crc)),
            ),
        ]
    }
}

impl Compared {
    /// What the unit says beside what it should say, or why the latter is unknown.
    fn new(signal: Signal, unit: String, should: Result<(String, String), String>) -> Self {
        let (same, said) = match should {
            Ok((who, should)) => (
                Some(unit == should),
                format!("the unit says {unit}, {who} {should}"),
            ),
            Err(why) => (None, why),
        };
        Self { signal, same, said }
    }
}

pub fn version([major, minor, patch]: [u8; 3]) -> String {
    format!("{major}.{minor}.{patch}")
}

fn checksum(crc: u32) -> String {
    format!("{crc:08x}")
}

fn with_checksum((name, crc): &(String, u32)) -> String {
    format!("{name} {crc:08x}")
}

/// Bytes of a field of the identity before its first 0.
pub fn bytes_of(field: &[u8; 16]) -> &[u8] {
    field.split(|byte| *byte == 0).next().unwrap_or_default()
}

/// A field of the identity, in letters that can be seen.
fn text(field: &[u8; 16]) -> String {
    let text = String::from_utf8_lossy(bytes_of(field));
    display_text::line(&text).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(train: &str, serial: &str) -> UnitRecord {
        UnitRecord {
            train: train.into(),
            serial: serial.into(),
            software: [0, 1, 0],
            config: ("sg100".into(), 5),
            tdb_crc: 7,
        }
    }

    fn identity() -> Identity {
        let mut identity = Identity {
            software: [0, 1, 0],
            config_crc: 6,
            tdb_crc: 7,
            ..Identity::default()
        };
        identity.serial[..4].copy_from_slice(b"SG-1");
        identity.config[..5].copy_from_slice(b"sg100");
        identity
    }

    fn outcomes(expected: ExpectedIdentity) -> ([f64; 4], IdentityCheck) {
        let mut check = IdentityCheck::new(expected);
        let mut sample = Sample::default();
        check.record(&mut sample);
        assert_eq!(sample.get(Signal::IdentitySerial), None);
        check.on_identity(&identity());
        check.record(&mut sample);
        let signals = [
            Signal::IdentitySerial,
            Signal::IdentitySoftware,
            Signal::IdentityConfig,
            Signal::IdentityLine,
        ];
        let outcomes = signals.map(|signal| sample.get(signal).expect("compared"));
        (outcomes, check)
    }

    #[test]
    fn the_units_own_number_finds_its_record() {
        let (found, check) = outcomes(ExpectedIdentity {
            records: [record("301", "SG-0"), record("302", "SG-1")].into(),
            ..ExpectedIdentity::default()
        });
        assert_eq!(found, [1.0, 1.0, 0.0, 1.0]);
        assert_eq!(
            check.said(Signal::IdentityConfig),
            Some("the unit says sg100 00000006, the record of train 302 sg100 00000005")
        );
    }

    #[test]
    fn the_train_that_the_tester_names_finds_the_record_of_another_unit() {
        let (found, check) = outcomes(ExpectedIdentity {
            records: [record("301", "SG-0"), record("302", "SG-1")].into(),
            train: Some("301".into()),
            ..ExpectedIdentity::default()
        });
        assert_eq!(found, [0.0, 1.0, 0.0, 1.0]);
        assert_eq!(
            check.said(Signal::IdentitySerial),
            Some("the unit says SG-1, the record of train 301 SG-0")
        );
    }

    #[test]
    fn without_a_record_only_what_the_tester_says_is_compared() {
        let (found, check) = outcomes(ExpectedIdentity {
            records: [record("301", "SG-1")].into(),
            train: Some("999".into()),
            serial: None,
            software: Some([0, 2, 0]),
        });
        assert_eq!(found, [2.0, 0.0, 2.0, 2.0]);
        assert_eq!(
            check.said(Signal::IdentitySerial),
            Some("nothing says what it should be: train 999 has no record")
        );
        assert_eq!(
            check.said(Signal::IdentitySoftware),
            Some("the unit says 0.1.0, the tester 0.2.0")
        );
    }
}
