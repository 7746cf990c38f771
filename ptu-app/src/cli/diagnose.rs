//! `ptu diagnose`: the parts that the results of a run point to.

use clap::Args;
use protocol::LruId;

use super::{Database, Json, ScriptsOption};
use ptu_report::diagnosis::{diagnosis_json, diagnosis_text};
use ptu_report::words::Words;
use ptu_runs::failure::{Asked, Exit, Failure};
use ptu_runs::run_diagnosis::{Question, diagnose};
use ptu_runs::stdio;

/// Find the part that failed, the reasons for this part, and the next best check
///
/// The results of the run are compared with the fault dictionary.
///
/// Examples:
///   ptu diagnose latest                      the last run
///   ptu diagnose 7ae4aeef --json
///   ptu diagnose latest 7ae4aeef             two runs of one unit together
///   ptu diagnose latest --why-not io_board   what speaks against this part
///
/// Exit codes: 0 answered, 2 no such run, or no dictionary.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct DiagnoseArguments {
    /// The run: an id, its beginning or end (at least 4 digits), or `latest`; more runs of the unit are evidence, too
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<String>,
    /// Say what speaks for and against this part, however unlikely the part is
    #[arg(long, value_name = "PART")]
    why_not: Option<LruId>,
    /// Show all candidates and reasons, with what the dictionary knows of each candidate
    #[arg(long)]
    all: bool,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    database: Database,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl DiagnoseArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        let store = self.database.open_read_only()?;
        let runs = self.runs.iter().map(|run| store.resolve_run(run));
        let runs: Vec<_> = runs.collect::<Result<_, _>>()?;
        let Some((run, with)) = runs.split_first() else {
            return Err(Failure::usage(Asked::RunUnnamed));
        };
        let directory = self.scripts.find()?;
        let question = Question {
            run: *run,
            with,
            why_not: self.why_not.as_ref(),
        };
        let answer = diagnose(&store, &directory, &question)?;
        for warning in &answer.warnings {
            stdio::note(&Words::shown().told(warning));
        }
        let text = || diagnosis_text(&answer, self.all, Words::shown());
        self.json.answer(|| diagnosis_json(&answer), text)
    }
}
