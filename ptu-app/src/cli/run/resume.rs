//! `--resume` and `--retry-errors`: runs what an earlier run left open, as a new run linked to the earlier run.

use std::sync::Arc;

use btu_rig::procedure::Procedure;
use clap::Args;
use fault_db::{RunDetail, RunState};

use super::RunArguments;
use ptu_report::words::{Words, fill};
use ptu_runs::failure::{Asked, Failure};
use ptu_runs::link::Endpoint;
use ptu_runs::run::{BenchSetup, Unfinished, unfinished};
use ptu_runs::stdio;

/// Serial number recorded for a unit that was not reached.
const UNKNOWN_SERIAL: &str = "unknown";

/// Options that name the earlier run.
#[derive(Debug, Args)]
pub struct ResumeOption {
    /// Run what RUN left without a verdict (stopped, interrupted, not begun), as a new run linked to RUN. Unit, serial
    /// number, train number, line, unit configuration, seed and injected faults are taken from RUN unless given; what a
    /// run does not store (--harness, --train, --set, --scattered, --step, --repeat) has to be given again
    #[arg(long, value_name = "RUN", conflicts_with_all = ["procedures", "retry_errors", "adaptive", "check"])]
    resume: Option<String>,
    /// Run again the procedures that ended as errors in RUN, because they could not be tested; else as --resume
    #[arg(long, value_name = "RUN", conflicts_with_all = ["procedures", "adaptive", "check"])]
    retry_errors: Option<String>,
}

impl RunArguments {
    /// The earlier run, if one is named; takes over its values for all options that are not given.
    pub(super) fn take_over(&mut self) -> Result<Option<RunDetail>, Failure> {
        let (which, name) = match (&self.resume.resume, &self.resume.retry_errors) {
            (Some(name), _) => (Unfinished::WithoutVerdict, name),
            (_, Some(name)) => (Unfinished::Errors, name),
            (None, None) => return Ok(None),
        };
        let store = self.database.open_read_only()?;
        let earlier = store.run(store.resolve_run(name)?)?;
        let (run, id) = (&earlier.run, earlier.run.id);
        if run.state == RunState::Running {
            return Err(Failure::usage(Asked::StillRunning(id)));
        }
        let open = unfinished(&earlier, which);
        if open.is_empty() {
            return Err(Failure::usage(match (earlier.scripts.len(), which) {
                (0, _) => Asked::RanNothing(id, run.source.clone()),
                (_, Unfinished::WithoutVerdict) => Asked::AllJudged(id),
                (_, Unfinished::Errors) => Asked::NoneInError(id),
            }));
        }
        self.take_unit(&earlier)?;
        self.procedures = open;
        self.seed.get_or_insert(run.seed);
        let line = self.line.get_or_insert_with(|| run.line.clone());
        if *line != run.line {
            let of = [
                ("run", &id.short() as _),
                ("line", &run.line as _),
                ("now", line as _),
            ];
            stdio::note(&fill(Words::shown().terminal.resumed_on, &of));
        }
        self.unit_config
            .get_or_insert_with(|| run.unit_config_name.clone());
        if self.train_no.is_empty() {
            self.train_no.clone_from(&run.train);
        }
        if self.inject.is_empty() {
            let injected = run.injected.as_deref().unwrap_or_default();
            let names = injected.split(',').filter(|name| !name.is_empty());
            self.inject = names.map(str::to_owned).collect();
        }
        Ok(Some(earlier))
    }

    /// Takes over the unit of the earlier run, on the same port or another; refuses a different unit.
    fn take_unit(&mut self, earlier: &RunDetail) -> Result<(), Failure> {
        let (run, id) = (&earlier.run, earlier.run.id);
        let place = match run.source.parse::<Endpoint>() {
            Ok(place) => place,
            Err(error) => {
                return Err(Failure::usage(Asked::WasOnNoUnit(
                    id,
                    run.source.clone(),
                    error,
                )));
            }
        };
        let unit = self.unit.get_or_insert_with(|| place.clone());
        if (*unit == Endpoint::Sim) != (place == Endpoint::Sim) {
            return Err(Failure::usage(Asked::WasOnOtherUnit(
                id,
                place.to_string(),
                unit.to_string(),
            )));
        }
        if run.unit_serial == UNKNOWN_SERIAL {
            return Ok(());
        }
        let serial = self
            .serial_no
            .get_or_insert_with(|| run.unit_serial.clone());
        if *serial != run.unit_serial {
            return Err(Failure::usage(Asked::WasOfOtherSerial(
                id,
                run.unit_serial.clone(),
                serial.clone(),
            )));
        }
        Ok(())
    }
}

/// Prints which scripts have changed since the earlier run, and whether the unit configuration has.
pub(super) fn tell_changes(earlier: &RunDetail, procedures: &[Arc<Procedure>], setup: &BenchSetup) {
    let terminal = &Words::shown().terminal;
    let id = earlier.run.id.short();
    let is_changed = |procedure: &&Arc<Procedure>| {
        let mut before = earlier.scripts.iter();
        before.any(|script| script.path == procedure.path && script.sha256 != procedure.sha256)
    };
    for procedure in procedures.iter().filter(is_changed) {
        let of = [("path", &procedure.path as _), ("run", &id as _)];
        stdio::note(&fill(terminal.script_changed, &of));
    }
    if setup.config.sha256 != earlier.run.unit_config_sha256 {
        stdio::note(&fill(terminal.config_changed, &[("run", &id)]));
    }
}
