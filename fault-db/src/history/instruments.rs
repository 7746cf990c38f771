//! The register of the instruments of a bench: each entry is a statement in the file's own chain of seals, so no
//! earlier calibration is lost, and each may be signed.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::backend::{Backend, SqlResult, values};
use crate::error::StoreError;
use crate::history::limits;
use crate::id::Id;
use crate::seal::{append_statement, own_file_id};
use crate::store::Store;

/// The kind of the register's entries in the chain.
const INSTRUMENT: &str = "instrument";

/// An instrument as it was registered, or calibrated last.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Instrument {
    /// Kind of instrument: `bench`, `sound card`, `coil`, in the caller's words.
    pub kind: String,
    /// Serial number, by which the instrument is named.
    pub serial_no: String,
    /// Day of the calibration; `None`: never calibrated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibrated: Option<String>,
    /// Laboratory that calibrated the instrument, and number of the certificate.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub by: String,
    /// First day on which the calibration is no longer valid; `None`: it does not expire.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub due: Option<String>,
    /// Expanded uncertainty (k = 2) of the instrument's measurements, by unit of measurement.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub uncertainty: BTreeMap<String, f64>,
    /// The instrument was taken off the bench.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub retired: bool,
    /// When this entry was registered, µs since 1970.
    pub at_us: i64,
    /// Name of the person who registered the instrument.
    #[serde(default)]
    pub who: String,
}

impl Instrument {
    /// Whether the calibration is valid on a day (as 2026-11-26) by the bench's local date.
    pub fn is_calibrated_on(&self, day: &str) -> bool {
        self.calibrated.as_deref().is_some_and(|from| from <= day)
            && self.due.as_deref().is_none_or(|due| day < due)
    }
}

impl Store {
    /// Registers an instrument, or states again what is known of it.
    ///
    /// # Errors
    /// A text is too long, or the file does not take it.
    pub fn register_instrument(&self, instrument: &Instrument) -> Result<(), StoreError> {
        const DOING: &str = "registering an instrument";
        limits::name("the kind of the instrument", &instrument.kind)?;
        limits::name("the serial number", &instrument.serial_no)?;
        limits::name("who calibrated it", &instrument.by)?;
        limits::name("the name of who registers it", &instrument.who)?;
        let minted = self.mint()?;
        self.write(DOING, |_| {
            self.ask(DOING, |file| {
                let known = statements(file)?;
                let same =
                    (known.iter()).find(|(_, known)| known.serial_no == instrument.serial_no);
                let id = same.map_or(minted, |(id, _)| *id);
                append_statement(file, INSTRUMENT, id, instrument)
            })
        })
    }

    /// The instruments of this file's own bench, by serial number, as they were last registered; not those of merged
    /// files.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn instruments(&self) -> Result<Vec<Instrument>, StoreError> {
        let all = self.ask("reading the instruments", statements)?;
        let last: BTreeMap<String, Instrument> = (all.into_iter())
            .map(|(_, instrument)| (instrument.serial_no.clone(), instrument))
            .collect();
        Ok(last
            .into_values()
            .filter(|instrument| !instrument.retired)
            .collect())
    }
}

/// All statements about instruments of the file's own bench, in their order.
fn statements(file: &Backend) -> SqlResult<Vec<(Id, Instrument)>> {
    let Some(own) = own_file_id(file)? else {
        return Ok(Vec::new());
    };
    let sql =
        "SELECT id, says FROM seal WHERE origin = ?1 AND what = 'instrument' ORDER BY ordinal";
    let found = file.select(sql, &values![own], |row| {
        Ok((row.get::<Id>(0)?, row.get::<String>(1)?))
    })?;
    let read = |(id, says): (Id, String)| Some((id, serde_json::from_str(&says).ok()?));
    Ok(found.into_iter().filter_map(read).collect())
}
