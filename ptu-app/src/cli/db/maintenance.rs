//! `ptu db backup`, `import`, `export`, `prune` and `rebuild`.

use std::path::Path;
use std::sync::Arc;

use clap::Args;
use fault_db::{
    CopyOf, Difference, MergeCounts, PruneCounts, PruneRule, Refusals, StateConflict, StoreError,
};
use serde_json::{json, to_value};

use super::check::sealed;
use crate::cli::{Database, Json, answered, print_json, print_out, since_argument};
use ptu_options::only_file;
use ptu_report::history_files::{Exported, export_history};
use ptu_runs::clock;
use ptu_runs::failure::{Exit, Failure, FileTrouble, Trouble, Why, in_place_of};
use ptu_runs::stdio;

/// Which traces may be deleted; those of faults that are not closed never are.
#[derive(Debug, Args)]
pub(super) struct PruneArguments {
    /// Older than: 90d, 2026-03, 2026-03-21
    #[arg(long, value_name = "TIME", value_parser = since_argument, allow_hyphen_values = true,
        required_unless_present_any = ["passed_only", "max_size"])]
    older_than: Option<i64>,
    /// Of runs that passed only
    #[arg(long)]
    passed_only: bool,
    /// The oldest, until the file is no larger than: 2GB, 500MB
    #[arg(long, value_name = "SIZE", value_parser = size_argument)]
    max_size: Option<u64>,
    /// Also those that wait for `db sync`
    #[arg(long)]
    unsent_too: bool,
    /// Count only
    #[arg(long)]
    dry_run: bool,
}

pub(super) fn backup(database: &Database, to: &Path) -> Result<Exit, Failure> {
    database.open_read_only()?.backup(only_file(to)?)?;
    // Of the copy: another process may have recorded more into the file meanwhile.
    let head = fault_db::Store::open_read_only(to)?.head()?;
    let head = head.map(|head| format!("\n{}", sealed(&head)));
    print_out(&format!(
        "copied to {}{}",
        to.display(),
        head.unwrap_or_default()
    ))
}

pub(super) fn import(database: &Database, from: &Path, json: Json) -> Result<Exit, Failure> {
    let from = only_file(from)?;
    let store = database.open_or_make()?;
    let counts = store.import(from);
    let counts = counts.map_err(|error| of_named_file(from, error))?;
    // What was known before needs no telling again; what came just now may be a rival of it.
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
        let Exported {
            written,
            unchanged,
            removed,
        } = &done;
        format!(
            "{written} files written below {}, {unchanged} unchanged, {removed} removed; for DuckDB: views.sql there",
            to.display()
        )
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
    print_out(&pruned(&database.open()?.prune(&rule)?, arguments.dry_run))
}

pub(super) fn rebuild(database: &Database) -> Result<Exit, Failure> {
    let differed = database.open()?.rebuild(clock::now_us())?;
    let mut said =
        "counts by day and month, repairs, sums of measured values and search words made again; \
         runs, faults, traces and seals are as they were"
            .to_owned();
    if !differed.is_empty() {
        said += "\nuntil now, and on record from now on:";
    }
    for what in differed {
        said += &format!("\n  {what}");
    }
    print_out(&said)
}

/// An error of a file that was not named with --db has no advice to name another one so.
fn of_named_file(file: &Path, error: StoreError) -> Failure {
    match &error {
        StoreError::Missing { path } if path == file => {
            Failure::bench(FileTrouble::NoDatabase(file.display().to_string()))
        }
        of_it if in_place_of(of_it) == Some(file) => {
            Failure::bench(Trouble::NamedStore(Arc::new(error)))
        }
        _ => error.into(),
    }
}

/// What a merge did, and what it left as it was, with the next move.
fn tell_merged(
    counts: &MergeCounts,
    conflicts: &[StateConflict],
    json: Json,
) -> Result<Exit, Failure> {
    let told = if json.is_asked() {
        let mut all = to_value(counts)
            .map_err(|error| Failure::bench(FileTrouble::NotPrinted("JSON", Why::of(error))))?;
        all["conflicts"] = json!(conflicts);
        print_json(&all)
    } else {
        let rivals: String = conflicts.iter().map(rivals).collect();
        print_out(&(merged(counts) + &rivals))
    };
    if let Some(copy) = &counts.copy {
        stdio::note(&copied(copy));
    }
    for Difference { what, id } in &counts.different {
        stdio::note(&format!(
            "{what} {id} does not say the same in both files; each keeps its own: look with `ptu db check`"
        ));
    }
    for refused in told_refused(&counts.refused) {
        stdio::note(&refused);
    }
    let exit = match counts.different.is_empty() && counts.refused.is_empty() {
        true => Exit::Passed,
        false => Exit::Bench,
    };
    answered(told, exit)
}

fn copied(copy: &CopyOf) -> String {
    let file = copy.file.short();
    match copy.went_on {
        true => format!(
            "it is a copy of database {file} that went on by itself after entry {} of its chain of seals; what is new \
             in it is sealed here as it was found",
            copy.after
        ),
        false => format!(
            "it is a copy of database {file} from before: more of its chain of seals is known here than the {} entries \
             in it",
            copy.after
        ),
    }
}

fn merged(counts: &MergeCounts) -> String {
    let mut text = format!(
        "added {} runs, {} steps, {} faults, {} occurrences, {} traces",
        counts.runs, counts.steps, counts.faults, counts.occurrences, counts.traces
    );
    if !counts.refused.is_empty() {
        text += &format!("; refused {}", counts.refused.count);
    }
    text
}

/// What was not taken, each with its reason; no more than are read.
pub(super) fn told_refused(refused: &Refusals) -> Vec<String> {
    let named = refused.named.iter();
    let mut all: Vec<_> = named
        .map(|one| format!("refused {}: {}", one.what, one.reason))
        .collect();
    let more = refused.count - refused.named.len() as u64;
    if more > 0 {
        all.push(format!("refused {more} more"));
    }
    all
}

/// One line of a fault about which two people disagree.
pub(super) fn rivals(conflict: &StateConflict) -> String {
    let said: Vec<_> = conflict
        .rivals
        .iter()
        .map(|rival| match &rival.who[..] {
            "" => rival.state.to_string(),
            who => format!("{who} says {}", rival.state),
        })
        .collect();
    format!(
        "\nfault {} ({}, {}): {}; it stays {} until somebody looks again",
        conflict.fault.short(),
        conflict.unit,
        conflict.code_name,
        said.join(", "),
        conflict.stands
    )
}

fn pruned(counts: &PruneCounts, dry_run: bool) -> String {
    let mut text = format!(
        "{} traces ({} bytes){}, {} kept for faults that are not closed",
        counts.traces,
        counts.trace_bytes,
        if dry_run { " would go" } else { " deleted" },
        counts.kept_for_faults,
    );
    if counts.kept_unsent > 0 {
        text += &format!(
            ", {} kept until `db sync` has sent them",
            counts.kept_unsent
        );
    }
    if !dry_run {
        text += &format!(", file {} bytes smaller", counts.freed_bytes);
    }
    if counts.over_bytes > 0 {
        text += &format!(
            "\nit {} {} bytes larger than it may be: the rest is runs, faults and traces that are kept",
            if dry_run {
                "would still be"
            } else {
                "is still"
            },
            counts.over_bytes
        );
    }
    text
}

/// A size such as `2GB`, `500MB`, `64kB` or a number of bytes.
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
