//! `ptu runs`: recorded runs.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use fault_db::{RunDetail, RunFilter, Signed, Statement, Store};

use super::output::Form;
use super::reports::ReportOption;
use super::signing::SigningOption;
use super::{Database, Json, ScriptsOption, at_least_one, check_unit, print_out};
use crate::verdict_table::verdict_table;
use ptu_report::run::{RunComparison, comparison_json, comparison_text};
use ptu_report::trace_notes::{note_text, noted_by};
use ptu_report::words::{Language, Words, fill};
use ptu_report::{Target, count_short, run_json, run_summary_json, write_comparison};
use ptu_runs::clock::{self, Span};
use ptu_runs::coverage::counts_of;
use ptu_runs::failure::{Asked, Exit, Failure};
use ptu_runs::table::Table;
use ptu_runs::whole_file;

/// Show and compare recorded runs, and add notes to them
#[derive(Debug, Args)]
pub struct RunsArguments {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    database: Database,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// List runs, newest first
    List {
        /// Only of this unit (serial number)
        #[arg(long, value_name = "TEXT")]
        serial_no: Option<String>,
        /// Only with this verdict
        #[arg(long)]
        verdict: Option<fault_db::Verdict>,
        /// Only runs begun in this time: 30d, today, 2026-03, 2026-03..2026-05, 2026-03-21..
        #[arg(long, value_name = "SPAN", allow_hyphen_values = true)]
        when: Option<Span>,
        /// At most N runs
        #[arg(long, value_name = "N", default_value_t = 50, value_parser = at_least_one())]
        limit: u32,
        #[command(flatten)]
        form: Form,
    },
    /// Show one run: an id, its beginning or end (at least 4 digits), or `latest`
    Show {
        /// The run
        id: String,
        #[command(flatten)]
        json: Json,
        #[command(flatten)]
        reports: ReportOption,
        #[command(flatten)]
        scripts: ScriptsOption,
    },
    /// Compare two runs of a unit, before and after a repair: verdicts, values, and what changed
    ///
    /// Runs of different units, scripts, configurations or lines are compared, too; the answer says so.
    ///
    /// Exit codes: 0 compared, 1 a step that passed in the first run does not in the second, 2 no such run, 3 database.
    #[command(verbatim_doc_comment)]
    Compare {
        /// The run before: an id, its beginning or end (at least 4 digits)
        #[arg(value_name = "A")]
        before: String,
        /// The run after: an id, its beginning or end (at least 4 digits), or `latest`
        #[arg(value_name = "B")]
        after: String,
        /// Show also the steps that passed in both runs
        #[arg(long)]
        all: bool,
        #[command(flatten)]
        json: Json,
        /// Write the comparison as .html, .pdf or .json; repeatable
        #[arg(long, value_name = "FILE")]
        report: Vec<Target>,
    },
    /// Add a note to a run; it stands on the run's test sheet
    Note {
        /// The run: an id, its beginning or end (at least 4 digits), or `latest`
        id: String,
        /// Text of the note
        text: String,
        /// Who writes the note
        #[arg(long, value_name = "TEXT", default_value = "")]
        who: String,
        #[command(flatten)]
        signing: SigningOption,
    },
    /// Write the certificate of a signed run: what was signed, by whom, and the signature, for `ptu verify`
    Certificate {
        /// The run: an id, its beginning or end (at least 4 digits), or `latest`
        id: String,
        /// The file to write, as run.ptucert
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
}

impl RunsArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        let store = if matches!(self.verb, Verb::Note { .. }) {
            self.database.open()?
        } else {
            self.database.open_read_only()?
        };
        match self.verb {
            Verb::Certificate { id, out } => certificate(&store, &id, &out),
            Verb::Note {
                id,
                text,
                who,
                signing,
            } => {
                signing.sign(&store)?;
                let (text, who) = (text.trim(), who.trim());
                if text.is_empty() {
                    return Err(Failure::usage(Asked::EmptyNote));
                }
                let run = store.resolve_run(&id)?;
                store.add_run_note(run, who, text, clock::now_us())?;
                let said = Words::shown().terminal.noted_on_run;
                print_out(&fill(said, &[("run", &run.short())]))
            }
            Verb::List {
                serial_no,
                verdict,
                when,
                limit,
                form,
            } => {
                if let Some(unit) = &serial_no {
                    check_unit(&store, unit)?;
                }
                let span = when.unwrap_or_default();
                let filter = RunFilter {
                    unit: serial_no,
                    verdict,
                    since_us: span.since_us,
                    until_us: span.until_us,
                    limit: Some(limit),
                    ..RunFilter::default()
                };
                let runs = store.runs(&filter)?;
                let rows = match form.is_table() {
                    true => Vec::new(),
                    false => runs.iter().map(run_summary_json).collect(),
                };
                form.print(&rows, || table(&runs))
            }
            Verb::Compare {
                before,
                after,
                all,
                json,
                report,
            } => {
                report.iter().try_for_each(Target::check)?;
                let (a, b) = (store.resolve_run(&before)?, store.resolve_run(&after)?);
                let of = RunComparison::gather(&store, a, b, all)?;
                write_comparison(&report, &of, Language::shown())?;
                let text = || comparison_text(&of, Words::shown());
                json.answer(|| comparison_json(&of), text)?;
                Ok(match of.tally().passed_before {
                    0 => Exit::Passed,
                    _ => Exit::Failed,
                })
            }
            Verb::Show {
                id,
                json,
                reports,
                scripts,
            } => {
                reports.check()?;
                let run = store.run(store.resolve_run(&id)?)?;
                if !reports.is_empty() {
                    let directory = scripts.find()?;
                    reports.write(&store, &directory, &run)?;
                }
                let text = || verdict_table(&run, Words::shown()) + &signed(&run) + &notes(&run);
                json.answer(|| run_json(&run), text)
            }
        }
    }
}

/// Line below a run's verdict that says who signed the run, or that nobody did.
fn signed(run: &RunDetail) -> String {
    let words = Words::shown();
    let terminal = &words.terminal;
    match (&run.signature, &run.seal) {
        (Some(signed), _) => {
            let said = fill(
                terminal.signed,
                &[
                    ("who", &signed.who),
                    ("kind", &signed.kind),
                    ("key", &signed.short_key()),
                    ("at", &clock::local(signed.at_us)),
                    ("run", &run.run.id.short()),
                ],
            );
            format!("\n{said}")
        }
        (None, Some(_)) => format!("\n{}", words.report.unsigned),
        (None, None) => String::new(),
    }
}

fn certificate(store: &Store, id: &str, out: &Path) -> Result<Exit, Failure> {
    let run = store.resolve_run(id)?;
    let signed = store.signatures(run)?.into_iter().find(|text| {
        let statement = (Signed::read(text).ok()).and_then(|signed| Statement::of(&signed));
        statement.is_some_and(|statement| statement.what == "run")
    });
    let Some(signed) = signed else {
        return Err(Failure::usage(Asked::Unsigned(run)));
    };
    whole_file::write_text(out, format!("{signed}\n"))?;
    let said = Words::shown().terminal.files_written;
    print_out(&fill(said, &[("files", &out.display())]))
}

fn table(runs: &[fault_db::RunSummary]) -> String {
    let words = Words::shown();
    let (common, terminal) = (&words.common, &words.terminal);
    if runs.is_empty() {
        return terminal.no_runs.into();
    }
    let mut table = Table::headed(&[
        common.run,
        terminal.started,
        common.unit,
        terminal.source,
        common.state,
        terminal.steps,
        terminal.faults,
        terminal.injected,
    ])
    .verdicts(4);
    for run in runs {
        table.row([
            run.id.short(),
            clock::local(run.started_at_us),
            run.unit_serial.clone(),
            run.source.clone(),
            words.run_verdict(run).to_owned(),
            count_short(&counts_of(run), words),
            run.faults.to_string(),
            run.injected.clone().unwrap_or_default(),
        ]);
    }
    table.render()
}

/// Table of the notes on a run, below its verdict.
fn notes(run: &RunDetail) -> String {
    if run.notes.is_empty() {
        return String::new();
    }
    let words = Words::shown();
    let (terminal, note) = (&words.terminal, words.common.note);
    let mut table = Table::headed(&[terminal.noted, terminal.by, note]);
    for note in &run.notes {
        table.row([
            clock::local(note.at_us),
            noted_by(note, run, words),
            note_text(note, words),
        ]);
    }
    format!("\n\n{}", table.render())
}
