//! Chooses the file of a report and writes it.

use std::path::{Path, PathBuf};

use super::{Asked, SheetOf};
use crate::data_paths::DataPaths;
use crate::parts::usual_folder;
use ptu_report::run::{CaseSheet, RunComparison};
use ptu_report::{self, Target};
use ptu_runs::failure::Failure;

/// Extensions that a typed name may have; the extension of the chosen format replaces them.
const ENDINGS: [&str; 3] = [".html", ".pdf", ".csv"];

/// Proposed path for this sheet, in the folder of the file `before`.
pub fn named_after(of: SheetOf, before: &str) -> String {
    let folder = Path::new(before.trim()).parent();
    let folder = folder.map_or_else(usual_folder, Path::to_path_buf);
    let name = match of {
        SheetOf::Compared { before, after, .. } => {
            format!("compared-{}-{}.pdf", before.short(), after.short())
        }
        SheetOf::Run(run) | SheetOf::Case { run, .. } => format!("sheet-{}.pdf", run.short()),
    };
    folder.join(name).to_string_lossy().into_owned()
}

/// Typed path, made absolute, with this extension; none if the field is empty.
pub fn with_ending(typed: &str, ending: &str) -> Option<PathBuf> {
    let typed = typed.trim();
    let lower = typed.to_ascii_lowercase();
    let known = ENDINGS.iter().find(|known| lower.ends_with(*known));
    let stem = typed.get(..typed.len() - known.map_or(0, |known| known.len()))?;
    let named = !stem.is_empty() && !stem.ends_with(['/', std::path::MAIN_SEPARATOR]);
    let path = PathBuf::from(format!("{stem}{ending}"));
    named.then(|| std::path::absolute(&path).unwrap_or(path))
}

/// Writes the report to the file `wanted`, or under a similar name if that file exists; returns the file's path.
///
/// # Errors
/// The file cannot be written, or the database not be read.
pub(super) fn write(paths: &DataPaths, asked: &Asked, wanted: &Path) -> Result<PathBuf, Failure> {
    let target: Target = wanted.to_string_lossy().parse().map_err(Failure::usage)?;
    let file = target.begin_beside()?;
    let (store, scripts) = (paths.read()?, &paths.scripts);
    let language = asked.language;
    let content = match asked.of {
        SheetOf::Run(run) => {
            let run = store.run(run)?;
            ptu_report::run_content(&target, &store, scripts, &run, language)?
        }
        SheetOf::Case { fault, .. } => {
            let case = CaseSheet::gather(&store, scripts, fault, &asked.depot, false)?;
            ptu_report::case_content(&target, &case, language)?
        }
        SheetOf::Compared { before, after, all } => {
            let compared = RunComparison::gather(&store, before, after, all)?;
            ptu_report::comparison_content(&target, &compared, language)?
        }
    };
    ptu_report::write_beside(&target, file, &content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_the_ending_of_its_format_whatever_was_typed() {
        let file = |typed: &str| with_ending(typed, ".html").map(|path| path.display().to_string());
        let some = |path: &str| Some(path.to_owned());
        assert_eq!(file("/a/sheet.pdf"), some("/a/sheet.html"));
        assert_eq!(file(" /a/sheet.PDF "), some("/a/sheet.html"));
        assert_eq!(file("/a/시험 v1.2"), some("/a/시험 v1.2.html"));
        assert!(file("sheet").is_some_and(|path| path.starts_with('/')));
        for nothing in ["", "  ", "/a/", ".pdf", "/a/.csv"] {
            assert_eq!(file(nothing), None, "{nothing}");
        }
    }

    #[test]
    fn the_sheet_of_the_next_run_is_saved_in_the_folder_of_the_last() {
        let run: fault_db::Id = "0198c0de-0000-7000-8000-00000000cafe"
            .parse()
            .expect("an id");
        let beside = format!("/reports/sheet-{}.pdf", run.short());
        let of = SheetOf::Run(run);
        assert_eq!(named_after(of, "/reports/mine.html"), beside);
        assert!(named_after(of, "").ends_with(&format!("sheet-{}.pdf", run.short())));
    }
}
