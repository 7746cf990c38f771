//! `ptu report`: writes the sheet of a stored run, or of a case.

use clap::Args;
use fault_db::{Id, Store, StoreError};

use super::signing::SigningOption;
use super::{Database, ScriptsOption, print_out};
use ptu_report::run::CaseSheet;
use ptu_report::words::{Language, Words, fill};
use ptu_report::{Target, write_case};
use ptu_runs::failure::{Asked, Exit, Failure};

/// Write the sheet of a run, or the repair sheet of a case, to files
///
/// A run's sheet is the same as from `ptu run --report` and from the window. A fault's id names its case: the sheet
/// says what failed, what was replaced, the failing values before and after with their limits, and what runs prove of
/// the repair.
///
/// Examples:
///   ptu report latest --out sheet.pdf --out results.junit.xml
///   ptu report 5f8b --out case.pdf --lang ko                    the case of fault 5f8b
///   ptu report latest --case --out case.html --annex            case of the fault seen last, with both runs in full
///
/// Exit codes: 0 written, 2 no such run or fault, or a file name with an unknown ending, 3 database.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct ReportArguments {
    /// The run or the fault: an id, its beginning or end (at least 4 digits); `latest` is the last run
    #[arg(value_name = "RUN|CASE")]
    id: String,
    /// The file: a sheet as .html or .pdf, or .csv, .json, .junit.xml; repeatable
    #[arg(long, value_name = "FILE", required = true)]
    out: Vec<Target>,
    /// Take the id as a fault's id; `latest` is then the fault seen last
    #[arg(long)]
    case: bool,
    /// Add the full sheets of both runs behind the sheet of a case
    #[arg(long)]
    annex: bool,
    /// Depot where the unit is kept, for the sheet of a case; without it the sheet has a line to write on
    #[arg(long, value_name = "TEXT", env = "PTU_DEPOT", default_value = "")]
    depot: String,
    #[command(flatten)]
    signing: SigningOption,
    #[command(flatten)]
    database: Database,
    #[command(flatten)]
    scripts: ScriptsOption,
}

/// What an id on the command line names.
enum Told {
    Run(Id),
    Case(Id),
}

impl ReportArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        self.out.iter().try_for_each(Target::check)?;
        let store = self.database.open_read_only()?;
        let told = self.told(&store)?;
        let directory = self.scripts.find()?;
        match told {
            Told::Run(_) if self.annex => {
                return Err(Failure::usage(Asked::AnnexOfRun));
            }
            Told::Case(_) if self.signing.is_named() && self.out.iter().any(Target::is_html) => {
                return Err(Failure::usage(Asked::CaseUnsigned));
            }
            Told::Run(id) => {
                self.signing.sign(&store)?;
                let run = store.run(id)?;
                ptu_report::write(&self.out, &store, &directory, &run, Language::shown())?;
            }
            Told::Case(id) => {
                let (depot, annex) = (&self.depot, self.annex);
                let case = CaseSheet::gather(&store, &directory, id, depot, annex)?;
                write_case(&self.out, &case, Language::shown())?;
            }
        }
        let files = self.out.iter();
        let files: Vec<_> = files
            .map(|file| file.path().display().to_string())
            .collect();
        let said = Words::shown().terminal.files_written;
        print_out(&fill(said, &[("files", &files.join(", "))]))
    }

    /// The run that the id names, or else the fault; an id that fits both is refused.
    fn told(&self, store: &Store) -> Result<Told, Failure> {
        let id = &self.id;
        if self.case {
            return Ok(Told::Case(store.resolve_fault(id)?));
        }
        let run = store.resolve_run(id);
        if id == "latest" {
            return Ok(Told::Run(run?));
        }
        match (run, store.resolve_fault(id)) {
            (Ok(run), Err(StoreError::NotFound { .. })) => Ok(Told::Run(run)),
            (Err(StoreError::NotFound { .. }), Ok(fault)) => Ok(Told::Case(fault)),
            (Ok(_), _) | (_, Ok(_)) => Err(Failure::usage(Asked::FitsRunAndFault(id.to_string()))),
            (Err(StoreError::NotFound { .. }), Err(StoreError::NotFound { .. })) => {
                Err(Failure::usage(Asked::FitsNothing(id.to_string())))
            }
            (Err(StoreError::NotFound { .. }), Err(error)) | (Err(error), _) => Err(error.into()),
        }
    }
}
