//! Reference of a comparison of a recorded run, as commands name it.

use btu_rig::drive::Load;
use fault_db::{Id, Store};

use super::{RecordComparison, compare, find_section};
use crate::data::ScriptsDirectory;
use crate::drive::{Request, SectionChoice};
use crate::failure::{Failure, Unknown};

/// The train of the sound unit.
const TRAIN: &str = "line6";

/// Request for a comparison; fields that are not set follow from the trace and its run.
#[derive(Clone, Debug, Default)]
pub struct CompareRequest {
    pub section: Option<u16>,
    /// Line, `lines/NAME.toml`.
    pub line: Option<String>,
    /// Unit configuration, `units/NAME.toml`.
    pub unit_config: Option<String>,
    /// Passengers of the sound unit's train.
    pub load: Option<Load>,
}

/// A comparison, with the trace, unit, line and configuration compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    pub trace: Id,
    pub unit_serial: String,
    pub line: String,
    pub unit_config: String,
    pub comparison: RecordComparison,
}

impl CompareRequest {
    /// Compares a stored trace of a unit's run record.
    ///
    /// # Errors
    /// The trace is no run record, its section is not known, or a file is missing.
    pub fn compare(
        &self,
        store: &Store,
        directory: &ScriptsDirectory,
        trace: Id,
    ) -> Result<Compared, Failure> {
        let head = store.trace_head(trace)?;
        let run = store.run(head.run_id)?.run;
        let line_name = self.line.clone().unwrap_or(run.line);
        let unit_config = self.unit_config.clone().unwrap_or(run.unit_config_name);
        let line = directory.line(&line_name)?;
        let data = store.trace(trace)?;
        let number = match self.section {
            Some(number) => number,
            None => find_section(&line.content, &data)?,
        };
        let request = Request {
            line: Some(line_name.clone()),
            sections: Some(SectionChoice::One(number)),
            train: TRAIN.into(),
            load: self.load,
            unit_config: unit_config.clone(),
            seed: 1,
            ..Request::default()
        };
        let cases = request.cases(directory)?;
        let case = cases
            .first()
            .ok_or_else(|| Failure::usage(Unknown::Section(line_name.clone(), number)))?;
        let comparison = compare(&data, &case.plan.section, case)?;
        Ok(Compared {
            trace,
            unit_serial: head.unit_serial,
            line: line_name,
            unit_config,
            comparison,
        })
    }
}
