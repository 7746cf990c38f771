//! The procedures of a scripts directory, evaluated for one unit configuration, line and train, and checked.

use std::collections::BTreeMap;
use std::sync::Arc;

use btu_rig::procedure::Procedure;
use btu_rig::procedure::loader::Loaded;
use protocol::injection::FaultCatalogue;

use super::bench_contents::train_sha256;
use super::bench_setup::BenchSetup;
use super::{loading, select};
use crate::data::ScriptsDirectory;
use crate::data::sha256;
use crate::failure::{Failure, did_you_mean};

/// Evaluated procedures, and the files they were evaluated from.
#[derive(Clone, Debug)]
pub struct Suite {
    /// Procedures, in order.
    pub procedures: Vec<Arc<Procedure>>,
    /// Errors in the scripts, with file, line and column; nothing may be run then.
    pub errors: Vec<String>,
    /// Procedures left out because the train has no cars.
    pub need_cars: Vec<String>,
    pub printed: Vec<String>,
    /// SHA-256 of the unit configuration, line and train that the scripts were evaluated with.
    pub bench_sha256: [String; 3],
    /// Text of each script by its path.
    pub texts: BTreeMap<String, String>,
    /// SHA-256 over the texts of all scripts.
    pub sha256: String,
}

impl Suite {
    /// Loads the procedures that `patterns` name, in their order, or all.
    ///
    /// # Errors
    /// A file cannot be read, or a pattern names nothing.
    pub fn load(
        directory: &ScriptsDirectory,
        patterns: &[String],
        setup: &BenchSetup,
    ) -> Result<Self, Failure> {
        let (texts, order) = select::scripts(directory, patterns)?;
        let Loaded {
            mut procedures,
            errors,
            need_cars,
            printed,
        } = loading::load(
            &texts,
            &setup.config.content,
            &setup.line.content,
            &setup.train,
        )?;
        select::in_order(&order, &mut procedures);
        let mut errors: Vec<_> = errors.iter().map(ToString::to_string).collect();
        if errors.is_empty() {
            errors = wrong_suspects(&procedures, &directory.faults()?);
        }
        Ok(Self {
            sha256: sha256(&texts.values().map(String::as_str).collect::<String>()),
            bench_sha256: bench_sha256(setup),
            procedures,
            errors,
            need_cars,
            printed,
            texts,
        })
    }

    /// Whether the scripts directory still holds the scripts of this suite, which was loaded from all scripts.
    ///
    /// # Errors
    /// A script cannot be read.
    pub fn has_current_scripts(&self, directory: &ScriptsDirectory) -> Result<bool, Failure> {
        Ok(directory.procedures()? == self.texts)
    }

    /// Whether the scripts were evaluated with this unit configuration, line and train.
    pub fn is_for(&self, setup: &BenchSetup) -> bool {
        self.bench_sha256 == bench_sha256(setup)
    }
}

fn bench_sha256(setup: &BenchSetup) -> [String; 3] {
    let (config, line) = (&setup.config.sha256, &setup.line.sha256);
    [config.clone(), line.clone(), train_sha256(&setup.train)]
}

/// Parts that scripts suspect must be parts that can be replaced.
fn wrong_suspects(procedures: &[Arc<Procedure>], catalogue: &FaultCatalogue) -> Vec<String> {
    let known = || catalogue.lrus.iter().map(|lru| lru.id.as_str());
    let mut errors = Vec::new();
    for procedure in procedures {
        let of_procedure = procedure.suspect.as_ref();
        let of_steps = procedure
            .steps
            .iter()
            .map(|step| (step.line, step.suspect.as_ref()))
            .filter(|(_, part)| *part != of_procedure);
        for (line, part) in std::iter::once((1, of_procedure)).chain(of_steps) {
            if let Some(part) = part.filter(|part| !known().any(|known| **part == known)) {
                errors.push(format!(
                    "{}:{line}:1: no part \"{part}\" to suspect{}; `ptu catalog parts` lists them",
                    procedure.path,
                    did_you_mean(part.as_str(), known())
                ));
            }
        }
    }
    errors
}
