//! Writes the report of a run to a file, in the format of its extension: a test sheet as `.html` or `.pdf`, or `.csv`,
//! `.json`, `.junit.xml`.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use fault_db::{Id, RunDetail, Store};
use maud::Markup;
use protocol::display_text;
use serde_json::Value;

use crate::certificate::attach;
use crate::json::{json_text, run_json};
use crate::run::{self, CaseSheet, Printed, RunComparison, Sheet};
use crate::words::{Language, Words, fill};
use crate::{csv, junit};
use ptu_runs::clock::now_us;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::{Asked, Failure};
use ptu_runs::new_file::{Kind, NewFile, cannot_write, kind};
use ptu_runs::stdio;
use ptu_runs::whole_file;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Target {
    path: PathBuf,
    pub(crate) format: Format,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Html,
    Pdf,
    Csv,
    Json,
    Junit,
}

impl std::str::FromStr for Target {
    type Err = Asked;

    fn from_str(text: &str) -> Result<Self, Asked> {
        let endings = [
            (".html", Format::Html),
            (".pdf", Format::Pdf),
            (".csv", Format::Csv),
            (".json", Format::Json),
            (".junit.xml", Format::Junit),
        ];
        let format = endings
            .into_iter()
            .find_map(|(ending, format)| text.ends_with(ending).then_some(format))
            .ok_or(Asked::NoReport)?;
        Ok(Self {
            path: text.into(),
            format,
        })
    }
}

impl Target {
    /// Finds out before the run whether the file can be written after it.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn check(&self) -> Result<(), Failure> {
        whole_file::check_writable(&self.path, self.kind())
    }

    /// Begins the file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(&self) -> Result<NewFile, Failure> {
        NewFile::begin(&self.path, self.kind())
    }

    /// Begins the file, or a file of another name in its folder if the file exists.
    ///
    /// # Errors
    /// No file can be made in that folder.
    pub fn begin_beside(&self) -> Result<NewFile, Failure> {
        NewFile::begin_beside(&self.path)
    }

    pub(crate) fn write(&self, content: Result<Vec<u8>, Failure>) -> Result<(), Failure> {
        whole_file::write(&self.path, self.kind(), content?)
    }

    /// The sheet as a PDF. A note on stderr names the letters that the font lacks, which are printed as codes.
    fn on_paper(&self, sheet: &impl Printed, words: &Words) -> Result<Vec<u8>, Failure> {
        let (document, coded) = run::pdf(sheet, words)?;
        if !coded.is_empty() {
            let (file, letters) = (self.path.display(), String::from_iter(coded));
            let of = [("file", &file as _), ("letters", &letters as _)];
            stdio::note(&fill(words.terminal.letters_coded, &of));
        }
        Ok(document)
    }

    fn kind(&self) -> Kind<'static> {
        match self.format {
            Format::Html => kind::HTML,
            Format::Pdf => kind::PDF,
            Format::Csv => kind::CSV,
            Format::Json => kind::JSON,
            Format::Junit => kind::JUNIT,
        }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The target is an HTML page, which carries a signature where it shows a run.
    pub fn is_html(&self) -> bool {
        self.format == Format::Html
    }

    /// The target is a test sheet, for people.
    fn is_sheet(&self) -> bool {
        matches!(self.format, Format::Html | Format::Pdf)
    }
}

/// Writes reports of a run. What only test sheets say is gathered when one is asked for.
///
/// # Errors
/// The database cannot be read, or a file cannot be written; the other files are written all the same.
pub fn write(
    targets: &[Target],
    store: &Store,
    directory: &ScriptsDirectory,
    run: &RunDetail,
    language: Language,
) -> Result<(), Failure> {
    let gather = || Sheet::gather(store, directory, run.run.id);
    let sheet = targets.iter().any(Target::is_sheet).then(gather);
    let (sheet, gathered) = match sheet.transpose() {
        Ok(sheet) => (sheet, Ok(())),
        Err(failure) => (None, Err(failure)),
    };
    let signatures = store.signatures(run.run.id)?;
    let signer = store.signer();
    let content = |target: &Target| {
        let mut content = content(target, run, sheet.as_ref(), || run_json(run), language)?;
        if target.is_html() {
            let page = String::from_utf8_lossy(&content).into_owned();
            if signer.is_some() {
                refuse_changed(store, run.run.id)?;
            }
            let page = attach(page, run, &signatures, signer.as_deref(), now_us());
            content = page.into_bytes();
        }
        Ok(content)
    };
    let made = targets
        .iter()
        .filter(|target| gathered.is_ok() || !target.is_sheet());
    let written = made.map(|target| target.write(content(target)));
    let written = written.collect::<Vec<_>>();
    Failure::of_all(std::iter::once(gathered).chain(written))
}

/// Refuses to sign a sheet of a run that is not as it was sealed.
fn refuse_changed(store: &Store, run: Id) -> Result<(), Failure> {
    match store.verify_run(run)?.changes.first() {
        None => Ok(()),
        Some(change) => Err(Failure::bench(Asked::Changed(run, change.to_string()))),
    }
}

/// Writes reports of a case.
///
/// # Errors
/// A file cannot be written; the other files are written all the same.
pub fn write_case(targets: &[Target], case: &CaseSheet, language: Language) -> Result<(), Failure> {
    let write = |target: &Target| target.write(case_content(target, case, language));
    Failure::of_all(targets.iter().map(write))
}

/// A report of a case. Its tables (CSV, JUnit) are those of the run that tells the present state of the unit.
///
/// # Errors
/// The report cannot be made.
pub fn case_content(
    target: &Target,
    case: &CaseSheet,
    language: Language,
) -> Result<Vec<u8>, Failure> {
    let (run, json) = (&case.last().run, || run::case_json(case));
    content(target, run, Some(case), json, language)
}

/// A report that compares two runs. Its tables (CSV, JUnit) are those of the second run.
///
/// # Errors
/// The report cannot be made.
pub fn comparison_content(
    target: &Target,
    of: &RunComparison,
    language: Language,
) -> Result<Vec<u8>, Failure> {
    content(
        target,
        &of.b,
        Some(of),
        || run::comparison_json(of),
        language,
    )
}

/// Writes reports that compare two runs.
///
/// # Errors
/// A file cannot be written; the other files are written all the same.
pub fn write_comparison(
    targets: &[Target],
    of: &RunComparison,
    language: Language,
) -> Result<(), Failure> {
    let write = |target: &Target| target.write(comparison_content(target, of, language));
    Failure::of_all(targets.iter().map(write))
}

/// A report of a run.
///
/// # Errors
/// The database cannot be read, or the report cannot be made.
pub fn run_content(
    target: &Target,
    store: &Store,
    directory: &ScriptsDirectory,
    run: &RunDetail,
    language: Language,
) -> Result<Vec<u8>, Failure> {
    let gather = || Sheet::gather(store, directory, run.run.id);
    let sheet = target.is_sheet().then(gather).transpose()?;
    content(target, run, sheet.as_ref(), || run_json(run), language)
}

/// Writes a report to its begun file, or beside it where the name is taken; returns the path.
///
/// # Errors
/// The report cannot be written.
pub fn write_beside(
    target: &Target,
    mut file: NewFile,
    content: &[u8],
) -> Result<PathBuf, Failure> {
    let written = file.write_all(content);
    written.map_err(|error| cannot_write(&target.path, &error))?;
    file.finish_beside()
}

/// Text of a page for its file: no letter in the text controls a terminal or changes the order of reading.
pub(crate) fn page_text(page: Markup) -> String {
    display_text::lines(&page.into_string()).into_owned()
}

/// A report in the target's format: of a sheet for people, as JSON, or the tables of a run.
fn content(
    target: &Target,
    run: &RunDetail,
    sheet: Option<&impl Printed>,
    json: impl Fn() -> Value,
    language: Language,
) -> Result<Vec<u8>, Failure> {
    let words = language.words();
    let text = match (target.format, sheet) {
        (Format::Html, Some(sheet)) => run::html(sheet, words),
        (Format::Pdf, Some(sheet)) => return target.on_paper(sheet, words),
        // Callers that ask for a sheet have gathered its content.
        (Format::Html | Format::Pdf, None) => String::new(),
        (Format::Csv, _) => csv::csv(run),
        (Format::Json, _) => json_text(&json())?,
        (Format::Junit, _) => junit::junit(run)?,
    };
    Ok(text.into_bytes())
}
