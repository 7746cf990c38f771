//! Exports a stored trace, or a part of it, to a file.

use std::io::Write;
use std::path::Path;

use super::csv::{self, beside};
use super::part::TracePart;
use super::{mcap_write, parquet};
use ptu_runs::failure::{Asked, Failure};
use ptu_runs::new_file::{NewFile, cannot_write, kind};

/// File format of a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values, with a description beside.
    Csv,
    /// Apache Parquet.
    Parquet,
    /// MCAP with JSON messages.
    Mcap,
}

impl Format {
    /// Format by the ending of a file's name.
    ///
    /// # Errors
    /// There is no such format.
    pub fn of(file: &Path) -> Result<Self, Failure> {
        match file.extension().and_then(|ending| ending.to_str()) {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") => Ok(Self::Parquet),
            Some("mcap") => Ok(Self::Mcap),
            _ => Err(Failure::usage(Asked::NoTraceFormat)),
        }
    }
}

/// Writes the chosen part to a file, in the format of its ending. A file that exists is left as it is unless `force`
/// is true; an export that fails leaves no file behind.
///
/// # Errors
/// The file cannot be written, or the trace cannot be read.
pub fn export(chosen: &TracePart<'_>, to: &Path, force: bool) -> Result<(), Failure> {
    let format = Format::of(to)?;
    // With `force` whatever is there is replaced, but for a database.
    let begin = match force {
        true => NewFile::begin,
        false => NewFile::begin_new,
    };
    let mut file = begin(to, kind::OWN)?;
    match format {
        Format::Csv => {
            let beside = beside(to);
            let mut description = begin(&beside, kind::OWN)?;
            let name = to.file_name().unwrap_or_default().to_string_lossy();
            let document = csv::description(&name, &chosen.about);
            writeln!(description, "{document:#}").map_err(|error| cannot_write(&beside, &error))?;
            put_csv(&mut file, chosen, to)?;
            // Both files are whole before the first one takes its place.
            description.settle()?;
            file.settle()?;
            description.finish()?;
        }
        Format::Parquet => parquet::put(&mut file, chosen, to)?,
        Format::Mcap => mcap_write::put(&mut file, chosen, to)?,
    }
    file.finish()
}

fn put_csv(out: &mut impl Write, chosen: &TracePart<'_>, to: &Path) -> Result<(), Failure> {
    let about = &chosen.about;
    let failed = |error: std::io::Error| cannot_write(to, &error);
    csv::put_headings(out, false, about.channels.iter()).map_err(failed)?;
    chosen.each_block(|first, columns| {
        for row in 0..columns.first().map_or(0, Vec::len) {
            let time = (about.time_us(first + row), about.period_us);
            let samples = columns.iter().map(|column| column[row]);
            let samples = about.channels.iter().zip(samples);
            csv::put_row(out, time, None, samples).map_err(failed)?;
        }
        Ok(())
    })
}
