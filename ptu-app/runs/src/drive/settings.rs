//! Unit configuration keys set from the command line, before the configuration is checked.

use std::fmt::{self, Display};
use std::str::FromStr;

use protocol::config::{UnitConfig, checksum};
use serde::Deserialize;
use toml::{Table, Value};

use crate::data::sha256;
use crate::data::{DataFile, ScriptsDirectory};
use crate::failure::{Failure, RunTrouble, did_you_mean};

/// One key and its new value.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The key that is set.
    pub key: String,
    value: Value,
    /// The value as it was given.
    text: String,
}

impl Setting {
    /// `key` set to `value`, TOML or a plain text.
    pub fn new(key: &str, value: impl Display) -> Self {
        let text = value.to_string();
        let parsed = Table::from_str(&format!("value = {text}"));
        let value = parsed
            .ok()
            .and_then(|mut table| table.remove("value"))
            .unwrap_or_else(|| Value::String(text.clone()));
        Self {
            key: key.into(),
            value,
            text,
        }
    }

    fn apply(&self, table: &mut Table) -> Result<(), String> {
        let known = keys(table);
        let unknown = || {
            let near = did_you_mean(&self.key, known.iter().map(String::as_str));
            format!("no key \"{}\" in the unit configuration{near}", self.key)
        };
        let mut path = self.key.split('.');
        let last = path.next_back().unwrap_or_default();
        let mut place = table;
        for part in path {
            place = place
                .get_mut(part)
                .and_then(Value::as_table_mut)
                .ok_or_else(unknown)?;
        }
        let old = place.get_mut(last).ok_or_else(unknown)?;
        if old.is_table() {
            return Err(format!(
                "\"{}\" is a whole table; name a key in it",
                self.key
            ));
        }
        *old = self.value.clone();
        Ok(())
    }
}

impl Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.text)
    }
}

impl FromStr for Setting {
    type Err = RunTrouble;

    /// `KEY=VALUE`; what is no TOML value is a text.
    fn from_str(text: &str) -> Result<Self, RunTrouble> {
        let (key, value) = text.split_once('=').ok_or(RunTrouble::NoSetting)?;
        Ok(Self::new(key.trim(), value.trim()))
    }
}

/// The unit configuration `name` with `settings` in place of what its file says. The checksum is of
/// both.
///
/// # Errors
/// There is no such configuration or key, or the result is wrong.
pub fn unit_config(
    directory: &ScriptsDirectory,
    name: &str,
    settings: &[Setting],
) -> Result<DataFile<UnitConfig>, Failure> {
    if settings.is_empty() {
        return directory.unit_config(name);
    }
    let mut text_used = String::new();
    let file = directory.load("units", name, "unit configuration", |text| {
        text_used = std::iter::once(text.to_owned())
            .chain(settings.iter().map(ToString::to_string))
            .collect::<Vec<_>>()
            .join("\n");
        edited(text, settings)
    })?;
    Ok(DataFile {
        settings: settings.iter().map(ToString::to_string).collect(),
        crc: checksum(&text_used),
        sha256: sha256(&text_used),
        ..file
    })
}

fn edited(text: &str, settings: &[Setting]) -> Result<UnitConfig, String> {
    let mut table = Table::from_str(text).map_err(|error| error.to_string())?;
    for setting in settings {
        setting.apply(&mut table)?;
    }
    let config = UnitConfig::deserialize(table).map_err(|error| error.to_string())?;
    config.check().map_err(|error| error.to_string())?;
    Ok(config)
}

/// Full names of all keys, in order.
fn keys(table: &Table) -> Vec<String> {
    table
        .iter()
        .flat_map(|(name, value)| match value {
            Value::Table(inner) => keys(inner)
                .into_iter()
                .map(|k| format!("{name}.{k}"))
                .collect(),
            _ => vec![name.clone()],
        })
        .collect()
}
