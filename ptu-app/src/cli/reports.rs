//! `--report`: writes the report of a run to files.

use clap::Args;
use fault_db::{RunDetail, Store};

use ptu_report::words::Language;
use ptu_report::{self, Target};
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::Failure;

/// Option that names the reports to write.
#[derive(Debug, Args)]
pub struct ReportOption {
    /// Write a report: a test sheet as .html or .pdf, or .csv, .json, .junit.xml; repeatable
    #[arg(long, value_name = "FILE")]
    report: Vec<Target>,
}

impl ReportOption {
    /// Whether no report is to be written.
    pub fn is_empty(&self) -> bool {
        self.report.is_empty()
    }

    /// Checks before the run that all reports can be written after it.
    pub fn check(&self) -> Result<(), Failure> {
        self.report.iter().try_for_each(Target::check)
    }

    /// Writes all reports of a run.
    pub fn write(
        &self,
        store: &Store,
        directory: &ScriptsDirectory,
        run: &RunDetail,
    ) -> Result<(), Failure> {
        ptu_report::write(&self.report, store, directory, run, Language::shown())
    }
}
