//! Evaluates the scripts for a unit and makes an order of the chosen steps; runs on the query worker's thread.

use std::sync::Arc;

use btu_rig::procedure::plan::Connection;

use super::selection::Selection;
use crate::DataPaths;
use ptu_runs::bench_worker::RunOrder;
use ptu_runs::failure::{Asked, Failure, RunTrouble};
use ptu_runs::run::{BenchChoice, RunPlan, Suite};
use ptu_runs::run_diagnosis;
use ptu_runs::symptoms::Symptom;

#[derive(Clone, Debug)]
pub struct RunSettings {
    pub operator: String,
    pub repeat: u32,
    /// End after the first step that does not pass.
    pub stop_on_fail: bool,
    /// Adaptive run: only as many steps as are needed to find the part.
    pub adaptive: bool,
    /// Symptom reported with the unit.
    pub symptom: Option<Symptom>,
    /// The run that broke off, if this run is its rest.
    pub continues: Option<fault_db::Id>,
}

impl Default for RunSettings {
    fn default() -> Self {
        Self {
            operator: String::new(),
            repeat: 1,
            stop_on_fail: false,
            adaptive: false,
            symptom: None,
            continues: None,
        }
    }
}

/// Evaluates the scripts, as they are on the disk now, for this choice of unit.
///
/// # Errors
/// A file cannot be read, or a chosen file is missing.
pub fn load(paths: &DataPaths, choice: &BenchChoice) -> Result<Suite, Failure> {
    let setup = choice.clone().with_offered_faults().setup(&paths.scripts)?;
    Suite::load(&paths.scripts, &[], &setup)
}

/// The suite on the page, and the choice of unit for which it was evaluated.
#[derive(Clone)]
pub struct ShownSuite {
    pub suite: Arc<Suite>,
    /// The choice of unit configuration, line and train.
    pub loaded_for: BenchChoice,
}

/// The result of preparing an order.
pub enum Prepared {
    Order(Box<RunOrder>),
    /// A file has changed since the suite was shown: the suite is to be loaded and shown again first.
    Changed,
}

/// Makes an order of the chosen steps of the shown suite. The procedures that were shown are run: the scripts, the
/// unit configuration, the line and the train are read again, but only to notice that they have changed.
///
/// A unit with another configuration, line or train than the shown suite gets its own evaluation of the same
/// scripts.
///
/// # Errors
/// No step is chosen, a file cannot be read, or the dictionary for an adaptive run is missing.
pub fn order(
    paths: &DataPaths,
    choice: &BenchChoice,
    (serial, connection): (&str, Connection),
    selection: &Selection,
    how: RunSettings,
    shown: &ShownSuite,
) -> Result<Prepared, Failure> {
    let setup = choice.clone().with_offered_faults().setup(&paths.scripts)?;
    if !shown.suite.has_current_scripts(&paths.scripts)? {
        return Ok(Prepared::Changed);
    }
    let suite = match shown.suite.is_for(&setup) {
        true => shown.suite.clone(),
        false if choice.same_files(&shown.loaded_for) => return Ok(Prepared::Changed),
        false => Arc::new(Suite::load(&paths.scripts, &[], &setup)?),
    };
    if let Some(error) = suite.errors.first() {
        return Err(Failure::usage(RunTrouble::Script(error.clone())));
    }
    let tasks = selection.tasks(&suite.procedures, how.repeat, how.stop_on_fail);
    if tasks.is_empty() {
        return Err(Failure::usage(Asked::NoStepChosen));
    }
    let store = paths.open()?;
    let adaptive = match how.adaptive {
        true => {
            let bench = run_diagnosis::Bench {
                unit_config_sha256: &setup.config.sha256,
                line: &choice.line,
                train: &choice.train,
                connection,
                practice: setup.is_practice(),
            };
            Some(run_diagnosis::adaptive(
                &store,
                &paths.scripts,
                (serial, how.symptom.as_ref()),
                &bench,
            )?)
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
            symptom: how.symptom.map(|symptom| symptom.id),
            scripts_sha256: suite.sha256.clone(),
            adaptive,
            continues: how.continues,
            measuring: Default::default(),
        },
        store,
        realtime: choice.realtime,
    })))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;
    use ptu_runs::data::ScriptsDirectory;

    /// A scripts directory of one procedure, with the shipped units, lines and trains.
    fn scripts_in(folder: &Path) -> ScriptsDirectory {
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts");
        for part in ["units", "lines", "trains"] {
            fs::create_dir(folder.join(part)).expect("a folder");
            for file in fs::read_dir(shipped.join(part)).expect("shipped") {
                let file = file.expect("a file");
                if file.path().is_file() {
                    fs::copy(file.path(), folder.join(part).join(file.file_name()))
                        .expect("copied");
                }
            }
        }
        write_procedure(folder, 200);
        ScriptsDirectory::find(Some(folder)).expect("scripts")
    }

    fn write_procedure(folder: &Path, wait_ms: u32) {
        let text = format!(
            "procedure(title = \"Wait\", suspect = \"-\")\nstep(\"waits\", do = [wait(ms({wait_ms}))], measure = value(\"v\", speed))\n"
        );
        fs::write(folder.join("waiting.star"), text).expect("written");
    }

    fn append(file: &Path, text: &str) {
        let before = fs::read_to_string(file).expect("there");
        fs::write(file, before + text).expect("written");
    }

    fn prepared(paths: &DataPaths, choice: &BenchChoice, shown: &ShownSuite) -> Prepared {
        let selection = Selection::usual(&shown.suite.procedures, choice.connection());
        let (how, unit) = (RunSettings::default(), ("SIM-0001", choice.connection()));
        order(paths, choice, unit, &selection, how, shown).expect("prepared")
    }

    /// Goal: the procedures that were shown are run. Method: an order from unchanged files, then from each kind of
    /// file changed on the disk, then for a unit on another line.
    #[test]
    fn the_shown_procedures_are_run_unless_one_of_their_files_has_changed() {
        let folder = tempfile::tempdir().expect("a folder");
        let scripts = scripts_in(folder.path());
        let paths = DataPaths::new(folder.path().join("history.db"), scripts);
        let choice = BenchChoice::default();
        let load_shown = || ShownSuite {
            suite: Arc::new(load(&paths, &choice).expect("the suite")),
            loaded_for: choice.clone(),
        };
        let shown = load_shown();
        assert_eq!(shown.suite.errors, [""; 0]);

        let Prepared::Order(order) = prepared(&paths, &choice, &shown) else {
            panic!("nothing has changed");
        };
        assert!(Arc::ptr_eq(
            &order.plan.tasks[0].procedure,
            &shown.suite.procedures[0]
        ));

        let other_line = BenchChoice {
            line: "line6".into(),
            ..choice.clone()
        };
        let Prepared::Order(order) = prepared(&paths, &other_line, &shown) else {
            panic!("the scripts are the same");
        };
        let own = &order.plan.tasks[0].procedure;
        assert!(!Arc::ptr_eq(own, &shown.suite.procedures[0]));

        write_procedure(folder.path(), 300);
        assert!(matches!(
            prepared(&paths, &choice, &shown),
            Prepared::Changed
        ));
        let shown = load_shown();
        append(&folder.path().join("units/sg100.toml"), "\n# changed\n");
        assert!(matches!(
            prepared(&paths, &choice, &shown),
            Prepared::Changed
        ));
    }
}
