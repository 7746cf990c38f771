//! `ptu trace export`: a trace, or a part of it, for other programs.

use ptu_report::words::{Words, fill};
use std::path::PathBuf;

use clap::Args;
use fault_db::Store;

use super::PartArguments;
use crate::cli::print_out;
use ptu_report::trace_io::{Format, TracePart, export};
use ptu_runs::failure::{Exit, Failure};

/// Write a trace to a .csv, .parquet or .mcap file
///
///   .csv      a line for each row; FILE-metadata.json beside it describes the signals (CSV on the Web)
///   .parquet  for DuckDB, pandas, Polars: doubles, booleans, words
///   .mcap     for Foxglove and PlotJuggler: a JSON message for each row, under the topic `trace`
///
/// In each format, times are seconds from the trigger and UTC, unknown samples are empty, and these are kept: trace,
/// run, unit, period, trigger, and the unit of measure and the words of each signal.
///
/// Examples:
///   ptu trace export latest --out trace.parquet
///   ptu trace export 59c2ce97 --out brake.csv --signal speed,limit,eb --window -2..5
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct ExportArguments {
    /// The trace: an id, its beginning or end (at least 4 digits), or `latest`
    id: String,
    /// The file; its ending chooses the format
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    part: PartArguments,
    /// Replace a file that is there
    #[arg(long)]
    force: bool,
}

impl ExportArguments {
    pub fn run(self, store: &Store) -> Result<Exit, Failure> {
        // An unknown ending is refused before the database is searched.
        Format::of(&self.out)?;
        let id = store.resolve_trace(&self.id)?;
        let chosen = TracePart::new(store, id, &self.part.signals, self.part.window)?;
        export(&chosen, &self.out, self.force)?;
        print_out(&fill(
            Words::shown().traces.exported,
            &[
                ("trace", &id.short()),
                ("rows", &chosen.about.rows),
                ("signals", &chosen.about.channels.len()),
                ("file", &self.out.display()),
            ],
        ))
    }
}
