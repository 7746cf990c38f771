//! The files and settings a fault dictionary was made from, so that an outdated dictionary is recognised.

use std::collections::BTreeMap;

use btu_rig::procedure::plan::Connection;
use diagnosis::{Basis, Settings};

use crate::data::{BENCH_SCATTER, ScriptsDirectory, sha256};
use crate::failure::{Failure, FileTrouble};

/// The bench that dictionaries are made on.
pub const UNIT_CONFIG: &str = "sg100";
pub const LINE: &str = "line8";
pub const TRAIN: &str = "line6";

/// Files besides procedures that decide what a fault does, under the scripts directory.
const FILES: [&str; 5] = [
    "units/sg100.toml",
    "units/faults.toml",
    "lines/line8.toml",
    "trains/line6.toml",
    BENCH_SCATTER,
];

/// The basis of a dictionary that would be made now on this connection.
///
/// # Errors
/// A file cannot be read.
pub fn basis(directory: &ScriptsDirectory, connection: Connection) -> Result<Basis, Failure> {
    Ok(Contents::read(directory)?.basis(connection, |_| true))
}

/// Checksums of what the scripts directory holds now.
pub struct Contents {
    procedures: BTreeMap<String, String>,
    files: [String; FILES.len()],
}

impl Contents {
    /// Reads all.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn read(directory: &ScriptsDirectory) -> Result<Self, Failure> {
        let mut procedures = BTreeMap::new();
        for (path, text) in directory.procedures()? {
            procedures.insert(path, sha256(&text));
        }
        let mut files = [const { String::new() }; FILES.len()];
        for (sum, name) in files.iter_mut().zip(FILES) {
            *sum = sha256(&directory.text(name)?);
        }
        Ok(Self { procedures, files })
    }

    /// Whether the dictionary was made of what there is now. A procedure that the dictionary does not know came later,
    /// and does not change what the others show.
    pub fn hold(&self, dictionary: &Basis, connection: Connection) -> bool {
        let known = |name: &str| dictionary.procedures.contains_key(name);
        self.basis(connection, known).sha256 == dictionary.sha256
    }

    /// The basis of a dictionary that would be made now of the procedures that count.
    pub fn basis(&self, connection: Connection, is_counted: impl Fn(&str) -> bool) -> Basis {
        let mut all = format!("version {}\n", env!("CARGO_PKG_VERSION"));
        if connection == Connection::Ptu {
            all += "maintenance port alone\n";
        }
        let mut procedures = BTreeMap::new();
        for (path, sum) in &self.procedures {
            let name = path.trim_end_matches(".star");
            if is_counted(name) {
                all += &format!("{path} {sum}\n");
                procedures.insert(name.to_owned(), sum.clone());
            }
        }
        let mut unit_config_sha256 = String::new();
        for (name, sum) in FILES.iter().zip(&self.files) {
            all += &format!("{name} {sum}\n");
            if name.contains(UNIT_CONFIG) {
                unit_config_sha256.clone_from(sum);
            }
        }
        Basis {
            sha256: sha256(&all),
            unit_config_sha256,
            procedures,
            line: LINE.into(),
            train: TRAIN.into(),
            connection: connection.word().into(),
            app_version: env!("CARGO_PKG_VERSION").into(),
        }
    }
}

/// Priors and thresholds, `diagnosis.toml` in the scripts directory.
///
/// # Errors
/// It cannot be read, or is wrong.
pub fn settings(directory: &ScriptsDirectory) -> Result<Settings, Failure> {
    let file = "diagnosis.toml";
    let wrong = |what: String| Failure::usage(FileTrouble::wrong(directory.shown(file), what));
    let settings: Settings =
        toml::from_str(&directory.text(file)?).map_err(|error| wrong(error.to_string()))?;
    settings.check().map_err(wrong)?;
    Ok(settings)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHIPPED: &str = include_str!("../../../../scripts/diagnosis.toml");

    #[test]
    fn the_shipped_settings_are_the_defaults_and_a_file_without_tables_has_them() {
        let flat = SHIPPED.split("[likelihood]").next().expect("a beginning");
        for text in [SHIPPED, flat, &format!("{flat}[log]\nstray = 0.02\n")] {
            let settings: Settings = toml::from_str(text).expect("settings");
            assert_eq!(settings, Settings::default());
            assert_eq!(settings.check(), Ok(()));
        }
    }

    #[test]
    fn a_setting_out_of_range_is_named_with_its_table() {
        for (from, to, said) in [
            ("stray = 0.02", "stray = 1.5", "log.stray = 1.5"),
            (
                "most_shown = 10",
                "most_shown = 0",
                "conclusion.most_shown = 0",
            ),
            ("failed = 0.35", "failed = 0.30", "do not make 1"),
        ] {
            let text = SHIPPED.replace(from, to);
            let settings: Settings = toml::from_str(&text).expect("settings");
            let wrong = settings.check().expect_err("out of range");
            assert!(wrong.contains(said), "{wrong}");
        }
    }
}
