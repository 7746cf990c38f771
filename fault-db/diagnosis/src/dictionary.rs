//! The fault dictionary: what each fault mode does to each check, counted in a campaign.
//!
//! A mode is counted at each of its levels (the number of its effect). Cells of a level that are like a healthy unit's
//! are left out, so that the dictionary holds only the differences.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read as _};

use protocol::LruId;
use serde::{Deserialize, Serialize};

use super::cell::Cell;
use super::observation::{CheckName, Observation, Sign};

/// Compression level of zstd: a dictionary is read often and written seldom.
const ZSTD_LEVEL: i32 = 15;
/// Name of the level that holds real runs.
const CASES: &str = "cases";
/// A dictionary unpacks to at most this many bytes.
const MAX_BYTES: u64 = 64 << 20;

/// Provenance of a dictionary. For a unit, scripts or a line of other provenance the dictionary may be wrong.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Basis {
    /// SHA-256 over the fields below and all other inputs, in hex.
    pub sha256: String,
    /// SHA-256 of the unit configuration.
    pub unit_config_sha256: String,
    /// SHA-256 of each procedure's script.
    pub procedures: BTreeMap<String, String>,
    pub line: String,
    pub train: String,
    /// How the units were reached: `harness`, or `ptu` for the maintenance port alone.
    #[serde(default = "harness")]
    pub connection: String,
    /// Version of the program.
    pub app_version: String,
}

/// Default of `connection`, for older files without that field: the units were on a bench.
fn harness() -> String {
    "harness".into()
}

/// A fault mode of the catalogue.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModeName {
    /// `part.mode`.
    pub id: String,
    /// Part to replace.
    pub lru: LruId,
    /// Description for users.
    pub text: String,
    /// `permanent`, `intermittent` or `degraded`.
    pub kind: String,
    /// Whether the mode can leave the train less protected.
    #[serde(rename = "unsafe")]
    pub unsafe_: bool,
    /// Relative prior weight.
    pub weight: f64,
}

impl ModeName {
    /// Kind of a mode made of the confirmed repairs of a part; the mode's text names the repaired units.
    pub const CONFIRMED: &str = "confirmed";
}

/// Counts of a fault mode at one level.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// `nominal`, or the number of the effect.
    pub level: String,
    /// Number of runs of the suite.
    pub runs: u32,
    /// Counts by the index of the check; cells like a healthy unit's are left out.
    pub cells: BTreeMap<usize, Cell>,
    /// Number of runs in which each sign showed in any check.
    pub signs: Vec<(Sign, u32)>,
    /// In how many traces each signal was the first to deviate.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub residuals: BTreeMap<String, u32>,
}

/// A fault mode with its levels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mode {
    pub name: ModeName,
    pub columns: Vec<Column>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Dictionary {
    pub basis: Basis,
    /// Seeds of the campaign's runs.
    pub seeds: Vec<u64>,
    /// Checks in the order of the suite.
    pub checks: Vec<CheckName>,
    /// The part that the script of each check suspects when the check fails, in the order of the checks.
    #[serde(default)]
    pub suspects: Vec<Option<LruId>>,
    /// Counts of a healthy unit.
    pub healthy: Column,
    /// Fault modes.
    pub modes: Vec<Mode>,
    /// All replaceable parts, including those without a mode.
    #[serde(default)]
    pub parts: Vec<LruId>,
    /// Index of each check by its name.
    #[serde(skip)]
    places: BTreeMap<CheckName, usize>,
}

impl Dictionary {
    /// An empty dictionary of these checks.
    pub fn new(basis: Basis, seeds: Vec<u64>, checks: Vec<CheckName>) -> Self {
        let mut dictionary = Self {
            basis,
            seeds,
            checks,
            ..Self::default()
        };
        dictionary.index();
        dictionary
    }

    /// Compresses the dictionary for storage.
    ///
    /// # Errors
    /// The compressor has no memory.
    pub fn to_bytes(&self) -> Result<Vec<u8>, String> {
        let json = serde_json::to_vec(self).map_err(|error| error.to_string())?;
        pack(&json).map_err(|error| error.to_string())
    }

    /// Decompresses and validates a dictionary.
    ///
    /// # Errors
    /// The bytes are no dictionary, or an inconsistent one.
    pub fn from_bytes(packed: &[u8]) -> Result<Self, String> {
        let json = unpack(packed).map_err(|error| error.to_string())?;
        let mut read: Self = serde_json::from_slice(&json).map_err(|error| error.to_string())?;
        read.index();
        match read.unsound() {
            Some(what) => Err(what),
            None => Ok(read),
        }
    }

    /// The first inconsistency, if any.
    fn unsound(&self) -> Option<String> {
        let columns = self.modes.iter().flat_map(|mode| &mode.columns);
        let mut places = columns
            .chain([&self.healthy])
            .flat_map(|column| column.cells.keys());
        if let Some(place) = places.find(|place| **place >= self.checks.len()) {
            return Some(format!("it has no check number {place}"));
        }
        let mut names = self.modes.iter().map(|mode| &mode.name);
        let weightless = names.find(|name| !(name.weight.is_finite() && name.weight > 0.0))?;
        let (id, weight) = (&weightless.id, weightless.weight);
        Some(format!("fault mode {id} has the weight {weight}"))
    }

    fn index(&mut self) {
        let names = self.checks.iter().cloned().zip(0..);
        self.places = names.collect();
    }

    /// Index of a check.
    pub fn place(&self, check: &CheckName) -> Option<usize> {
        self.places.get(check).copied()
    }

    /// Adds runs of a healthy unit. Must come before any mode.
    pub fn set_healthy(&mut self, runs: &[Observation]) {
        self.healthy = self.count("nominal".into(), runs);
    }

    /// Adds runs of one level of a mode.
    pub fn add(&mut self, mode: &ModeName, level: String, runs: &[Observation]) {
        let mut column = self.count(level, runs);
        let healthy = &self.healthy.cells;
        column.cells.retain(|place, cell| {
            let Some(healthy) = healthy.get(place) else {
                return true;
            };
            cell.take_values_from(healthy);
            !cell.is_like(healthy)
        });
        match self.modes.iter_mut().find(|known| known.name.id == mode.id) {
            Some(known) => known.columns.push(column),
            None => self.modes.push(Mode {
                name: mode.clone(),
                columns: vec![column],
            }),
        }
    }

    /// Adds a level between two levels of a mode, as if the runs of both were runs of one level: a check that ends
    /// differently at both may end either way, and values scatter about the middle. Does nothing if a level has no
    /// runs.
    pub fn add_between(&mut self, mode: &str, levels: [usize; 2]) {
        let mode = self.modes.iter_mut().find(|known| known.name.id == mode);
        let Some(mode) = mode else { return };
        let columns = levels.map(|level| mode.columns.get(level).filter(|column| column.runs > 0));
        let [Some(one), Some(other)] = columns else {
            return;
        };
        let cell = |column: &Column, place: &usize| {
            let own = column.cells.get(place).cloned();
            let healthy = || Some(self.healthy.cells.get(place)?.of_runs(column.runs));
            Some(own.or_else(healthy)?.with_values_of(column.runs))
        };
        let places: BTreeSet<_> = one.cells.keys().chain(other.cells.keys()).collect();
        let both = |place| match (cell(one, place), cell(other, place)) {
            (Some(one), Some(other)) => Some((*place, one.with(&other))),
            (one, other) => Some((*place, one.or(other)?)),
        };
        let mut signs: BTreeMap<Sign, u32> = one.signs.iter().cloned().collect();
        for (sign, count) in &other.signs {
            *signs.entry(sign.clone()).or_default() += count;
        }
        let mut residuals = one.residuals.clone();
        for (signal, count) in &other.residuals {
            *residuals.entry(signal.clone()).or_default() += count;
        }
        let between = Column {
            level: format!("{} to {}", one.level, other.level),
            runs: one.runs + other.runs,
            cells: places.into_iter().filter_map(both).collect(),
            signs: signs.into_iter().collect(),
            residuals,
        };
        mode.columns.push(between);
    }

    /// Adds real runs with a fault of a part as a mode of its own; each run counts as one observation. A check that
    /// passed in all of them says more about these units than about the fault, and counts as a healthy unit's.
    pub fn add_cases(&mut self, mode: &ModeName, runs: &[Observation]) {
        self.add(mode, CASES.into(), runs);
        let added = self.modes.last_mut();
        if let Some(column) = added.and_then(|mode| mode.columns.last_mut()) {
            column.cells.retain(|_, cell| cell.shows_a_fault());
        }
    }

    fn count(&self, level: String, runs: &[Observation]) -> Column {
        let mut cells: BTreeMap<usize, Cell> = BTreeMap::new();
        let mut signs: BTreeMap<Sign, u32> = BTreeMap::new();
        let mut residuals: BTreeMap<String, u32> = BTreeMap::new();
        for run in runs {
            for signal in &run.residuals {
                *residuals.entry(signal.clone()).or_default() += 1;
            }
            let mut shown: BTreeSet<&Sign> = run.signs.iter().collect();
            for step in &run.steps {
                if let Some(place) = self.place(&step.check) {
                    cells.entry(place).or_default().add(step);
                }
                shown.extend(&step.signs);
            }
            for sign in shown {
                *signs.entry(sign.clone()).or_default() += 1;
            }
        }
        Column {
            level,
            runs: runs.len() as u32,
            cells,
            signs: signs.into_iter().collect(),
            residuals,
        }
    }

    /// All parts, those of modes included, each once, in order.
    pub fn lrus(&self) -> Vec<&LruId> {
        let of_modes = self.modes.iter().map(|mode| &mode.name.lru);
        let all: BTreeSet<_> = self.parts.iter().chain(of_modes).collect();
        all.into_iter().collect()
    }
}

/// Compresses, with a checksum by which damage is found.
fn pack(json: &[u8]) -> io::Result<Vec<u8>> {
    let mut compressor = zstd::bulk::Compressor::new(ZSTD_LEVEL)?;
    compressor.include_checksum(true)?;
    compressor.compress(json)
}

/// Decompresses to at most [`MAX_BYTES`].
fn unpack(packed: &[u8]) -> io::Result<Vec<u8>> {
    let mut json = Vec::new();
    let decoder = zstd::stream::read::Decoder::new(packed)?;
    if decoder.take(MAX_BYTES + 1).read_to_end(&mut json)? as u64 > MAX_BYTES {
        return Err(io::Error::other(format!(
            "it unpacks to more than {MAX_BYTES} bytes"
        )));
    }
    Ok(json)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: bytes that decompress without error, but are no dictionary, are refused.
    #[test]
    fn any_bytes_can_be_decompressed_or_are_refused() {
        let mode = ModeName {
            id: "eb_relay.slow".into(),
            lru: LruId::from_static("eb_relay"),
            text: "drops late".into(),
            kind: "degraded".into(),
            unsafe_: true,
            weight: 0.75,
        };
        let mut dictionary = Dictionary::new(Basis::default(), vec![1, 2], Vec::new());
        dictionary.add(&mode, "0.4".into(), &[Observation::default()]);
        let json = serde_json::to_vec(&dictionary).expect("JSON");
        let fuzz = fuzzing::Fuzz::new("dictionary", env!("CARGO_MANIFEST_DIR"), [json]);
        fuzz.run(20_000, |json| {
            let packed = pack(json).expect("packed");
            if let Ok(read) = Dictionary::from_bytes(&packed) {
                let again = read.to_bytes().expect("packed");
                assert_eq!(Dictionary::from_bytes(&again), Ok(read));
            }
        });
    }
}
