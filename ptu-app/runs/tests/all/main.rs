//! Scenes against a monitor of what is true: no unit of the defaults may endanger its train.

mod hazards;

use std::path::Path;

use ptu_runs::data::ScriptsDirectory;
use ptu_runs::run::{BenchChoice, BenchSetup};

/// `scripts/` of this repository.
fn scripts() -> ScriptsDirectory {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts");
    ScriptsDirectory::find(Some(&path)).expect("scripts")
}

/// A bench of the defaults, these faults injected.
fn setup(faults: &[&str]) -> BenchSetup {
    let choice = BenchChoice {
        faults: faults.iter().map(|fault| (*fault).to_owned()).collect(),
        ..BenchChoice::default()
    };
    choice.setup(&scripts()).expect("a bench")
}
