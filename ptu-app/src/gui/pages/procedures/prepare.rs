//! Loads the suite for a unit, and makes an order of what is chosen; on the library's thread.

use super::selection::{Selection, possible};
use crate::bench_worker::RunOrder;
use crate::diagnosis;
use crate::failure::Failure;
use crate::gui::UnitChoice;
use crate::gui::data_paths::DataPaths;
use crate::run::{RunPlan, Suite};

/// How what is chosen is run.
#[derive(Clone, Debug)]
pub struct How {
    /// Who tests.
    pub operator: String,
    /// So often.
    pub repeat: u32,
    /// End after the first step that does not pass.
    pub stop_on_fail: bool,
    /// As few steps as it takes to find the part.
    pub adaptive: bool,
}

/// The suite as it is on the disk now, for this unit.
///
/// # Errors
/// A file cannot be read, or something chosen is not there.
pub fn load(paths: &DataPaths, choice: &UnitChoice) -> Result<Suite, Failure> {
    let setup = choice.named()?.setup(&paths.scripts)?;
    Suite::load(&paths.scripts, &[], &setup)
}

/// What loading for an order came to.
pub enum Prepared {
    /// It can be run.
    Order(Box<RunOrder>),
    /// Scripts are no longer those that were shown: look at these first.
    Changed(Box<Suite>),
}

/// An order of what is chosen. The list shown is the list run: scripts that changed since are not run.
///
/// # Errors
/// Nothing is chosen, or a dictionary for an adaptive run is missing.
pub fn order(
    paths: &DataPaths,
    choice: &UnitChoice,
    serial: &str,
    selection: &Selection,
    how: How,
    shown_sha256: &str,
) -> Result<Prepared, Failure> {
    let setup = choice.named()?.setup(&paths.scripts)?;
    let suite = Suite::load(&paths.scripts, &[], &setup)?;
    if suite.sha256 != shown_sha256 || !suite.errors.is_empty() {
        return Ok(Prepared::Changed(Box::new(suite)));
    }
    let mut tasks = selection.tasks(&suite.procedures, how.repeat, how.stop_on_fail);
    tasks.retain(|task| possible(&task.procedure, choice.connection()));
    if tasks.is_empty() {
        return Err(Failure::usage("no step is chosen"));
    }
    let store = paths.open()?;
    let adaptive = match how.adaptive {
        true => {
            let bench = diagnosis::Bench {
                unit_config_sha256: &setup.config.sha256,
                line: &choice.line,
                train: &choice.train,
            };
            Some(diagnosis::adaptive(&store, &paths.scripts, serial, &bench)?)
        }
        false => None,
    };
    Ok(Prepared::Order(Box::new(RunOrder {
        plan: RunPlan {
            tasks,
            jobs: 1,
            stop_on_fail: how.stop_on_fail,
            operator: how.operator,
            train: choice.train_no.trim().to_owned(),
            scripts_sha256: suite.sha256,
            adaptive,
        },
        store,
        realtime: choice.realtime,
    })))
}
