//! `ptu record compare`: a recorded automatic run beside its target and a sound unit's run.

use std::path::PathBuf;

use btu_rig::drive::Load;
use clap::Args;
use fault_db::Store;

use crate::cli::{Json, ScriptsOption};
use ptu_report::{json_text, record};
use ptu_runs::failure::{Asked, Exit, Failure};
use ptu_runs::new_file::kind;
use ptu_runs::record::CompareRequest;
use ptu_runs::whole_file::{check_writable, write_text};

/// Compare a run of a unit's own record with its target, and with a sound unit's run through the same section
///
/// Shows where the speed deviates from the run's own target, and where target and speed deviate from those of a
/// sound unit that drives the same section (same line and unit configuration). Also shows the stop error, a late
/// brake, and missed markers. Section, line and unit configuration follow from the trace and its run.
///
/// Examples:
///   ptu record compare latest
///   ptu record compare 59c2ce97 --load full --report compare.json
///
/// Exit codes: 0 as expected; 1 something deviates; 2 wrong command, or no run record.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct CompareArguments {
    /// The trace: an id, its beginning or end (at least 4 digits), or `latest`
    trace: String,
    /// Section [default: the section whose markers and stop fit the run]
    #[arg(long, value_name = "N")]
    section: Option<u16>,
    /// Line, lines/NAME.toml [default: the line of the trace's run]
    #[arg(long, value_name = "NAME")]
    line: Option<String>,
    /// Unit configuration, units/NAME.toml [default: the configuration of the trace's run]
    #[arg(long, value_name = "NAME")]
    unit_config: Option<String>,
    /// Passengers of the sound unit's train: a mass, empty or full
    #[arg(long, value_name = "KG|empty|full")]
    load: Option<Load>,
    #[command(flatten)]
    json: Json,
    /// Write the comparison to a file, .json or .txt; repeatable
    #[arg(long, value_name = "FILE")]
    report: Vec<PathBuf>,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl CompareArguments {
    pub fn run(self, store: &Store) -> Result<Exit, Failure> {
        for file in &self.report {
            let ending = file.extension().and_then(|ending| ending.to_str());
            if !matches!(ending, Some("json" | "txt")) {
                return Err(Failure::usage(Asked::NoComparison(
                    file.display().to_string(),
                )));
            }
            check_writable(file, kind::OWN)?;
        }
        let trace = store.resolve_trace(&self.trace)?;
        let request = CompareRequest {
            section: self.section,
            line: self.line,
            unit_config: self.unit_config,
            load: self.load,
        };
        let compared = request.compare(store, &self.scripts.find()?, trace)?;
        let (text, document) = (record::text(&compared), record::json(&compared));
        for file in &self.report {
            let is_json = file.extension().is_some_and(|ending| ending == "json");
            let content = if is_json {
                json_text(&document)?
            } else {
                text.clone()
            };
            write_text(file, format!("{}\n", content.trim_end()))?;
        }
        self.json.answer(|| &document, || text)?;
        Ok(match compared.comparison.is_as_expected() {
            true => Exit::Passed,
            false => Exit::Failed,
        })
    }
}
