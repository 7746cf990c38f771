//! `ptu db backup`, `import`, `export`, `prune` and `rebuild`.

use std::fmt::Display;
use std::path::Path;
use std::sync::Arc;

use clap::Args;
use fault_db::{MergeCounts, PruneRule, StateConflict, StoreError};
use serde_json::{json, to_value};

use crate::cli::{Database, Json, answered, print_json, print_out, since_argument};
use ptu_options::only_file;
use ptu_report::care::{self, Said};
use ptu_report::history_files::export_history;
use ptu_report::words::{Words, fill};
use ptu_runs::clock;
use ptu_runs::failure::{Exit, Failure, FileTrouble, Trouble, Why, in_place_of};
use ptu_runs::stdio;

/// Options that say which traces may be deleted; traces of a fault that is not closed are never deleted.
#[derive(Debug, Args)]
pub(super) struct PruneArguments {
    /// Delete traces older than: 90d, 2026-03, 2026-03-21
    #[arg(long, value_name = "TIME", value_parser = since_argument, allow_hyphen_values = true,
        required_unless_present_any = ["passed_only", "max_size"])]
    older_than: Option<i64>,
    /// Delete only traces of runs that passed
    #[arg(long)]
    passed_only: bool,
    /// Delete the oldest traces until the file is no larger than: 2GB, 500MB
    #[arg(long, value_name = "SIZE", value_parser = size_argument)]
    max_size: Option<u64>,
    /// Delete also traces that wait for `db sync`
    #[arg(long)]
    unsent_too: bool,
    /// Only count what would be deleted
    #[arg(long)]
    dry_run: bool,
}

pub(super) fn backup(database: &Database, to: &Path) -> Result<Exit, Failure> {
    database.open_read_only()?.backup(only_file(to)?)?;
    // The copy's last seal, not the file's: another process may have recorded more into the file meanwhile.
    let head = fault_db::Store::open_read_only(to)?.head()?;
    let words = Words::shown();
    let mut said = fill(words.care.backed_up, &[("file", &to.display())]);
    if let Some(head) = head {
        said += &format!("\n{}", care::chain(&head, words));
    }
    print_out(&said)
}

pub(super) fn import(database: &Database, from: &Path, json: Json) -> Result<Exit, Failure> {
    let from = only_file(from)?;
    let store = database.open_or_make()?;
    let counts = store.import(from);
    let counts = counts.map_err(|error| of_named_file(from, error))?;
    // Only an import that added events can have added a conflict; earlier conflicts were told before.
    let conflicts = match counts.events {
        0 => Vec::new(),
        _ => store.conflicts()?,
    };
    tell_merged(&counts, &conflicts, json)
}

pub(super) fn export(database: &Database, to: &Path, json: Json) -> Result<Exit, Failure> {
    let to = only_file(to)?;
    let store = database.open_read_only()?;
    let counts = store.export(to, clock::open_options());
    let counts = counts.map_err(|error| of_named_file(to, error))?;
    tell_merged(&counts, &[], json)
}

pub(super) fn export_parquet(database: &Database, to: &Path, json: Json) -> Result<Exit, Failure> {
    let done = export_history(&database.open_read_only()?, to)?;
    let text = || {
        let of: [(_, &dyn Display); 4] = [
            ("written", &done.written),
            ("folder", &to.display()),
            ("unchanged", &done.unchanged),
            ("removed", &done.removed),
        ];
        fill(Words::shown().care.tables, &of)
    };
    json.answer(|| &done, text)
}

pub(super) fn prune(database: &Database, arguments: &PruneArguments) -> Result<Exit, Failure> {
    let rule = PruneRule {
        older_than_us: arguments.older_than,
        passed_only: arguments.passed_only,
        max_file_bytes: arguments.max_size,
        keep_unsent: !arguments.unsent_too,
        dry_run: arguments.dry_run,
        at_us: clock::now_us(),
    };
    let counts = database.open()?.prune(&rule)?;
    print_out(&care::pruned(&counts, arguments.dry_run, Words::shown()))
}

pub(super) fn rebuild(database: &Database) -> Result<Exit, Failure> {
    let differed = database.open()?.rebuild(clock::now_us())?;
    let care = &Words::shown().care;
    let mut said = care.rebuilt.to_owned();
    if !differed.is_empty() {
        said += &format!("\n{}", care.differed);
    }
    for what in differed {
        said += &format!("\n  {what}");
    }
    print_out(&said)
}

/// Failure for a file that was not named by --db: without the advice to name another file by --db.
fn of_named_file(file: &Path, error: StoreError) -> Failure {
    match &error {
        StoreError::Missing(path) if path == file => {
            Failure::bench(FileTrouble::NoDatabase(file.display().to_string()))
        }
        of_it if in_place_of(of_it) == Some(file) => {
            Failure::bench(Trouble::NamedStore(Arc::new(error)))
        }
        _ => error.into(),
    }
}

/// Prints what a merge did, what it left as it was, and what to do next.
fn tell_merged(
    counts: &MergeCounts,
    conflicts: &[StateConflict],
    json: Json,
) -> Result<Exit, Failure> {
    let Said { text, notes } = care::imported(counts, conflicts, Words::shown());
    let told = if json.is_asked() {
        let mut all = to_value(counts)
            .map_err(|error| Failure::bench(FileTrouble::NotPrinted("JSON", Why::of(error))))?;
        all["conflicts"] = json!(conflicts);
        print_json(&all)
    } else {
        print_out(&text)
    };
    notes.iter().for_each(|note| stdio::note(note));
    let exit = match counts.different.is_empty() && counts.refused.is_empty() {
        true => Exit::Passed,
        false => Exit::Bench,
    };
    answered(told, exit)
}

/// Parses a size, as `2GB`, `500MB`, `64kB` or a number of bytes; the result is in bytes.
fn size_argument(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|letter: char| letter.is_ascii_alphabetic());
    let unit = match text[digits.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => Some(1),
        "kb" => Some(1_000),
        "mb" => Some(1_000_000),
        "gb" => Some(1_000_000_000),
        _ => None,
    };
    let size = unit.and_then(|unit| digits.trim_end().parse::<u64>().ok()?.checked_mul(unit));
    size.ok_or_else(|| format!("\"{text}\" is no size (2GB, 500MB)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_with_their_unit() {
        assert_eq!(size_argument("2GB"), Ok(2_000_000_000));
        assert_eq!(size_argument("500 mb"), Ok(500_000_000));
        assert_eq!(size_argument("4096"), Ok(4096));
        for bad in [
            "",
            "GB",
            "2TB",
            "-1",
            "1.5GB",
            "99999999999999999999",
            "20000000000GB",
        ] {
            assert!(size_argument(bad).is_err(), "{bad}");
        }
    }
}
