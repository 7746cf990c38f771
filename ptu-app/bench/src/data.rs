//! The scripts directory: procedures, unit configurations, lines and the fault catalogue.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use btu_rig::bench_scatter::BenchScatter;
use fault_db::read_regular_file;
use protocol::config::{UnitConfig, checksum};
use protocol::injection::{FaultCatalogue, FaultMode};
use protocol::line::{self, Line};
use sha2::{Digest, Sha256};

use crate::failure::{Failure, did_you_mean};
use crate::new_file::{NewFile, cannot_write};
use crate::owner_only;

/// Folder of unit configurations, the fault catalogue and the structure.
const UNITS: &str = "units";
/// The fault catalogue's name there.
const FAULTS: &str = "faults";
/// The name of the structure there.
const STRUCTURE: &str = "structure";
/// Longest script, data file or other text that is read, bytes.
pub const LONGEST_FILE: u64 = 4 << 20;
/// Longest all scripts together, bytes.
const LONGEST_SCRIPTS: usize = 64 << 20;
/// Most files and folders in the scripts directory.
const MOST_ENTRIES: usize = 100_000;
/// Folders within folders that are looked into.
const DEEPEST_FOLDER: usize = 16;
/// How good units, trains and benches differ, in the scripts directory.
pub const BENCH_SCATTER: &str = "bench_scatter.toml";

/// Where all data files are.
#[derive(Clone, Debug)]
pub struct ScriptsDirectory(PathBuf);

/// A data file's content and checksums.
#[derive(Clone, Debug)]
pub struct DataFile<T> {
    /// Name it was asked for by.
    pub name: String,
    /// What was changed in it from outside, `KEY=VALUE`, in order.
    pub settings: Vec<String>,
    /// The checked content.
    pub content: T,
    /// CRC-32 of the text, as the unit reports it; a line's leaves its own `checksum` line out.
    pub crc: u32,
    /// SHA-256 of the text, in hex.
    pub sha256: String,
}

impl ScriptsDirectory {
    /// The directory given, `PTU_SCRIPTS`, `./scripts`, or `scripts` above the program.
    ///
    /// # Errors
    /// None of them is there.
    pub fn find(given: Option<&Path>) -> Result<Self, Failure> {
        if let Some(directory) = given {
            return if directory.is_dir() {
                Ok(Self(directory.to_owned()))
            } else {
                Err(Failure::usage(format!(
                    "{} is not a directory",
                    directory.display()
                )))
            };
        }
        let program = std::env::current_exe().unwrap_or_default();
        std::iter::once(Path::new("."))
            .chain(program.ancestors())
            .map(|place| place.join("scripts"))
            .find(|directory| directory.join("units").is_dir())
            .map(Self)
            .ok_or_else(|| {
                Failure::usage(
                    "no scripts directory here or above the program; name it with --scripts",
                )
            })
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Text of every `.star` file by its path under this directory.
    ///
    /// # Errors
    /// A file or folder cannot be read.
    pub fn procedures(&self) -> Result<BTreeMap<String, String>, Failure> {
        let mut collecting = Collecting {
            root: &self.0,
            texts: BTreeMap::new(),
            bytes: 0,
            entries: 0,
        };
        collecting.collect(&self.0, 0)?;
        Ok(collecting.texts)
    }

    /// The unit configuration `units/NAME.toml`.
    ///
    /// # Errors
    /// There is none of that name, or it is wrong.
    pub fn unit_config(&self, name: &str) -> Result<DataFile<UnitConfig>, Failure> {
        self.load(UNITS, name, "unit configuration", UnitConfig::from_toml)
    }

    /// The line `lines/NAME.toml`.
    ///
    /// # Errors
    /// There is none of that name, or it is wrong.
    pub fn line(&self, name: &str) -> Result<DataFile<Line>, Failure> {
        let read = |text: &str| Line::from_toml(text).map(|line| (line, line::checksum(text)));
        let file = self.load("lines", name, "line", read)?;
        let (content, crc) = file.content;
        Ok(DataFile {
            name: file.name,
            settings: file.settings,
            content,
            crc,
            sha256: file.sha256,
        })
    }

    /// The catalogue of parts and fault modes.
    ///
    /// # Errors
    /// The file is missing or wrong.
    pub fn faults(&self) -> Result<FaultCatalogue, Failure> {
        let load = |text: &str| FaultCatalogue::from_toml(text);
        Ok(self.load(UNITS, FAULTS, "fault catalogue", load)?.content)
    }

    /// How good units, trains and benches differ: `bench_scatter.toml`, or a file given in its place.
    ///
    /// # Errors
    /// The file is missing or wrong.
    pub fn bench_scatter(&self, given: Option<&Path>) -> Result<BenchScatter, Failure> {
        let file = given.map_or_else(|| self.0.join(BENCH_SCATTER), Path::to_path_buf);
        BenchScatter::from_toml(&read(&file)?)
            .map_err(|error| Failure::usage(format!("{}: {error}", file.display())))
    }

    /// The fault modes of these names.
    ///
    /// # Errors
    /// One of them is not in the catalogue.
    pub fn chosen_faults(&self, names: &[String]) -> Result<Vec<FaultMode>, Failure> {
        if names.is_empty() {
            return Ok(Vec::new());
        }
        let catalogue = self.faults()?;
        let find = |name: &String| {
            catalogue.fault(name).cloned().ok_or_else(|| {
                let known = catalogue.faults.iter().map(|fault| fault.id.as_str());
                Failure::usage(format!(
                    "no fault \"{name}\"{}; `ptu catalog faults` lists them",
                    did_you_mean(name, known)
                ))
            })
        };
        names.iter().map(find).collect()
    }

    /// Names of the lines there are.
    pub fn line_names(&self) -> Vec<String> {
        self.names("lines")
    }

    /// Names of the unit configurations there are.
    pub fn unit_config_names(&self) -> Vec<String> {
        self.names(UNITS)
    }

    /// Names of the trains there are.
    pub fn train_names(&self) -> Vec<String> {
        self.names("trains")
    }

    /// Names of what `folder` holds; fault catalogue and structure, among unit configurations, are none of them.
    fn names(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.join(folder))
            .into_iter()
            .flatten()
            .flatten();
        let mut names: Vec<_> = entries
            .filter_map(|entry| entry.file_name().into_string().ok())
            .filter_map(|name| name.strip_suffix(".toml").map(str::to_owned))
            .filter(|name| folder != UNITS || ![FAULTS, STRUCTURE].contains(&name.as_str()))
            .collect();
        names.sort();
        names
    }

    /// The file `FOLDER/NAME.toml` as `parse` reads it; `what` it is called.
    ///
    /// # Errors
    /// There is none of that name, or it is wrong.
    pub(crate) fn load<T, E: Display>(
        &self,
        folder: &str,
        name: &str,
        what: &str,
        parse: impl FnOnce(&str) -> Result<T, E>,
    ) -> Result<DataFile<T>, Failure> {
        let file = self.0.join(folder).join(format!("{name}.toml"));
        if !file.exists() {
            let known = self.names(folder);
            return Err(Failure::usage(format!(
                "no {what} \"{name}\"{}; known: {}",
                did_you_mean(name, known.iter().map(String::as_str)),
                known.join(", ")
            )));
        }
        let text = read(&file)?;
        let content =
            parse(&text).map_err(|e| Failure::usage(format!("{}: {e}", file.display())))?;
        Ok(DataFile {
            name: name.to_owned(),
            settings: Vec::new(),
            content,
            crc: checksum(&text),
            sha256: sha256(&text),
        })
    }
}

/// SHA-256 of a text, in hex.
pub fn sha256(text: &str) -> String {
    Sha256::digest(text.as_bytes())
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// Reads a file, or says which one could not be read.
///
/// # Errors
/// The file cannot be read, is longer than scripts and data files are, or is not UTF-8.
pub fn read(file: &Path) -> Result<String, Failure> {
    read_within(file, LONGEST_FILE)
}

/// The same of a file of up to `most` bytes.
///
/// # Errors
/// As [`read`].
pub fn read_within(file: &Path, most: u64) -> Result<String, Failure> {
    let cannot =
        |why: &dyn Display| Failure::usage(format!("cannot read {}: {why}", file.display()));
    let bytes = read_regular_file(file, most).map_err(|error| cannot(&error))?;
    String::from_utf8(bytes).map_err(|_| cannot(&"it is not UTF-8"))
}

/// Finds out whether a file can be written, leaving what is there as it is.
///
/// # Errors
/// It cannot, and why.
pub fn check_writable(file: &Path) -> Result<(), Failure> {
    NewFile::begin(file).map(drop)
}

/// Writes a file whole: until it is, what stood there stays. Says which one could not be written.
///
/// # Errors
/// The file cannot be written.
pub fn write(file: &Path, content: impl AsRef<[u8]>) -> Result<(), Failure> {
    let mut new = NewFile::begin(file)?;
    new.write_all(content.as_ref())
        .map_err(|error| cannot_write(file, &error))?;
    new.finish()
}

/// Keeps a value as JSON in a file whose folder is made if need be: whole, or as it was.
///
/// # Errors
/// The file or its folder cannot be written.
pub fn keep(file: &Path, value: &impl serde::Serialize) -> Result<(), Failure> {
    let failed = |error: &dyn Display| cannot_write(file, error);
    if let Some(folder) = file.parent() {
        owner_only::folder(folder).map_err(|error| failed(&error))?;
    }
    let content = serde_json::to_vec_pretty(value).map_err(|error| failed(&error))?;
    let mut new = NewFile::begin(file)?;
    new.keep_to_owner()?;
    new.write_all(&content).map_err(|error| failed(&error))?;
    new.finish()
}

/// The scripts under a directory.
struct Collecting<'a> {
    root: &'a Path,
    texts: BTreeMap<String, String>,
    bytes: usize,
    entries: usize,
}

impl Collecting<'_> {
    fn collect(&mut self, folder: &Path, depth: usize) -> Result<(), Failure> {
        let cannot =
            |why: &dyn Display| Failure::usage(format!("cannot read {}: {why}", folder.display()));
        if depth > DEEPEST_FOLDER {
            return Err(cannot(
                &"too many folders within folders; does a link lead back?",
            ));
        }
        for entry in std::fs::read_dir(folder).map_err(|error| cannot(&error))? {
            let path = entry.map_err(|error| cannot(&error))?.path();
            self.entries += 1;
            if self.entries > MOST_ENTRIES {
                return Err(cannot(&format!(
                    "the scripts directory holds more than {MOST_ENTRIES} files and folders"
                )));
            }
            if path.is_dir() {
                self.collect(&path, depth + 1)?;
            } else if path.extension().is_some_and(|ending| ending == "star") {
                self.take(&path)?;
            }
        }
        Ok(())
    }

    fn take(&mut self, path: &Path) -> Result<(), Failure> {
        let text = read(path)?;
        self.bytes += text.len();
        if self.bytes > LONGEST_SCRIPTS {
            return Err(Failure::usage(format!(
                "the scripts in {} are longer than {LONGEST_SCRIPTS} bytes together",
                self.root.display()
            )));
        }
        let name = path.strip_prefix(self.root).unwrap_or(path);
        let name = name.to_string_lossy().replace('\\', "/");
        self.texts.insert(name, text);
        Ok(())
    }
}
