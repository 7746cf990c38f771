//! What the tests of this crate begin with: the scripts of this repository, and benches of its defaults.

use std::path::Path;
use std::sync::Arc;

use btu_rig::procedure::{Procedure, loader};

use crate::data::ScriptsDirectory;
use crate::run::{BenchChoice, BenchSetup};

/// `scripts/` of this repository.
pub fn scripts() -> ScriptsDirectory {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts");
    ScriptsDirectory::find(Some(&path)).expect("scripts")
}

/// A bench of the defaults, these faults injected.
pub fn setup(faults: &[&str]) -> BenchSetup {
    let choice = BenchChoice {
        faults: faults.iter().map(|fault| (*fault).to_owned()).collect(),
        ..BenchChoice::default()
    };
    choice.setup(&scripts()).expect("a bench")
}

pub fn procedures(setup: &BenchSetup) -> Vec<Arc<Procedure>> {
    let texts = scripts().procedures().expect("procedures");
    let (config, line) = (&setup.config.content, &setup.line.content);
    loader::load(&texts, config, line, &setup.train).procedures
}
