//! The scripts directory: procedures, unit configurations, lines and the fault catalogue, from the places that
//! `script_files` looks in.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::Path;

use btu_rig::bench_scatter::BenchScatter;
use btu_rig::train::TrainData;
use fault_db::read_regular_file;
use protocol::config::{UnitConfig, checksum};
use protocol::injection::{FaultCatalogue, FaultMode};
use protocol::line::{self, Line};
use script_files::{Found, Layer, ScriptFiles};
use sha2::{Digest, Sha256};

use crate::failure::{Failure, FileTrouble, Unknown, Why, did_you_mean};
use crate::places::{Model, Places};
use crate::signal::unheard;
use crate::whole_file::{LONGEST_FILE, cannot_read, read};

/// Folder of unit configurations, the fault catalogue and the structure.
const UNITS: &str = "units";
/// Folder of drivers of instruments.
const INSTRUMENTS: &str = "instruments";
/// Name of the fault catalogue in folder [`UNITS`].
const FAULTS: &str = "faults";
/// Name of the structure in folder [`UNITS`].
const STRUCTURE: &str = "structure";
/// Most bytes of all scripts together.
const LONGEST_SCRIPTS: usize = 64 << 20;
/// File of the scripts directory that says how good units, trains and benches differ.
pub const BENCH_SCATTER: &str = "bench_scatter.toml";

/// Places of all data files; a file is named by its path in a place, `units/sg100.toml`.
#[derive(Clone, Debug)]
pub struct ScriptsDirectory(ScriptFiles);

/// A data file's content and checksums.
#[derive(Clone, Debug)]
pub struct DataFile<T> {
    pub name: String,
    /// Changes to the file from outside, `KEY=VALUE`, in order.
    pub settings: Vec<String>,
    /// The checked content.
    pub content: T,
    /// CRC-32 of the text, as the unit reports it; of a railway line's file without its `checksum` line.
    pub crc: u32,
    /// SHA-256 of the text, in hex.
    pub sha256: String,
}

impl ScriptsDirectory {
    /// The directory given, alone; else what [`ScriptFiles::find`] finds.
    ///
    /// # Errors
    /// `given` is no directory.
    pub fn find(given: Option<&Path>) -> Result<Self, Failure> {
        Ok(Self(ScriptFiles::find(given)?))
    }

    /// The places of data files; of a file that is in several, the first place counts.
    pub fn places(&self) -> &[Layer] {
        self.0.places()
    }

    /// The file is there.
    pub fn has(&self, name: &str) -> bool {
        self.0.file(name).is_some()
    }

    /// Name of the file, for people.
    pub fn shown(&self, name: &str) -> String {
        self.0.shown(name)
    }

    /// The file's text.
    ///
    /// # Errors
    /// The file is missing, cannot be read, is too long or not UTF-8.
    pub fn text(&self, name: &str) -> Result<String, Failure> {
        match self.0.file(name) {
            Some(found) => text(&found),
            None => read(Path::new(&self.shown(name))),
        }
    }

    /// Name and text of the file in each place that has it, the one that counts first.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn layers(&self, name: &str) -> Result<Vec<(String, String)>, Failure> {
        let files = self.0.files(name);
        files
            .map(|found| Ok((found.shown(), text(&found)?)))
            .collect()
    }

    /// The file's bytes, at most `most` of them.
    ///
    /// # Errors
    /// The file is missing or cannot be read.
    pub fn bytes(&self, name: &str, most: u64) -> Result<Vec<u8>, Failure> {
        match self.0.file(name) {
            Some(found) => content(&found, most),
            None => content(&Found::File(self.shown(name).into()), most),
        }
    }

    /// Text of every `.star` file by its path under its place.
    ///
    /// # Errors
    /// A file or folder cannot be read.
    pub fn procedures(&self) -> Result<BTreeMap<String, String>, Failure> {
        let mut texts = BTreeMap::new();
        let mut bytes = 0;
        for (name, found) in self.0.all()? {
            if !name.ends_with(".star") {
                continue;
            }
            let text = text(&found)?;
            bytes += text.len();
            if bytes > LONGEST_SCRIPTS {
                return Err(Failure::usage(FileTrouble::ScriptsTooLong(
                    self.0.places()[0].to_string(),
                    LONGEST_SCRIPTS,
                )));
            }
            texts.insert(name, text);
        }
        Ok(texts)
    }

    /// Own files, as they are shown, that replace different files of their names in places further down.
    ///
    /// # Errors
    /// A file or folder cannot be read.
    pub fn replacing(&self) -> Result<Vec<String>, Failure> {
        let mut replacing = Vec::new();
        for (name, found) in self.0.all()? {
            let mut below = self.0.files(&name).skip(1).peekable();
            if below.peek().is_none() {
                continue;
            }
            let own = content(&found, LONGEST_FILE)?;
            // The system's copy of what the program carries replaces nothing.
            if below.any(|other| content(&other, LONGEST_FILE).is_ok_and(|bytes| bytes != own)) {
                replacing.push(found.shown());
            }
        }
        Ok(replacing)
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
        let mut crc = 0;
        let file = self.load("lines", name, "line", |text| {
            crc = line::checksum(text);
            Line::from_toml(text)
        })?;
        Ok(DataFile { crc, ..file })
    }

    /// The train called `name` in `trains/`, or in a file ending in .toml.
    ///
    /// # Errors
    /// There is none, or it is wrong.
    pub fn train(&self, name: &str) -> Result<TrainData, Failure> {
        if !name.ends_with(".toml") {
            return Ok(self
                .load("trains", name, "train", TrainData::from_toml)?
                .content);
        }
        TrainData::from_toml(&read(Path::new(name))?)
            .map_err(|error| Failure::usage(FileTrouble::wrong(name, error)))
    }

    /// The bench file `benches/NAME.toml`, or a file ending in .toml, with the drivers of its instruments.
    ///
    /// # Errors
    /// There is none of that name, or it is wrong.
    pub fn bench_places(&self, name: &str) -> Result<Places, Failure> {
        let driver = |model: &str| {
            let read = self.load(INSTRUMENTS, model, "instrument", Model::from_toml);
            read.map(|file| file.content)
                .map_err(|failure| failure.message.to_string())
        };
        let read = |text: &str| Places::from_toml(text, driver);
        let (content, sha256) = match name.strip_suffix(".toml") {
            None => {
                let file = self.load("benches", name, "bench", read)?;
                (file.content, file.sha256)
            }
            Some(_) => {
                let text = text(&Found::File(name.into()))?;
                let wrong = |error| Failure::usage(FileTrouble::wrong(name, error));
                (read(&text).map_err(wrong)?, sha256(&text))
            }
        };
        Ok(Places {
            name: name.to_owned(),
            sha256,
            ..content
        })
    }

    /// The catalogue of parts and fault modes: `units/faults.toml`, and the modes of the files in `faults/`.
    ///
    /// # Errors
    /// The file is missing or wrong.
    pub fn faults(&self) -> Result<FaultCatalogue, Failure> {
        let mut text = String::new();
        let mut catalogue = None;
        for name in self.0.catalogue() {
            text.push_str(&self.text(&name)?);
            text.push('\n');
            let read = FaultCatalogue::from_toml(&text);
            let wrong = |error| Failure::usage(FileTrouble::wrong(self.shown(&name), error));
            catalogue = Some(read.map_err(wrong)?);
        }
        catalogue.ok_or_else(|| Failure::usage(FileTrouble::NoCatalogue))
    }

    /// Reads every data file, used or not, and counts them.
    ///
    /// # Errors
    /// The first that is wrong.
    pub fn check_data(&self) -> Result<usize, Failure> {
        let (units, lines, trains) = (
            self.unit_config_names(),
            self.line_names(),
            self.train_names(),
        );
        for name in &units {
            let unit = self.unit_config(name)?.content;
            if let Some((code, carrier_hz, why)) = unheard(&unit) {
                return Err(Failure::usage(FileTrouble::Unheard(
                    self.shown(&format!("{UNITS}/{name}.toml")),
                    code.name.clone(),
                    code.rate_hz.to_string(),
                    carrier_hz.to_string(),
                    why,
                )));
            }
        }
        for name in &lines {
            self.line(name)?;
        }
        for name in &trains {
            self.train(name)?;
        }
        let (benches, models) = (self.names("benches"), self.names(INSTRUMENTS));
        for name in &benches {
            self.bench_places(name)?;
        }
        for name in &models {
            self.load(INSTRUMENTS, name, "instrument", Model::from_toml)?;
        }
        self.faults()?;
        let of_bench = benches.len() + models.len();
        Ok(units.len() + lines.len() + trains.len() + of_bench + self.0.catalogue().len())
    }

    /// How good units, trains and benches differ: `bench_scatter.toml`, or a file given in its place.
    ///
    /// # Errors
    /// The file is missing or wrong.
    pub fn bench_scatter(&self, given: Option<&Path>) -> Result<BenchScatter, Failure> {
        let (text, shown) = match given {
            Some(file) => (read(file)?, file.display().to_string()),
            None => (self.text(BENCH_SCATTER)?, self.shown(BENCH_SCATTER)),
        };
        BenchScatter::from_toml(&text)
            .map_err(|error| Failure::usage(FileTrouble::wrong(shown, error)))
    }

    /// The fault modes of these names.
    ///
    /// # Errors
    /// The catalogue does not have one of the names.
    pub fn chosen_faults(&self, names: &[String]) -> Result<Vec<FaultMode>, Failure> {
        if names.is_empty() {
            return Ok(Vec::new());
        }
        let catalogue = self.faults()?;
        let find = |name: &String| {
            catalogue.fault(name).cloned().ok_or_else(|| {
                let known = catalogue.faults.iter().map(|fault| fault.id.as_str());
                Failure::usage(Unknown::Fault(name.clone(), did_you_mean(name, known)))
            })
        };
        names.iter().map(find).collect()
    }

    pub fn line_names(&self) -> Vec<String> {
        self.names("lines")
    }

    pub fn unit_config_names(&self) -> Vec<String> {
        self.names(UNITS)
    }

    pub fn train_names(&self) -> Vec<String> {
        self.names("trains")
    }

    /// Names of the data files in `folder`; fault catalogue and structure, beside unit configurations, do not count.
    fn names(&self, folder: &str) -> Vec<String> {
        let names = self.0.names(folder, "toml").into_iter();
        names
            .filter(|name| folder != UNITS || ![FAULTS, STRUCTURE].contains(&name.as_str()))
            .collect()
    }

    /// The file `FOLDER/NAME.toml` as `parse` reads it; `what` = the word for such a file in messages.
    ///
    /// # Errors
    /// There is none of that name, or it is wrong.
    pub(crate) fn load<T, E: Display>(
        &self,
        folder: &str,
        name: &str,
        what: &'static str,
        parse: impl FnOnce(&str) -> Result<T, E>,
    ) -> Result<DataFile<T>, Failure> {
        let file = format!("{folder}/{name}.toml");
        if !self.has(&file) {
            let known = self.names(folder);
            return Err(Failure::usage(Unknown::DataFile(
                what,
                name.to_owned(),
                did_you_mean(name, known.iter().map(String::as_str)),
                known.join(", "),
            )));
        }
        let text = self.text(&file)?;
        let wrong = |e: E| Failure::usage(FileTrouble::wrong(self.shown(&file), e));
        let content = parse(&text).map_err(wrong)?;
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

fn text(found: &Found) -> Result<String, Failure> {
    match found {
        Found::File(file) => read(file),
        Found::Embedded(_, bytes) => Ok(String::from_utf8_lossy(bytes).into_owned()),
    }
}

fn content(found: &Found, most: u64) -> Result<Vec<u8>, Failure> {
    match found {
        Found::File(file) => {
            read_regular_file(file, most).map_err(|error| cannot_read(file, Why::of(error)))
        }
        Found::Embedded(_, bytes) => Ok(bytes.to_vec()),
    }
}
