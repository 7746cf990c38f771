//! Signals read from a file, each sample with its time.

use std::path::Path;

use fault_db::trace::MAX_SAMPLES;
use fault_db::{Channel, ChannelKind};

use super::about::TraceInfo;
use super::times::Columns;
use super::{csv_read, mcap_read, parquet_read};
use ptu_runs::failure::{Failure, FileTrouble};

/// Most signals that are read of a file; a trace of this program has a few hundred.
const MOST_SIGNALS: usize = 4096;

/// Signals that were sampled together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Time of each row, microseconds, never falling.
    pub times_us: Vec<i64>,
    pub channels: Vec<Channel>,
    /// Samples by signal, then by row; an unknown one is NaN.
    pub columns: Vec<Vec<f64>>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// Signals, one table for those that were sampled together.
    pub tables: Vec<Table>,
    /// Times are since 1970, UTC; otherwise from the trigger.
    pub is_utc: bool,
    /// Description of the trace, in a file exported by this program.
    pub about: Option<TraceInfo>,
}

/// Whether a file of this name can be read.
pub fn is_importable(file: &Path) -> bool {
    matches!(&*ending(file), "csv" | "parquet" | "mcap")
}

fn ending(file: &Path) -> String {
    let ending = file
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase());
    ending.unwrap_or_default()
}

/// Reads a CSV, Parquet or MCAP file; signals with a name in `known` are of the kind they have there. `asked`, what a
/// person says of a table's columns, counts before the headings.
///
/// # Errors
/// The file cannot be read, or is not what its ending says: with the place where.
pub fn import(file: &Path, known: &[Channel], asked: &Columns) -> Result<Import, Failure> {
    let import = match &*ending(file) {
        "mcap" => mcap_read::read(file, known, asked)?,
        "parquet" => parquet_read::read(file, known, asked)?,
        _ => csv_read::read(file, known, asked)?,
    };
    if import.tables.iter().all(|table| table.times_us.is_empty()) {
        return Err(wrong(file, "it has no samples"));
    }
    Ok(import)
}

impl Table {
    /// Number of samples in the table, in which the times are a column, too.
    pub(super) fn samples(&self) -> usize {
        self.times_us.len().saturating_mul(self.columns.len() + 1)
    }
}

/// Refuses a file with more signals or samples than are held in memory.
pub(super) fn check_size(file: &Path, signals: usize, samples: usize) -> Result<(), Failure> {
    let more = if signals > MOST_SIGNALS {
        format!("{MOST_SIGNALS} signals")
    } else if samples > MAX_SAMPLES {
        format!("{MAX_SAMPLES} samples")
    } else {
        return Ok(());
    };
    Err(wrong(
        file,
        &format!("it has more than {more}; export a part of it"),
    ))
}

/// Sorts rows by time: the rows of a table, and messages, may come in any order.
pub(super) fn in_order(table: &mut Table) {
    if table.times_us.is_sorted() {
        return;
    }
    let mut rows: Vec<usize> = (0..table.times_us.len()).collect();
    rows.sort_by_key(|row| table.times_us[*row]);
    table.times_us = rows.iter().map(|row| table.times_us[*row]).collect();
    for column in &mut table.columns {
        *column = rows.iter().map(|row| column[*row]).collect();
    }
}

/// Channel of a signal that no trace has: a number without a unit.
pub(super) fn plain(name: &str) -> Channel {
    Channel {
        name: name.to_owned(),
        unit: String::new(),
        kind: ChannelKind::Number { lsb: 1e-6 },
    }
}

pub(super) fn wrong(file: &Path, what: &str) -> Failure {
    Failure::usage(FileTrouble::wrong(file.display(), what))
}
