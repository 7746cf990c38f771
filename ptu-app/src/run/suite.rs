//! The procedures of a scripts directory, loaded for a bench and checked.

use std::collections::BTreeMap;
use std::sync::Arc;

use btu_rig::procedure::Procedure;
use btu_rig::procedure::loader::Loaded;
use protocol::injection::FaultCatalogue;

use super::{BenchSetup, loading, select};
use crate::data::{ScriptsDirectory, sha256};
use crate::failure::{Failure, did_you_mean};

/// What loading came to.
#[derive(Clone, Debug)]
pub struct Suite {
    /// Procedures, in order.
    pub procedures: Vec<Arc<Procedure>>,
    /// What is wrong in the scripts, with file, line and column; nothing may be run then.
    pub errors: Vec<String>,
    /// Procedures left out because the train has no cars.
    pub need_cars: Vec<String>,
    /// What scripts printed.
    pub printed: Vec<String>,
    /// Text of each script by its path.
    pub texts: BTreeMap<String, String>,
    /// SHA-256 over all of them.
    pub sha256: String,
}

impl Suite {
    /// Loads the procedures that `patterns` name, or all.
    ///
    /// # Errors
    /// A file cannot be read, or a pattern names nothing.
    pub fn load(
        directory: &ScriptsDirectory,
        patterns: &[String],
        setup: &BenchSetup,
    ) -> Result<Self, Failure> {
        let texts = select::scripts(directory, patterns)?;
        let Loaded {
            procedures,
            errors,
            need_cars,
            printed,
        } = loading::load(
            &texts,
            &setup.config.content,
            &setup.line.content,
            &setup.train,
        )?;
        let mut errors: Vec<_> = errors.iter().map(ToString::to_string).collect();
        if errors.is_empty() {
            errors = wrong_suspects(&procedures, &directory.faults()?);
        }
        Ok(Self {
            sha256: sha256(&texts.values().map(String::as_str).collect::<String>()),
            procedures,
            errors,
            need_cars,
            printed,
            texts,
        })
    }
}

/// Parts that scripts suspect must be parts that can be replaced.
fn wrong_suspects(procedures: &[Arc<Procedure>], catalogue: &FaultCatalogue) -> Vec<String> {
    let known = || catalogue.lrus.iter().map(|lru| lru.id.as_str());
    let mut errors = Vec::new();
    for procedure in procedures {
        let of_steps = procedure
            .steps
            .iter()
            .map(|s| (s.line, s.suspect.as_deref()));
        let of_procedure = (1, Some(procedure.suspect.as_str()));
        for (line, suspect) in std::iter::once(of_procedure).chain(of_steps) {
            // "-" is a procedure that suspects none.
            let named = suspect.filter(|part| !matches!(*part, "" | "-"));
            if let Some(part) = named.filter(|p| !known().any(|k| k == *p)) {
                errors.push(format!(
                    "{}:{line}:1: no part \"{part}\" to suspect{}; `ptu catalog lrus` lists them",
                    procedure.path,
                    did_you_mean(part, known())
                ));
            }
        }
    }
    errors
}
